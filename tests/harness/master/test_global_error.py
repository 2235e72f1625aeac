"""A tolerance is kept at the end of a run, whatever becomes of errors on the way."""

import re
from dataclasses import replace

import pytest

from autobalancer.harness import load_scene
from autobalancer.harness.master.cosimulation import CoSimulation, cosimulate
from autobalancer.harness.master.recorder import Recorder
from autobalancer.harness.scene import Scene
from autobalancer.harness.truth.judge import deviations, motion

UNSTABLE = Scene.from_document(  # a disturbance grows 1,900-fold
    {
        "rotor": {
            "kind": "planar",
            "mass": 1.0,
            "stiffness": [1900.0, 6300.0],
            "damping": 6.3,
            "unbalance": 0.37,
        },
        "balancer": [
            {"kind": "pendulums", "count": 1, "mass": 3.4, "track_radius": 0.2, "drag": 6.8}
        ],
        "operation": {"speed": 100.0},
        "run": {"revolutions": 8.0},
    }
)


def error_of(scene, result):
    return max(deviations(result, motion(scene, result)).values())


@pytest.mark.parametrize("tolerance", [1e-1, 1e-2])
def test_steps_that_are_taken_back_do_not_loosen_those_to_come(tolerance):
    """Rejected trials under a loose tolerance reach a thousand times the forces there are."""
    scene = UNSTABLE.replace({"coupling.tolerance": tolerance})
    with CoSimulation(scene) as cosim:
        cosim.start()
        for _ in cosim.run():
            pass
        assert cosim.steps < 300
    assert error_of(scene, cosimulate(scene)) < tolerance


def test_a_tolerance_is_kept_where_steps_that_keep_it_lose_the_motion():
    steps = UNSTABLE.replace({"coupling.tolerance": 1e-3})
    with CoSimulation(steps) as cosim:
        recorder = Recorder(cosim.units, ["rotor.x", "rotor.y"])
        cosim.start()
        cosim.record(recorder, None)
    kept = cosimulate(steps, record=["rotor.x", "rotor.y"])
    time, signals = recorder.columns()
    once = replace(kept, time=time, signals=signals)
    assert error_of(steps, once) > 0.03
    assert error_of(steps, kept) < 1e-3


@pytest.mark.parametrize("name", ["two_balls", "run_up", "two_plane_rodrigues"])
def test_the_error_stated_is_the_true_one(name):
    scene = load_scene(name).replace(
        {"coupling.corrections": None, "coupling.tolerance": 1e-3, "run.revolutions": 5}
    )
    result = cosimulate(scene)
    true = error_of(scene, result)
    assert result.estimated_error < 1e-3
    assert true / 3.0 < result.estimated_error < 10.0 * true


def test_motions_that_part_are_told_with_the_size_of_the_error():
    """Over five times the revolutions a disturbance grows more than any step can make up for."""
    result = cosimulate(UNSTABLE.replace({"run.revolutions": 40}))
    (note,) = result.events
    assert note.startswith(
        "tolerance = 0.0001 is not kept: runs with ever shorter steps still differ"
    )
    assert "smaller run.revolutions" in note
    assert result.estimated_error > 0.03


def test_collisions_that_keep_no_tolerance_are_told_the_one_they_keep():
    """First order in the step: an error is left although no neighbouring motions part."""
    scene = Scene.from_document(
        {
            "rotor": {
                "kind": "planar",
                "mass": 3.405,
                "stiffness": 1067.0,
                "unbalance": 0.004973,
            },
            "balancer": [
                {
                    "kind": "pendulums",
                    "count": 2,
                    "mass": 0.0523,
                    "track_radius": 0.06065,
                    "weight_radius": 0.02104,
                    "angles": [4.2185, 5.3106],
                    "restitution": 1.0,
                    "speeds": [-8.7514, 23.1802],
                }
            ],
            "operation": {"speed": 74.25},
            "coupling": {"tolerance": 1e-4},
            "run": {"revolutions": 3.0},
        }
    )
    result = cosimulate(scene)
    (note,) = result.events
    kept = float(re.search(r"use coupling.tolerance = ([^,]+),", note)[1])
    assert 1e-4 < result.estimated_error <= kept < 10.0 * result.estimated_error
    assert not cosimulate(scene.replace({"coupling.tolerance": kept})).events


def test_weights_that_can_touch_are_given_steps_where_nothing_is_asked():
    document = {
        "rotor": {"kind": "planar", "mass": 1.0, "stiffness": 100.0, "damping": 5.0},
        "balancer": [
            {
                "kind": "balls",
                "count": 2,
                "mass": 0.01,
                "track_radius": 0.1,
                "weight_radius": 0.01,
                "drag": 0.1,
            }
        ],
        "operation": {"speed": 30.0},
        "run": {"revolutions": 1},
    }
    assert cosimulate(Scene.from_document(document), record=[]).steps == 40
