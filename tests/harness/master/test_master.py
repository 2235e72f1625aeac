"""The master against the monolith: accuracy, tolerance, what is left out, and rollback."""

from __future__ import annotations

import math

import numpy as np
import pytest

from autobalancer.harness import SceneError, cosimulate, load_scene
from autobalancer.harness.master.cosimulation import CoSimulation
from autobalancer.harness.master.fmu import Fmu
from autobalancer.models.monolith import simulate
from tests.scenes import driven_scenes

pytestmark = pytest.mark.slow

LATERAL = ("rotor.x", "rotor.y")


# -- accuracy -------------------------------------------------------------------------------------


def test_two_balls_at_20_rows_a_revolution_err_by_less_than_2e_5(against):
    runs = against("two_balls")
    result = runs.run({"steps_per_rev": 20, "corrections": 1}, LATERAL)
    assert len(result.time) == 401
    assert runs.of_amplitude(result) <= 2e-5


# -- tolerance ------------------------------------------------------------------------------------


# no tolerance is kept across a meeting of weights: tests/harness/master/test_master_errors.py
@pytest.mark.parametrize(
    "name",
    [
        n
        for n in driven_scenes()
        if n not in ("contact_order", "bristol_friction", "bristol_flexible")
    ],
)
def test_tolerance_is_kept_on_every_bundled_scene(against, name):
    runs = against(name, {"run.revolutions": 4})
    tolerances = (1e-3, 1e-5, 1e-7)
    coupling = {"scheme": "auto", "steps_per_rev": None}
    results = [runs.run({**coupling, "tolerance": tolerance}) for tolerance in tolerances]
    errors = runs.of_ranges(results)
    assert all(e <= 3.0 * t for e, t in zip(errors, tolerances, strict=True)), errors


def test_steps_of_a_machine_with_much_drag_are_longer_than_its_fastest_decay():
    """By collocation: by series each would last at most a few 60ths of a radian."""
    balanced = {"rotor.unbalance": 0.0, "weights.angles": [0.5, 0.5 + math.pi]}
    changes = {"run.revolutions": 300, "run.initial.x": 0.01, "weights.drag": 200.0}
    coupling = {"coupling.tolerance": 1e-3, "coupling.steps_per_rev": None}
    scene = load_scene("two_balls").replace({**balanced, **changes, **coupling})
    result = cosimulate(scene)
    drive, start = scene.operation.drive(), scene.run.initial.motion()
    right = simulate(
        scene.assembly(), drive, result.time, initial=start, method="Radau", rtol=1e-8
    ).signal("rotor.x")
    assert np.abs(result["rotor.x"] - right).max() <= 1e-3 * np.ptp(right)
    assert result.steps < 12 * 300
    assert result.collocated_steps > 0.9 * result.steps


@pytest.mark.parametrize("separate", [True, False])
def test_a_tight_tolerance_is_kept_past_the_end_of_a_run_up(against, separate):
    run_up = {"operation.run_up": {"from": 0.3, "to": 3.0, "seconds": 8.0}}
    runs = against("two_balls", {**run_up, "operation.speed": None, "run.revolutions": 20})
    tight = {"tolerance": 1e-7, "steps_per_rev": None, "corrections": None, "scheme": "auto"}
    result = runs.run(tight, LATERAL, separate=separate)
    assert result.time[-1] > 8.0
    assert runs.of_amplitude(result) <= 1e-7


def test_a_tighter_tolerance_costs_few_steps_in_one_piece():
    """The order of the series rises with the digits."""
    scene = load_scene("two_balls").replace({"run.revolutions": 10})
    steps = [
        cosimulate(scene.replace({"coupling.tolerance": t}), record=[]).steps for t in (1e-4, 1e-8)
    ]
    assert steps[1] < 1.5 * steps[0]


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"coupling.scheme": "jacobi"}, "jacobi"),
        ({"coupling.scheme": "gauss-seidel"}, "gauss-seidel"),
        ({"coupling.scheme": "compensated"}, '"compensated"'),
        ({"coupling.order": 1}, "order 1"),
    ],
)
def test_a_tolerance_that_a_scheme_cannot_keep_is_refused(changes, said):
    scene = load_scene("two_balls").replace({"coupling.tolerance": 1e-4, **changes})
    with pytest.raises(SceneError, match=rf"coupling\.tolerance = 0\.0001.*{said}"):
        cosimulate(scene, separate=True)


# -- rollback and independence --------------------------------------------------------------------


def test_results_do_not_depend_on_what_is_recorded():
    scene = load_scene("two_balls").replace({"run.revolutions": 3})
    much = cosimulate(
        scene, record=["weights.spread", "rotor.x", "rotor.bending", "weights.F_xi", "rotor.angle"]
    )
    little = cosimulate(scene, record=["rotor.x"])
    assert (much["rotor.x"] == little["rotor.x"]).all()
    assert much["rotor.angle"] == pytest.approx(3.0 * much.time, abs=1e-12)


# -- what is left out -----------------------------------------------------------------------------


def calls_per_step(scene, **options) -> dict[str, float]:
    """FMI calls a step of the run, without those of the start, and what was recorded."""
    counts = []
    for revolutions in (2, 4):
        longer = scene.replace({"run.revolutions": revolutions})
        result = cosimulate(longer, separate=True, **options)
        counts.append((result.steps, result.calls))
    (few, short), (many, long) = counts
    return {kind: (long[kind] - short[kind]) / (many - few) for kind in long}


def test_a_liquid_that_is_all_added_mass_exchanges_no_force_and_never_rolls_back():
    scene = load_scene("liquid_disc")
    calls = calls_per_step(scene, record=[])
    # the rotor steps; the liquid is told where its plane is, and steps, for its clearance only
    assert calls == {"step": 2, "get": 1, "set": 1, "save": 0, "restore": 0, "reset": 0}
    left_out = " ".join(cosimulate(scene.replace({"run.revolutions": 1})).left_out)
    for what in ("force exchange", "rollback", "variable speed", "second axis", "BallBalancer"):
        assert what in left_out


def test_recording_nothing_reads_nothing():
    scene = load_scene("two_balls")
    nothing = calls_per_step(scene, record=[])
    something = calls_per_step(scene, record=["rotor.x", "rotor.y", "weights.spread"])
    assert something["get"] == nothing["get"] + 2  # one call a unit
    for kind in ("set", "step", "save", "restore"):
        assert something[kind] == nothing[kind]
    assert cosimulate(scene.replace({"run.revolutions": 1}), record=[]).signals == {}


def test_explicit_schemes_neither_save_nor_restore():
    scene = load_scene("two_balls").replace({"coupling.scheme": "gauss-seidel"})
    calls = calls_per_step(scene, record=[])
    assert calls == {"step": 2, "get": 2, "set": 2, "save": 0, "restore": 0, "reset": 0}


@pytest.mark.parametrize(
    ("order", "forces", "accelerations"),
    [
        (0, "F_xi F_eta", "a_xi a_eta"),
        (1, "F_xi F_eta der(F_xi) der(F_eta)", "a_xi a_eta der(a_xi) der(a_eta)"),
    ],
)
def test_held_and_linear_signals_set_no_derivatives_they_do_not_use(
    monkeypatch, order, forces, accelerations
):
    written: dict[str, set] = {}
    plain = Fmu.exchange

    def spy(unit, inputs, *rest):
        written.setdefault(unit.name, set()).update(inputs.names)
        plain(unit, inputs, *rest)

    scene = load_scene("two_balls").replace({"coupling.order": order, "run.revolutions": 1})
    with CoSimulation(scene) as cosim:
        cosim.start()
        monkeypatch.setattr(Fmu, "exchange", spy)
        cosim.step(0.05)
    assert {name.replace("plane[1].", "") for name in written["rotor"]} == set(forces.split())
    assert written["weights"] == set(accelerations.split())


def test_only_the_units_of_the_scene_are_loaded():
    scene = load_scene("two_balls").replace({"run.revolutions": 1})
    result = cosimulate(scene, record=[], separate=True)
    assert sorted(name.split("-")[0].removesuffix(".fmu") for name in result.units) == [
        "BallBalancer",
        "RotorOnSupports",
    ]
    assert "LiquidBalancer (none in the scene)" in result.left_out
