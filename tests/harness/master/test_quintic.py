"""Quintic signals, `coupling.order = 5`: what they are worth, what they are refused for."""

from __future__ import annotations

import numpy as np
import pytest

from autobalancer.fmus.catalogue import sized_unit
from autobalancer.fmus.composite.composition import Composition, Part
from autobalancer.harness import Scene, SceneError, cosimulate, load_scene
from autobalancer.harness.master.cosimulation import CoSimulation
from autobalancer.harness.master.one_file import composition
from autobalancer.harness.master.plan import plan
from autobalancer.harness.master.schedule import order_of_run
from autobalancer.harness.master.signals import (
    MISS_PER_ERROR,
    SignalState,
    end_of,
    extrapolated,
    hermite,
)
from autobalancer.harness.master.unit_files import find_or_build

LATERAL = ("rotor.x", "rotor.y")
RUNTIMES = ("native", "python")
RUN_UP = {"operation.run_up": {"from": 0.3, "to": 3.0, "seconds": 8.0}, "operation.speed": None}
MOTOR = {"inertia": 1.0, "stall_torque": 1.0, "no_load_speed": 3.0, "from": 0.5}
MOVED = [1e-3 - 2e-3j, 0.5 + 0.1j, -40.0 + 9.0j, 3e3, -2e5j, 4e6 + 1e6j]


def polynomial(t: float, k: int) -> complex:
    """k-th derivative of a polynomial of degree 5, by NumPy."""
    coefficients = np.array(MOVED) / np.cumprod([1, 1, 2, 3, 4, 5])
    return complex(np.polynomial.Polynomial(coefficients).deriv(k)(t))


def test_the_quintic_before_continues_any_quintic():
    past, step = 0.01, 0.003
    knots = [tuple(polynomial(t, k) for k in range(3)) for t in (0.0, past, past + step)]
    before = hermite(knots[0], knots[1], past)
    ahead = extrapolated(knots[1], before, past, 5)
    assert end_of(ahead, step) == pytest.approx(knots[2], rel=1e-9)


def test_a_prediction_misses_1120_times_as_far_as_a_quintic_errs_on_average():
    # of t^6 the sixth derivative is constant, and both errors are what the formulas say
    knots = [(t**6 + 0j, 6 * t**5 + 0j, 30 * t**4 + 0j) for t in (0.0, 1.0, 2.0)]
    signal = SignalState(now=knots[1], last=hermite(knots[0], knots[1], 1.0), last_step=1.0)
    own = hermite(knots[1], knots[2], 1.0)
    signal.move(own, knots[2], 1.0)
    times = np.linspace(0.0, 1.0, 2001)
    errors = [abs((1.0 + t) ** 6 - end_of(own, float(t))[0]) for t in times]
    assert signal.prediction_error / np.mean(errors) == pytest.approx(MISS_PER_ERROR[5], rel=1e-3)


def test_forty_quintic_steps_are_a_hundred_times_better_than_forty_cubic_ones(against):
    scene = against("two_balls")
    steps = {"scheme": "iterated", "corrections": 1, "steps_per_rev": 40}
    cubic, quintic = (
        scene.of_amplitude(scene.run({**steps, "order": order}, LATERAL)) for order in (3, 5)
    )
    assert cubic > 100.0 * quintic > 0.0


def test_a_tight_tolerance_is_kept_with_fewer_steps_than_cubics_take(against):
    scene = against("two_balls", {"run.revolutions": 5})
    steps = {}
    for order in (3, 5):
        keys = {"tolerance": 1e-7, "steps_per_rev": None, "order": order, "corrections": None}
        result = scene.run({**keys, "scheme": "auto"}, LATERAL)
        assert result.estimated_error <= 1e-7
        steps[order] = result.steps
        assert scene.of_amplitude(result) <= 1e-7
    assert steps[5] < 0.6 * steps[3]


def test_one_pass_that_is_compensated_is_twenty_times_better_for_the_price_of_its_start(against):
    scene = against("two_balls", {"run.revolutions": 4})
    one_pass = {"scheme": "compensated", "corrections": None, "steps_per_rev": 40}
    cubic, quintic = (scene.run({**one_pass, "order": order}, LATERAL) for order in (3, 5))
    assert quintic.passes == cubic.passes + 2
    assert scene.of_amplitude(cubic) > 20.0 * scene.of_amplitude(quintic) > 0.0


@pytest.mark.parametrize("order", [3, 5])
@pytest.mark.parametrize("separate", [True, False])
def test_a_tight_tolerance_is_kept_past_the_end_of_a_run_up(against, separate, order):
    runs = against("two_balls", {**RUN_UP, "run.revolutions": 20})
    tight = {"tolerance": 1e-7, "steps_per_rev": None, "corrections": None, "scheme": "auto"}
    keys = {f"coupling.{key}": value for key, value in {**tight, "order": order}.items()}
    result = cosimulate(runs.scene.replace(keys), record=LATERAL, separate=separate)
    assert result.time[-1] > 8.0
    assert runs.of_amplitude(result) <= 1e-7


@pytest.mark.parametrize("corrections", [1, None])
@pytest.mark.parametrize("separate", [True, False])
def test_long_steps_go_on_behind_a_run_up_from_second_derivatives_that_are_right(
    against, separate, corrections
):
    runs = against("two_balls", {**RUN_UP, "run.revolutions": 6})
    keys = {"scheme": "iterated", "order": 5, "steps_per_rev": 10, "corrections": corrections}
    scene = runs.scene.replace({f"coupling.{key}": value for key, value in keys.items()})
    result = cosimulate(scene, record=LATERAL, separate=separate)
    assert runs.of_amplitude(result) <= 3e-5


@pytest.mark.parametrize("drive", [{}, RUN_UP], ids=["constant", "run_up"])
def test_a_track_off_the_centre_costs_no_order(against, drive):
    aside = {"weights.track_offset_xi": 0.02, "weights.track_offset_eta": -0.01}
    scene = against("two_balls", {**aside, **drive, "run.revolutions": 4})
    steps = {"scheme": "iterated", "corrections": 1, "order": 5}
    errors = [
        scene.of_amplitude(scene.run({**steps, "steps_per_rev": n}, LATERAL)) for n in (20, 40)
    ]
    assert errors[1] <= errors[0] / 2**5.5


@pytest.mark.parametrize("units", RUNTIMES)
def test_both_runtimes_meet_the_loop_of_a_heavy_balancer(against, heavy_weights, units):
    changes = {**heavy_weights, "weights.inertia_as_force": True, "run.revolutions": 2}
    scene = against("two_balls", changes)
    keys = {"scheme": "iterated", "order": 5, "steps_per_rev": 80}
    keys |= {"corrections": None, "units": units}
    assert scene.of_amplitude(scene.run(keys, LATERAL)) <= 1e-7


# over the end of a run-up each rounds in eight negligible steps, with cubics too
@pytest.mark.parametrize(
    ("drive", "allowed"), [({}, 1e-11), (RUN_UP, 1e-10)], ids=["constant", "run_up"]
)
def test_both_runtimes_compensate_alike(drive, allowed):
    scene = load_scene("two_balls").replace(
        {
            **drive,
            "coupling.scheme": "compensated",
            "coupling.corrections": None,
            "coupling.order": 5,
            "run.revolutions": 3,
        }
    )
    native, python = (cosimulate(scene.replace({"coupling.units": u})) for u in RUNTIMES)
    for signal, values in native.signals.items():
        assert np.abs(python[signal] - values).max() <= allowed * np.ptp(values), signal


def test_the_loop_gain_does_not_depend_on_the_order(heavy_weights):
    gains = []
    for order in (3, 5):
        scene = load_scene("two_balls").replace({**heavy_weights, "coupling.order": order})
        with CoSimulation(scene) as cosim:
            cosim.start()
            gains.append(cosim.gain)
    assert gains[1] == pytest.approx(gains[0], rel=1e-9)


def test_only_the_units_of_such_a_scene_are_built_for_it():
    scene = load_scene("two_balls")
    assert all("order" not in unit.sizes for unit in plan(scene).units)
    quintic = plan(scene.replace({"coupling.order": 5}))
    assert [unit.sizes["order"] for unit in quintic.units] == [5, 5]
    assert "order-5" in quintic.units[0].file_name


OPEN = {"coupling.order": None, "coupling.corrections": None, "coupling.scheme": "auto"}


@pytest.mark.parametrize(
    ("changes", "order"),
    [
        ({"coupling.tolerance": 1e-4}, 5),
        ({"coupling.tolerance": 2e-4}, 3),
        ({"coupling.tolerance": 1e-4, "coupling.order": 3}, 3),
        ({"coupling.steps_per_rev": 40}, 3),
        ({"coupling.tolerance": 1e-4, **RUN_UP}, 3),
        ({"coupling.tolerance": 1e-5, **RUN_UP}, 5),
        ({"coupling.tolerance": 1e-6, "weights.rolling_resistance": 0.01}, 3),
        ({"coupling.tolerance": 1e-6, "rotor.friction": [{"limit": 0.1}]}, 3),
    ],
)
def test_a_run_takes_quintics_where_nothing_is_said_and_a_tolerance_pays_for_them(changes, order):
    assert order_of_run(load_scene("two_balls").replace({**OPEN, **changes})) == order


def test_nothing_is_exchanged_in_quintics_where_no_force_is():
    scene = load_scene("liquid_disc")
    assert scene.takes_quintics
    assert order_of_run(scene) == 3


def test_units_built_for_a_scene_that_leaves_the_order_open_run_it_in_cubics(tmp_path):
    """Connections of other tools do not change with what pays here."""
    scene = load_scene("two_balls").replace({**OPEN, "coupling.tolerance": 1e-4})
    for path in find_or_build(plan(scene).units):
        (tmp_path / path.name).write_bytes(path.read_bytes())
    kept, own = cosimulate(scene, fmus=tmp_path), cosimulate(scene)
    assert not any("order" in name for name in kept.units)
    assert all("order-5" in name for name in own.units)
    assert own.steps < kept.steps


@pytest.mark.parametrize("name", ["two_balls", "two_plane_rodrigues", "balls_and_liquid"])
def test_one_file_takes_the_same_order_and_the_same_steps(name):
    scene = load_scene(name).replace({**OPEN, "coupling.tolerance": 1e-4, "run.revolutions": 5})
    expected, found = cosimulate(scene, separate=True), cosimulate(scene)
    assert order_of_run(scene) == 5
    assert found.steps == expected.steps
    for signal, values in expected.signals.items():
        assert np.abs(found[signal] - values).max() <= 1e-11 * np.ptp(values), signal


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"operation.speed": None, "operation.motor": MOTOR}, "operation.motor"),
        (
            {"rotor.friction": [{"limit": 0.1}]},
            "rotor.friction: not with coupling.order = 5: the rotor",
        ),
        ({"weights.weight_radius": 0.1}, "balancer[1].weight_radius"),
        ({"weights.rolling_resistance": 0.01}, "balancer[1].rolling_resistance"),
        ({"coupling.scheme": "jacobi"}, "coupling.order"),
    ],
)
def test_what_has_no_second_derivatives_is_refused_by_the_name_of_its_key(changes, named):
    with pytest.raises(SceneError) as refused:
        load_scene("two_balls").replace({"coupling.order": 5, **changes})
    assert named in str(refused.value)


def test_one_file_couples_by_cubics_or_quintics():
    with pytest.raises(SceneError, match="order = 1: of one file must be 3 or 5"):
        composition(load_scene("two_balls").replace({"coupling.order": 1}))


def test_parts_of_one_file_exchange_signals_of_one_order():
    parts = Part("rotor", "RotorOnSupports"), Part("balls", "BallBalancer", {"order": 5}, plane=1)
    with pytest.raises(ValueError, match="balls: order = 5: must be 3, as the rotor's"):
        Composition(parts)


def test_dry_friction_has_no_unit_with_quintic_signals():
    with pytest.raises(ValueError, match="order = 5: must be 3 with dry friction, sliders = 1"):
        sized_unit("RotorOnSupports", sliders=1, order=5)
    with pytest.raises(ValueError, match="order = 4: must be one of 3, 5"):
        sized_unit("BallBalancer", order=4)


@pytest.mark.parametrize("separate", [True, False])
def test_a_run_up_under_heavy_drag_keeps_cubics(separate):
    """Quintics found no step short enough for what the end of this run-up leaves in a weight."""
    document = {
        "rotor": {
            "kind": "planar", "mass": 5.293, "stiffness": [3520.12, 1535.28],
            "damping": [0.02306, 0.2073], "unbalance": 2.427e-6,
        },
        "balancer": [{
            "kind": "pendulums", "count": 1, "mass": 0.327, "track_radius": 0.1492,
            "drag": 10440.0, "angles": [4.76],
        }],
        "operation": {"run_up": {"from": 0.0, "to": 135.7, "seconds": 0.01076}, "gravity": 1.955},
        "run": {"revolutions": 0.34},
        "coupling": {"tolerance": 1e-6},
    }  # fmt: skip
    result = cosimulate(Scene.from_document(document), separate=separate)
    assert result.estimated_error < 1e-6
