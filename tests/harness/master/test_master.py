"""The master against the monolith: accuracy, tolerance, what is left out, and rollback."""

from __future__ import annotations

import math
from ctypes import byref, c_size_t, c_void_p, create_string_buffer

import numpy as np
import pytest

from autobalancer.harness import Scene, SceneError, cosimulate, load_scene
from autobalancer.harness.master.cosimulation import CoSimulation
from autobalancer.harness.master.fmu import Fmu
from autobalancer.harness.scene.file import find, read
from tests.scenes import driven_scenes

pytestmark = pytest.mark.slow

LATERAL = ("rotor.x", "rotor.y")


# -- accuracy -------------------------------------------------------------------------------------


def test_two_balls_at_20_steps_and_one_corrector_pass_err_by_less_than_2e_5(against):
    runs = against("two_balls")
    result = runs.run({"steps_per_rev": 20, "corrections": 1}, LATERAL)
    assert result.steps == 400
    assert runs.of_amplitude(result) <= 2e-5


def test_weights_of_a_third_of_the_mass_err_by_less_than_3e_4_with_three_passes(
    against, heavy_weights
):
    runs = against("two_balls", heavy_weights)
    result = runs.run({"steps_per_rev": 20, "corrections": 3}, LATERAL)
    assert runs.of_amplitude(result) <= 3e-4


def observed_orders(runs, coupling, steps=(40, 80, 160)) -> np.ndarray:
    errors = []
    for number in steps:
        result = runs.run({**coupling, "steps_per_rev": number}, LATERAL)
        errors.append(runs.of_amplitude(result, number // steps[0]))
    return np.log2(np.array(errors[:-1]) / errors[1:])


@pytest.mark.parametrize("corrections", [1, None])
def test_order_4_even_with_a_single_corrector_pass(against, corrections):
    runs = against("two_balls", {"run.revolutions": 5})
    orders = observed_orders(runs, {"corrections": corrections})
    assert orders == pytest.approx(4.0, abs=0.25)


@pytest.mark.parametrize("corrections", [1, None])
@pytest.mark.parametrize("start", [0.0, 1.5])
def test_order_4_from_standstill_through_resonance_and_past_the_end_of_a_run_up(
    against, start, corrections
):
    ramp = {"from": start, "to": 5.0, "seconds": 8.0}
    runs = against("two_balls", {"operation.run_up": ramp, "run.revolutions": 6})
    orders = observed_orders(runs, {"corrections": corrections})
    assert runs.run({"steps_per_rev": 40}, LATERAL).time[-1] > 8.5, "the ramp's end is inside"
    assert orders == pytest.approx(4.0, abs=0.3)


def test_forces_of_all_balancers_on_a_plane_add_up():
    """Two balancers of one weight each are one balancer of two."""
    document = read(find("two_balls"))
    (both,) = document["balancer"]
    angles = both["angles"]
    document["balancer"] = [
        {**both, "name": name, "count": 1, "angles": [angle]}
        for name, angle in zip(("one", "other"), angles, strict=True)
    ]
    settings = {"coupling.corrections": None, "run.revolutions": 5}
    split = cosimulate(Scene.from_document(document).replace(settings))
    whole = cosimulate(load_scene("two_balls").replace(settings))
    for name in LATERAL:
        split.assert_close(name, whole[name], relative=1e-7)
    split.assert_close("other.weight[1].angle", whole["weights.weight[2].angle"], relative=1e-7)


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


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5])
def test_tolerance_is_kept_through_a_run_up(against, tolerance):
    ramp = {"from": 0.0, "to": 6.0, "seconds": 8.0}
    runs = against("two_balls", {"operation.run_up": ramp, "run.revolutions": 6})
    result = runs.run({"tolerance": tolerance})
    assert runs.of_range(result) <= 3.0 * tolerance
    assert 8.0 in result.time, "the end of the ramp is a communication point"


@pytest.mark.parametrize("order", [3, 5])
def test_at_rest_steps_last_many_revolutions_within_the_tolerance(against, order):
    """Eight a revolution, each taken in two, would be 3200."""
    runs = against("balls_and_liquid", {"run.revolutions": 200})
    coupling = {"tolerance": 1e-3, "steps_per_rev": None, "order": order}
    result = runs.run(coupling)
    assert runs.of_range(result) <= 1e-3
    assert result.steps < 900
    assert np.diff(result.time)[-3:].max() > 5.0 * 2.0 * math.pi / 250.0


def test_a_tighter_tolerance_costs_order_4_steps():
    scene = load_scene("two_balls").replace({"run.revolutions": 10})
    steps = [
        cosimulate(scene.replace({"coupling.tolerance": t}), record=[]).steps for t in (1e-4, 1e-8)
    ]
    assert math.log(1e4) / math.log(steps[1] / steps[0]) == pytest.approx(4.0, abs=0.4)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"coupling.scheme": "jacobi"}, "jacobi"),
        ({"coupling.scheme": "gauss-seidel"}, "gauss-seidel"),
        ({"coupling.order": 1}, "order 1"),
    ],
)
def test_a_tolerance_that_a_scheme_cannot_keep_is_refused(changes, said):
    scene = load_scene("two_balls").replace({"coupling.tolerance": 1e-4, **changes})
    with pytest.raises(SceneError, match=rf"coupling\.tolerance = 0\.0001.*{said}"):
        cosimulate(scene)


# -- rollback and independence --------------------------------------------------------------------


def serialised(unit: Fmu, state: c_void_p) -> bytes:
    """A saved state as bytes."""
    size, dll, component = c_size_t(), unit.fmu.dll, unit.fmu.component
    assert dll.fmi2SerializedFMUstateSize(component, state, byref(size)) == 0
    buffer = create_string_buffer(size.value)
    assert dll.fmi2SerializeFMUstate(component, state, buffer, size) == 0
    return buffer.raw


def test_rollback_brings_back_every_bit():
    with CoSimulation(load_scene("two_balls")) as cosim:
        cosim.start()
        for _ in range(7):
            cosim.step(0.1)
        system = cosim.system
        members = system.members

        def ends():
            cubics = [(*force.now, 0j, 0j) for force in system.forces]
            accelerations = system.rotor_pass(cubics, cosim.time, 0.1)
            held = [(value, slope, 0j, 0j) for value, slope in accelerations]
            return accelerations, system.balancer_pass(held, cosim.time, 0.1)

        with system.saved() as before:
            first = ends()
            system.restore(before)
            with system.saved() as again:
                for unit, was, now in zip(members, before, again, strict=True):
                    assert serialised(unit, now) == serialised(unit, was)
            assert ends() == first


def test_two_co_simulations_in_one_process_do_not_disturb_each_other():
    light = load_scene("two_balls").replace({"run.revolutions": 3})
    heavy = light.replace({"rotor.mass": 0.7, "operation.speed": 2.0, "weights.angles": [2.0, 4.0]})

    def positions(cosim):
        return cosim.read("rotor", ["x", "y"]) + cosim.read("weights", ["weight[1].angle"])

    alone = []
    for scene in (light, heavy):
        with CoSimulation(scene) as cosim:
            cosim.start()
            alone.append([positions(cosim) for _ in cosim.run()])
    with CoSimulation(light) as one, CoSimulation(heavy) as other:
        one.start()
        other.start()
        together = [
            (positions(one), positions(other)) for _ in zip(one.run(), other.run(), strict=True)
        ]
    assert [a for a, _ in together] == alone[0]
    assert [b for _, b in together] == alone[1]


def test_a_restarted_co_simulation_repeats_itself():
    with CoSimulation(load_scene("two_balls").replace({"run.revolutions": 2})) as cosim:
        runs = []
        for _ in range(2):
            cosim.start()
            runs.append([cosim.read("rotor", ["x", "y"]) for _ in cosim.run()])
    assert runs[0] == runs[1]


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


def test_without_a_watched_clearance_the_rotor_steps_alone():
    with CoSimulation(load_scene("liquid_disc"), watch=False) as cosim:
        cosim.start()
        before = {name: dict(unit.calls) for name, unit in cosim.units.items()}
        for _ in range(10):
            cosim.step(1e-3)
        assert cosim.units["liquid"].calls == before["liquid"]
        assert cosim.units["rotor"].calls == before["rotor"] | {
            "step": before["rotor"]["step"] + 10
        }


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
