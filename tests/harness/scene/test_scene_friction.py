"""Dry friction in a scene: what its keys feed, what is refused, what the coupling makes of it."""

from __future__ import annotations

import numpy as np
import pytest

from autobalancer.harness import Scene, cosimulate, load_scene, speeds
from autobalancer.harness.accuracy.precision.reference import refuse_without_reference
from autobalancer.harness.errors import SceneError, SimulationError, UserError
from autobalancer.harness.master.limits import FEWEST_CHOSEN
from autobalancer.harness.master.plan import plan
from autobalancer.harness.master.schedule import step_size
from autobalancer.harness.result.many import cosimulate_many
from autobalancer.harness.stability.axis import Axis
from autobalancer.harness.stability.map import stability_map
from autobalancer.harness.stability.revolution import Revolution
from autobalancer.models.monolith import simulate
from autobalancer.models.rotor import Slider

RIGID = {"limit": [5.0, 0.0]}
SPRING = {"support": 2, "limit": 2.0, "stiffness": [1e4, 2e4]}


def two_balls(*sliders):
    return load_scene("two_balls").replace({"rotor.friction": list(sliders)})


def test_keys_feed_the_unit_and_the_model():
    scene = load_scene("two_plane_rodrigues").replace({"rotor.friction": [RIGID, SPRING]})
    rotor = plan(scene).units[0]
    assert rotor.sizes["sliders"] == 2
    assert {k: v for k, v in rotor.start.items() if k.startswith("slider")} == {
        "slider[1].support": 1, "slider[1].limit_x": 5.0, "slider[1].limit_y": 0.0,
        "slider[2].support": 2, "slider[2].limit_x": 2.0, "slider[2].limit_y": 2.0,
        "slider[2].stiffness_x": 1e4, "slider[2].stiffness_y": 2e4,
    }  # fmt: skip
    assert scene.assembly().rotor.sliders == (
        Slider(0, 0, 5.0, support=1), Slider(0, 1, 0.0, support=1),
        Slider(1, 0, 2.0, 1e4, support=2), Slider(1, 1, 2.0, 2e4, support=2),
    )  # fmt: skip


def test_scenes_without_friction_ask_for_the_unit_they_always_did():
    assert plan(load_scene("two_balls")).units[0].sizes == {}
    assert "sliders" not in plan(load_scene("drum")).units[0].sizes


@pytest.mark.parametrize(
    ("sliders", "said"),
    [
        ([SPRING], "must be 1: a planar rotor has one support"),
        ([RIGID, {"limit": 1.0}], "two rigid sliders at one support and axis are one with the sum"),
        ([{"limit": -1.0}], "greater than or equal to 0|must be .*0"),
        ([{}], "limit"),
    ],
)
def test_mistakes_are_named(sliders, said):
    with pytest.raises(SceneError, match=said):
        two_balls(*sliders)


@pytest.mark.parametrize(
    "analysis",
    [
        lambda scene: speeds(scene, (1.0, 2.0)),
        lambda scene: scene.rotor(),
        lambda scene: Revolution(scene),
        refuse_without_reference,
        lambda scene: stability_map(
            scene, Axis.parse("speed=1:2:3"), Axis.parse("weights.drag=0.1:0.2:3")
        ),
    ],
)
def test_what_takes_the_rotor_for_linear_refuses_it(analysis):
    with pytest.raises((UserError, SimulationError), match="dry friction is not"):
        analysis(two_balls(RIGID))


SLIDING = [{"limit": 0.01}, {"limit": 0.02, "stiffness": 5.0}]


TURNING = {
    "rotor": {"kind": "planar", "mass": 2.0, "stiffness": 8e3, "damping": 40.0, "unbalance": 2e-3},
    "balancer": [
        {"kind": "balls", "name": "weights", "count": 2, "mass": 0.02, "track_radius": 0.1,
         "drag": 0.6, "angles": [0.4, 2.5]}
    ],
    "operation": {"speed": 150.0},
    "run": {"revolutions": 2},
}  # fmt: skip


def off(slider: dict, **coupling) -> float:
    """Largest error of x and y, by an integration from event to event, over the amplitude."""
    scene = Scene.from_document(TURNING | {"coupling": coupling}).replace(
        {"rotor.friction": [slider]}
    )
    run = cosimulate(scene)
    true = simulate(scene.assembly(), scene.profile(), run.time, rtol=1e-11)
    errors = [np.abs(run[name] - true[name]).max() for name in ("rotor.x", "rotor.y")]
    return max(errors) / np.abs(run["rotor.x"]).max()


@pytest.mark.parametrize("separate", [True, False])
def test_events_draw_communication_points_no_further_apart(separate):
    """Steps longer than the longest would count as those of a rotor at rest, and hold signals."""
    scene = Scene.from_document(TURNING | {"coupling": {"tolerance": 1e-4}}).replace(
        {"rotor.friction": [{"limit": [4.0, 3.0], "stiffness": 4e4}], "run.revolutions": 10}
    )
    run = cosimulate(scene, separate=separate)
    assert np.diff(run.time).max() < 0.501 * step_size(scene, FEWEST_CHOSEN)


def test_a_tolerance_is_met_across_a_jump():
    """In separate units and in C."""
    scene = two_balls({"limit": 0.01}).replace({"run.revolutions": 0.4})
    fine = cosimulate(scene.replace({"coupling.steps_per_rev": 20000}))
    scene = scene.replace({"coupling.tolerance": 1e-6})
    ends = {"separate units": cosimulate(scene)["rotor.x"][-1]}
    one = cosimulate_many(scene, {"speed": [3.0]}, results=["rotor.x"])
    ends["composite"] = one["rotor.x"][0]
    expected, size = fine["rotor.x"][-1], np.ptp(fine["rotor.x"])
    assert ends == pytest.approx(dict.fromkeys(ends, expected), abs=2e-6 * size)
