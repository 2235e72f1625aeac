"""Quintic signals, `coupling.order = 5`: what they are worth, what they are refused for."""

from __future__ import annotations

import pytest

from autobalancer.fmus.catalogue import sized_unit
from autobalancer.fmus.composite.composition import Composition, Part
from autobalancer.harness import Scene, SceneError, cosimulate, load_scene
from autobalancer.harness.master.one_file import composition
from autobalancer.harness.master.plan import plan
from autobalancer.harness.master.schedule import order_of_run

LATERAL = ("rotor.x", "rotor.y")
RUN_UP = {"operation.run_up": {"from": 0.3, "to": 3.0, "seconds": 8.0}, "operation.speed": None}
MOTOR = {"inertia": 1.0, "stall_torque": 1.0, "no_load_speed": 3.0, "from": 0.5}


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


@pytest.mark.slow
@pytest.mark.parametrize(("separate", "order"), [(True, 3), (False, 3), (False, 5)])
def test_a_tight_tolerance_is_kept_past_the_end_of_a_run_up(against, separate, order):
    runs = against("two_balls", {**RUN_UP, "run.revolutions": 20})
    tight = {"tolerance": 1e-7, "steps_per_rev": None, "corrections": None, "scheme": "auto"}
    keys = {f"coupling.{key}": value for key, value in {**tight, "order": order}.items()}
    result = cosimulate(runs.scene.replace(keys), record=LATERAL, separate=separate)
    assert result.time[-1] > 8.0
    assert runs.of_amplitude(result) <= 1e-7


@pytest.mark.parametrize("corrections", [1, None])
def test_long_steps_go_on_behind_a_run_up_from_second_derivatives_that_are_right(
    against, corrections
):
    runs = against("two_balls", {**RUN_UP, "run.revolutions": 6})
    keys = {"scheme": "iterated", "order": 5, "steps_per_rev": 10, "corrections": corrections}
    scene = runs.scene.replace({f"coupling.{key}": value for key, value in keys.items()})
    result = cosimulate(scene, record=LATERAL)
    assert runs.of_amplitude(result) <= 3e-5


@pytest.mark.slow
@pytest.mark.parametrize("drive", [{}, RUN_UP], ids=["constant", "run_up"])
def test_a_track_off_the_centre_costs_no_order(against, drive):
    aside = {"weights.track_offset_xi": 0.02, "weights.track_offset_eta": -0.01}
    scene = against("two_balls", {**aside, **drive, "run.revolutions": 4})
    steps = {"scheme": "iterated", "corrections": 1, "order": 5}
    errors = [
        scene.of_amplitude(scene.run({**steps, "steps_per_rev": n}, LATERAL)) for n in (20, 40)
    ]
    assert errors[1] <= errors[0] / 2**5.5


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


def test_separate_units_are_coupled_in_cubics_alone():
    scene = load_scene("two_balls").replace({"coupling.order": 5})
    with pytest.raises(SceneError, match=r"coupling.order = 5: .* give order 3"):
        cosimulate(scene, separate=True)
    open_order = load_scene("two_balls").replace({**OPEN, "coupling.tolerance": 1e-4})
    assert not any("order" in name for name in cosimulate(open_order, separate=True).units)


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


def test_a_run_up_under_heavy_drag_keeps_cubics():
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
    result = cosimulate(Scene.from_document(document))
    assert result.estimated_error < 1e-6
