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
    "weights at rest that heavy drag takes along at once": {
        "rotor": {
            "kind": "planar",
            "mass": 100.0,
            "stiffness": 5000.0,
            "damping": 100.0,
            "unbalance": 0.7,
        },
        "balancer": [
            {
                "kind": "pendulums",
                "count": 3,
                "mass": 3.0,
                "track_radius": 0.2,
                "drag": 1000000.0,
                "angles": [4.0, 0.3, 5.0],
                "speeds": [-10.0, -10.0, -10.0],
            }
        ],
        "operation": {"speed": 10.0},
        "run": {"revolutions": 3.0},
    },
    "a pendulum heavier than its rotor": {
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
    },
    "weights that spin at the start of a run-up on two supports": {
        "rotor": {
            "kind": "two_support",
            "mass": 40.0,
            "inertia": 1.038,
            "span": 0.2,
            "stiffness": [[1000.0, 4000.0], [200.0, 1000.0]],
            "planes": [0.1689],
            "com": 0.01,
            "unbalances": [{"position": 0.09, "amount": 0.1, "angle": 3.0}],
        },
        "balancer": [
            {
                "kind": "pendulums",
                "count": 3,
                "mass": 2.0,
                "track_radius": 0.04,
                "drag": 0.5,
                "speeds": [8.0, -14.62, 3.0],
                "at": 1,
            }
        ],
        "operation": {"run_up": {"from": 0.0, "to": 3.0, "seconds": 30.0}},
        "run": {"revolutions": 0.3},
    },
    "a light pendulum on a rotor that is released": {
        "rotor": {
            "kind": "planar",
            "mass": 0.3,
            "stiffness": 20000000.0,
            "damping": 700.0,
            "unbalance": 0.0001,
        },
        "balancer": [{"kind": "pendulums", "count": 1, "mass": 0.0006, "track_radius": 0.4}],
        "operation": {"speed": 100.0},
        "run": {
            "revolutions": 0.32,
            "initial": {"x": 0.002, "y": 0.001, "vx": -0.3, "vy": -0.02, "angle": 1.0},
        },
    },
    "a free vibration that decays": {
        "rotor": {"kind": "planar", "mass": 0.2065, "stiffness": 128900000.0, "unbalance": 0.0},
        "balancer": [{"kind": "pendulums", "count": 1, "mass": 4e-06, "track_radius": 0.2}],
        "operation": {"speed": 415.3},
        "run": {"revolutions": 0.5491},
    },
    "a heavy pendulum that multiplies errors, with a tolerance": {
        "rotor": {
            "kind": "planar",
            "mass": 0.1,
            "stiffness": 200.0,
            "damping": 2.0,
            "unbalance": 0.07,
        },
        "balancer": [{"kind": "pendulums", "count": 1, "mass": 0.2, "track_radius": 0.4}],
        "operation": {"speed": 2.0},
        "coupling": {"tolerance": 0.001},
        "run": {
            "revolutions": 2.4,
            "initial": {"x": -0.3, "y": 0.6, "vx": -0.8, "vy": 1.0, "angle": 1.0},
        },
    },
    "a heavy ball under heavy drag as a force, with a tolerance": {
        "rotor": {
            "kind": "planar",
            "mass": 7.0,
            "stiffness": [10.0, 70.0],
            "damping": [0.1, 1.0],
            "unbalance": 25.0,
        },
        "balancer": [
            {
                "kind": "balls",
                "count": 1,
                "mass": 30.0,
                "track_radius": 0.08,
                "drag": 5600000.0,
                "angles": [0.5],
                "inertia_as_force": True,
            }
        ],
        "operation": {"speed": 10.0},
        "coupling": {"tolerance": 0.001},
        "run": {"revolutions": 9.0},
    },
    "a light pendulum on stiff, all but undamped supports": {
        "rotor": {
            "kind": "planar",
            "mass": 1.0,
            "stiffness": [2.2e6, 4.6e7],
            "damping": 0.0044,
            "unbalance": 2.1e-5,
        },
        "balancer": [
            {"kind": "pendulums", "count": 1, "mass": 0.011, "track_radius": 0.2, "drag": 0.0034}
        ],
        "operation": {"speed": 100.0},
        "run": {"revolutions": 3.0},
    },
    "heavy liquid as a force on a lightly damped rotor": {
        "rotor": {
            "kind": "planar",
            "mass": 1.0,
            "stiffness": 1.0e6,
            "damping": 5.0,
            "unbalance": 0.001,
        },
        "balancer": [
            {
                "kind": "liquid",
                "chamber_radius": 0.1,
                "float_radius": 0.09,
                "height": 0.4,
                "density": 1000.0,
                "inertia_as_force": True,
            }
        ],
        "operation": {"speed": 50.0},
        "run": {"revolutions": 3.0},
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
    assert not result.events


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
            "coupling": {"steps_per_rev": 40},
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
            "coupling": {"steps_per_rev": 40},
            "run": {"revolutions": 0.4745},
        }
    )
    with pytest.raises(SimulationError, match=r"has grown 2-fold .* use more steps_per_rev"):
        cosimulate(scene)
    result = cosimulate(scene.replace({"coupling.steps_per_rev": 1000}))
    assert max(deviations(result, motion(scene, result)).values()) < 0.01


def test_given_steps_say_how_an_error_gathers_of_a_vibration_that_they_do_not_follow():
    """It hardly decays, and a hundredth of the force wrong in time with it takes it away."""
    scene = Scene.from_document(
        RIGHT["a light pendulum on stiff, all but undamped supports"]
        | {"coupling": {"steps_per_rev": 40}, "run": {"revolutions": 30.0}}
    )
    result = cosimulate(scene)
    error = max(deviations(result, motion(scene, result)).values())
    assert error > 0.1
    assert error / 3.0 < result.estimated_error < 3.0 * error
