"""Many checks on one executor: rows in their order, and a run that fails costs its check alone."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import pytest

from autobalancer.harness import Scene, cosimulate, load_scene
from autobalancer.harness.checks import registry
from autobalancer.harness.checks.filimonikhina import TABLES
from autobalancer.harness.checks.row import Rows
from autobalancer.harness.checks.runner import check, check_all
from autobalancer.harness.errors import SceneError, SimulationError
from autobalancer.harness.master.left_out import left_out
from autobalancer.harness.scene.file import read

pytestmark = pytest.mark.slow


def made_of(*checks: dict) -> Scene:
    """The liquid disc with these checks."""
    document = read(load_scene("liquid_disc").path)
    document["check"] = list(checks)
    return Scene.from_document(document, label="liquid_disc")


WINDOW = {"kind": "liquid_window"}
SPEEDS = {"kind": "critical_speeds", "range": [1.0, 2.0]}
TABLE = {"kind": "filimonikhina_table"}


@pytest.fixture
def kinds(monkeypatch):
    """Checks that measure nothing: a window fails."""

    def holds(scene, index=0, check=None):
        kind = "filimonikhina_table" if check is None else check.kind
        yield Rows(scene.name, kind).statement(f"row {index}", "a", "a", True, "")

    def fails(scene):
        yield Rows(scene.name, "liquid_window").statement("lost", "a", "a", True, "")
        raise SimulationError("the loop did not converge")

    for kind in ("critical_speeds", "filimonikhina_table"):
        monkeypatch.setitem(registry.CHECKS, kind, holds)
    monkeypatch.setitem(registry.CHECKS, "liquid_window", fails)


@pytest.mark.usefixtures("kinds")
def test_a_run_that_fails_is_one_row_beside_those_of_the_other_checks():
    first, second = check_all([made_of(SPEEDS, WINDOW), made_of(TABLE)], workers=1)
    assert [(row.check, row.holds) for row in first.rows] == [
        ("critical_speeds", True),
        ("liquid_window", False),
    ]
    assert first.rows[1].measured == "the loop did not converge"
    assert all(row.holds for row in second.rows)


@pytest.mark.usefixtures("kinds")
def test_rows_keep_the_order_of_the_scene_on_an_executor_of_the_callers():
    with ThreadPoolExecutor(2) as executor:
        (report,) = check_all([made_of(TABLE, SPEEDS)], workers=executor)
    assert [row.quantity for row in report.rows[:-1]] == [f"row {i}" for i in range(len(TABLES))]
    assert report.rows[-1].check == "critical_speeds"


@pytest.mark.usefixtures("kinds")
def test_progress_rises_to_one_for_every_scene():
    seen: list[float] = []
    check_all([made_of(SPEEDS, TABLE)], lambda _name, done: seen.append(done), workers=1)
    assert seen == sorted(seen)
    assert len(seen) == 1 + len(TABLES)
    assert seen[-1] == 1.0


@pytest.mark.usefixtures("kinds")
def test_a_single_check_raises_what_went_wrong():
    with pytest.raises(SimulationError, match="did not converge"):
        check(made_of(SPEEDS, WINDOW))


def test_a_scene_without_checks_is_refused():
    with pytest.raises(SceneError, match="nothing to check"):
        check_all([load_scene("two_balls")])


def test_every_kind_of_check_has_one_function():
    kinds = {check.kind for name in SCENES for check in load_scene(name).checks}
    assert kinds <= {*registry.CHECKS}


SCENES = ("liquid_disc", "regions", "filimonikhina_tables", "goncharov_balls")


@pytest.mark.parametrize("scheme", ["jacobi", "gauss-seidel", "compensated", "iterated", "auto"])
@pytest.mark.parametrize("name", ["two_balls", "liquid_disc"])
def test_passes_and_rollback_are_said_to_be_left_out_where_no_state_is_saved(name, scheme):
    coupling = {"coupling.scheme": scheme, "coupling.corrections": None, "run.revolutions": 1}
    order = 1 if scheme == "jacobi" else 3  # with cubics Jacobi is unstable at any step
    scene = load_scene(name).replace(
        {**coupling, "coupling.tolerance": None, "coupling.order": order}
    )
    said = any("rollback" in note for note in left_out(scene, ["all"]))
    run = cosimulate(scene, separate=True)
    assert said is (run.calls.get("save", 0) == 0)
    assert list(run.left_out) == left_out(scene, ["all"])


def test_units_of_a_report_are_those_a_run_loads():
    scene = made_of({"kind": "goncharov_table"}).replace({"run.revolutions": 1})
    (report,) = check_all([scene], workers=1)
    assert report.units == cosimulate(scene, separate=True).units
