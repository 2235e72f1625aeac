"""The short version of `python -m tests.tools`: five revolutions, in the tools that are here."""

from __future__ import annotations

from dataclasses import replace

import pytest

from tests.tools.measure import ONE_FMU, ONE_SSP, SLOPES, TOOLS, VALUES, Bench, Tool, every_run


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    return Bench(tmp_path_factory.mktemp("tools"), {"run.revolutions": 5})


@pytest.fixture(scope="module")
def quintic(tmp_path_factory):
    changes = {"run.revolutions": 5, "coupling.order": 5}
    return Bench(tmp_path_factory.mktemp("quintic"), changes)


def _named(name: str) -> Tool:
    [found] = [tool for tool in TOOLS if tool.name == name and tool.present] or [None]
    return found or pytest.skip(f"no {name} here")


@pytest.mark.parametrize(
    ("tool", "what"),
    [
        pytest.param(tool, what, id=f"{tool.name}: {what}")
        for tool, what in every_run()
        if "composite" in what
    ],
)
@pytest.mark.parametrize("steps", [5, 20, 40, 1000])
def test_the_composite_keeps_its_error_at_any_step_of_the_tool(bench, tool, what, steps):
    row = bench.run(tool, what, steps)
    assert not row.said
    assert row.error < 1e-4


@pytest.mark.parametrize("what", [ONE_SSP, VALUES, SLOPES])
def test_packages_of_quintic_signals_run(quintic, bench, what):
    """The composite is more exact; tools exchange values and slopes as those of cubic ones."""
    tool = _named("libcosim")
    cubic, found = bench.run(tool, what, 20).error, quintic.run(tool, what, 20).error
    assert found < cubic / 10.0 if what == ONE_SSP else found == pytest.approx(cubic, rel=1e-3)


@pytest.mark.parametrize("name", ["libcosim", "ecos", "CoFMuPy, jacobi"])
def test_slopes_give_masters_that_step_side_by_side_another_order(bench, name):
    """The error of held values falls with the step, that of slopes with its square."""
    tool = _named(name)
    held, sloped = ([bench.run(tool, w, n).error for n in (20, 40)] for w in (VALUES, SLOPES))
    assert 1.6 < held[0] / held[1] < 2.6
    assert 3.0 < sloped[0] / sloped[1] < 5.0
    assert sloped[1] < held[1] / 3.0


def test_slopes_harm_a_master_that_steps_one_unit_after_the_other(bench):
    tool = _named("CoFMuPy, gauss_seidel")
    held, sloped = (bench.run(tool, what, 20).error for what in (VALUES, SLOPES))
    assert sloped > 1.2 * held


def test_a_tool_that_fails_says_why(bench):
    fed_with_a_unit = replace(_named("libcosim"), runs={ONE_FMU: "libcosim"})
    row = bench.run(fed_with_a_unit, ONE_FMU, 20)
    assert row.error is None
    assert "expected <" in row.said  # it looks for XML
