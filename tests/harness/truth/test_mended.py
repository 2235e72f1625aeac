"""Scenes that once went wrong in silence, or were refused though right, cut down to the least."""

import pytest

from autobalancer.harness.errors import SimulationError
from autobalancer.harness.master.cosimulation import cosimulate
from autobalancer.harness.scene import Scene
from autobalancer.harness.truth.judge import deviations, motion

SOFT_DISC = {"kind": "planar", "mass": 1.0, "stiffness": 100.0, "damping": 1.0}
STIFF_RUN_UP = {
    "rotor": {
        "kind": "planar",
        "mass": 1.0,
        "stiffness": 1.0e6,
        "damping": 5.0,
        "unbalance": 0.001,
    },
    "operation": {"run_up": {"from": 20.0, "to": 40.0, "seconds": 2.0}},
    "run": {"revolutions": 4.0},
}
RIGHT = {
    "a run-up on stiff supports": STIFF_RUN_UP,
    "a run-up with a tolerance": {**STIFF_RUN_UP, "coupling": {"tolerance": 1e-6}},
    "a run-up of an undamped rotor with liquid": {
        "rotor": {
            "kind": "planar",
            "mass": 0.3218,
            "stiffness": [703100000.0, 123400000.0],
            "damping": [0.0, 0.0],
            "unbalance": 0.002894,
        },
        "balancer": [
            {
                "kind": "liquid",
                "chamber_radius": 0.06319,
                "float_radius": 0.02479,
                "height": 0.01309,
                "density": 1000.0,
            }
        ],
        "operation": {"run_up": {"from": 438.7, "to": 576.8, "seconds": 0.2013}},
        "coupling": {"steps_per_rev": 20},
        "run": {"revolutions": 17.12},
    },
    "weights that heavy drag takes along in a run-up": {
        "rotor": {
            "kind": "planar",
            "mass": 3.0,
            "stiffness": 9.0e4,
            "damping": 50.0,
            "unbalance": 0.001,
        },
        "balancer": [
            {
                "kind": "pendulums",
                "count": 2,
                "mass": 0.1,
                "track_radius": 0.5,
                "drag": 5.0e5,
                "angles": [3.0, 4.0],
                "speeds": [20.0, 20.0],
            }
        ],
        "operation": {"run_up": {"from": 0.0, "to": 30.0, "seconds": 6.0}},
        "coupling": {"tolerance": 1e-4},
        "run": {"revolutions": 14.0},
    },
    "two weights whose pulls cancel at the start": {
        "rotor": {**SOFT_DISC, "unbalance": 0.004},
        "balancer": [
            {"kind": "pendulums", "count": 2, "mass": 0.2, "track_radius": 0.05, "drag": 0.5}
        ],
        "operation": {"speed": 200.0},
        "run": {"revolutions": 1.0},
    },
    "a balanced rotor's run-up with a weight all but fixed by drag": {
        "rotor": {"kind": "planar", "mass": 3.0, "stiffness": 2000000.0, "unbalance": 0.0},
        "balancer": [
            {"kind": "pendulums", "count": 1, "mass": 0.05, "track_radius": 0.3, "drag": 30000.0}
        ],
        "operation": {"run_up": {"from": 0.0, "to": 300.0, "seconds": 0.2}},
        "run": {"revolutions": 0.3},
    },
}


@pytest.mark.parametrize("name", RIGHT)
def test_is_right_to_a_thousandth(name):
    scene = Scene.from_document(RIGHT[name])
    result = cosimulate(scene)
    errors = deviations(result, motion(scene, result))
    tolerance = scene.coupling.tolerance
    allowed = 1e-3 if tolerance is None else 3.0 * tolerance
    assert max(errors.values()) < allowed, errors


def test_a_tolerance_on_a_perfectly_balanced_rotor_ends():
    """All forces are rounding: no step is short enough for a millionth of that."""
    balls = {"kind": "balls", "count": 2, "mass": 0.05, "track_radius": 0.2, "drag": 0.1}
    scene = Scene.from_document(
        {
            "rotor": SOFT_DISC,
            "balancer": [balls],
            "operation": {"speed": 30.0},
            "coupling": {"tolerance": 1e-6},
        }
    )
    result = cosimulate(scene, record=["rotor.x", "rotor.y"])
    assert result.steps < 10_000
    assert max(abs(result["rotor.x"])) < 1e-12


def test_heavy_liquid_as_a_force_on_a_lightly_damped_rotor_is_not_wrong_in_silence():
    """Errors of the force push the rotor alone, a thirteenth of the loaded mass, all the time."""
    liquid = {
        "kind": "liquid",
        "chamber_radius": 0.1,
        "float_radius": 0.09,
        "height": 0.4,
        "density": 1000.0,
        "inertia_as_force": True,
    }
    rotor = {"mass": 1.0, "stiffness": 1.0e6, "damping": 5.0, "unbalance": 0.001}
    scene = Scene.from_document(
        {
            "rotor": {"kind": "planar", **rotor},
            "balancer": [liquid],
            "operation": {"speed": 50.0},
            "run": {"revolutions": 20.0},
        }
    )
    with pytest.raises(SimulationError, match="use more steps_per_rev"):
        cosimulate(scene)
    result = cosimulate(scene.replace({"coupling.steps_per_rev": 400}))
    assert max(deviations(result, motion(scene, result)).values()) < 0.01


def test_a_loop_that_repeats_its_own_error_is_refused():
    """The estimate is relative to the motion, and that was all error, 1e24 times too large."""
    rotor = {
        "kind": "planar",
        "mass": 61.98,
        "stiffness": [4.779e9, 2.547e10],
        "damping": [76160.0, 0.0],
        "unbalance": 0.1154,
    }
    liquid = {
        "kind": "liquid",
        "chamber_radius": 0.25,
        "float_radius": 0.2072,
        "height": 0.9157,
        "density": 1000.0,
        "inertia_as_force": True,
    }
    scene = Scene.from_document(
        {
            "rotor": rotor,
            "balancer": [liquid],
            "operation": {"speed": 489.7},
            "run": {"revolutions": 0.4745},
        }
    )
    with pytest.raises(SimulationError, match=r"has grown 2-fold .* use more steps_per_rev"):
        cosimulate(scene)
    result = cosimulate(scene.replace({"coupling.steps_per_rev": 1000}))
    assert max(deviations(result, motion(scene, result)).values()) < 0.01
