"""The liquid window check: every bundled scene holds, and wrong theory or wrong units do not."""

from __future__ import annotations

import dataclasses

import pytest

from autobalancer.harness import bundled_scenes, check, load_scene
from autobalancer.harness.checks import liquid_window
from autobalancer.harness.errors import SceneError
from autobalancer.models.papers.window import LiquidWindow

pytestmark = pytest.mark.slow

SCENES = [
    name
    for name in bundled_scenes()
    if any(check.kind == "liquid_window" for check in load_scene(name).checks)
]


@pytest.fixture(autouse=True)
def few_speeds(monkeypatch):
    monkeypatch.setattr(liquid_window, "SPEEDS", 3)


def row(rows, start: str):
    (found,) = [r for r in rows if r.quantity.startswith(start)]
    return found


@pytest.mark.parametrize("name", ["liquid_disc", "liquid_no_internal"])
def test_a_balanced_rotor_is_refused_for_nothing_bends_it(name):
    with pytest.raises(SceneError, match=r"rotor.unbalance = 0 kg m: needs an unbalance"):
        check(load_scene(name).replace({"rotor.unbalance": 0.0}))


def test_every_case_of_the_window_is_bundled():
    windows = {name: LiquidWindow.of(load_scene(name).assembly()) for name in SCENES}
    assert any(not w.empty and w.upper is not None for w in windows.values())
    assert any(w.empty for w in windows.values())
    assert any(w.upper is None for w in windows.values())
    heavy = [n for n, w in windows.items() if w.mu == pytest.approx(20.0, rel=1e-4)]
    as_force = {load_scene(n).balancer[0].inertia_as_force for n in heavy}
    assert as_force == {True, False}
    assert any(w.touching_speeds() for w in windows.values())


SAID = {  # by scene: the row's start, and what it expects and measures
    "liquid_no_internal": ("upper boundary", "none (p = 0)", "stable at all 25 speeds"),
    "liquid_closed": (
        "window",
        "empty: (1+chi/p)^2 = 1.103 <= 2mu/(1+mu) = 1.116",
        "empty: w^* = 109.33 <= w_* = 109.985",
    ),
    "liquid_touch": ("float clear", "touches, model invalid: changes at", "touches, model invalid"),
}


@pytest.mark.parametrize("name", SCENES)
def test_every_row_of_a_bundled_scene_holds_and_says_what_is_special(name):
    rows = check(name)
    assert [r.quantity for r in rows if not r.holds] == []
    numbers = [r for r in rows if r.error is not None]
    assert all(r.error <= r.tolerance for r in numbers)
    assert row(rows, "lower boundary").tolerance == 1e-4
    assert {r.tolerance for r in numbers if "bending" in r.quantity} == {1e-5}
    assert {r.tolerance for r in numbers if "growth" in r.quantity} <= {1e-3}
    if name in SAID:
        start, expected, measured = SAID[name]
        found = row(rows, start)
        assert found.expected.startswith(expected)
        assert found.measured.startswith(measured)
        assert ("113.63 rad/s" in found.measured) == (name == "liquid_touch")


@pytest.mark.parametrize(
    ("method", "change", "start"),
    [
        ("bending", lambda value: value * (1.0 + 3e-5), "steady bending"),
        ("phase", lambda value: value + 3e-5, "phase"),
        ("roots", lambda value: tuple(1.003 * root for root in value), "growth rate"),
    ],
)
def test_a_curve_that_is_slightly_off_does_not_hold(monkeypatch, method, change, start):
    theory = getattr(LiquidWindow, method)
    monkeypatch.setattr(
        LiquidWindow, method, lambda window, *speeds: change(theory(window, *speeds))
    )
    rows = check("liquid_disc")
    assert not row(rows, start).holds
    assert [r.holds for r in rows if not r.quantity.startswith(start)] == [True] * (len(rows) - 1)


@pytest.mark.parametrize(
    ("unit", "parameter", "factor", "fails"),
    [
        ("liquid", "density", 1.01, "lower boundary"),
        ("rotor", "internal_damping", 1.01, "upper boundary"),
        ("rotor", "unbalance", 1.001, "steady bending"),
        ("rotor", "damping_x", 1.01, "growth rate"),
    ],
)
def test_units_that_are_not_those_of_the_scene_do_not_hold(
    monkeypatch, unit, parameter, factor, fails
):
    from autobalancer.harness.master import cosimulation as master

    honest = master.plan

    def altered(scene, **options):
        plan = honest(scene, **options)
        units = [
            dataclasses.replace(u, start={**u.start, parameter: u.start[parameter] * factor})
            if u.name == unit
            else u
            for u in plan.units
        ]
        return dataclasses.replace(plan, units=tuple(units))

    monkeypatch.setattr(master, "plan", altered)
    assert not row(check("liquid_disc"), fails).holds
