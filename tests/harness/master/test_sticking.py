"""Rolling resistance on the way there: balls stay where a run-up left them."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

from autobalancer.harness import Scene, cosimulate, cosimulate_many, load_scene
from autobalancer.harness.checks.rig_data import with_washers
from autobalancer.harness.master.cosimulation import CoSimulation
from autobalancer.harness.master.schedule import end_time
from autobalancer.models.monolith import simulate
from tests.studies.rig.quantities import with_fitted_balls

pytestmark = pytest.mark.slow

MU = 5e-3
BEARING = "rotor.station[1].y"
SCENE = {
    "rotor": {"kind": "planar", "mass": 2.0, "stiffness": 8e3, "damping": 40.0, "unbalance": 2e-3},
    "balancer": [
        {"kind": "balls", "name": "weights", "count": 2, "mass": 0.02, "track_radius": 0.1,
         "drag": 0.6, "angles": [0.4, 2.5], "rolling_resistance": MU}
    ],
    "run": {"revolutions": 20},
}  # fmt: skip
DRIVEN = {
    "run_up": {"run_up": {"from": 40.0, "to": 150.0, "seconds": 0.6}},
    "held": {"speed": 150.0},
}


@cache
def ends(driven: str, **coupling: float | str) -> tuple[np.ndarray, np.ndarray]:
    """Angles of the balls where the co-simulation ends, and their speeds."""
    scene = Scene.from_document(SCENE | {"operation": DRIVEN[driven], "coupling": coupling})
    names = [f"weights.weight[{k}].{what}" for what in ("angle", "speed") for k in (1, 2)]
    run = cosimulate(scene, record=names)
    values = np.array([run[name][-1] for name in names])
    return values[:2], values[2:]


@cache
def referred(driven: str) -> tuple[np.ndarray, np.ndarray]:
    """Angles and speeds of the balls by an independent integration."""
    scene = Scene.from_document(SCENE | {"operation": DRIVEN[driven]})
    run = simulate(scene.assembly(), scene.profile(), [end_time(scene)], rtol=1e-10)
    return run.theta["weights"][0], run.angle_rate["weights"][0]


@pytest.mark.parametrize("driven", DRIVEN)
def test_balls_stick_where_an_independent_event_integration_leaves_them(driven):
    """To the tolerance that a scene gets which asks for nothing."""
    right, rates = referred(driven)
    angles, speeds = ends(driven)
    assert np.abs(rates).min() < 1e-9
    assert angles == pytest.approx(right, abs=1e-4)
    assert ((speeds == 0.0) == (np.abs(rates) < 1e-9)).all()


def test_the_error_stated_of_a_run_that_meets_events_is_not_too_small():
    """Where one is all but missed errors do not fall with the fourth power."""
    scene = Scene.from_document(SCENE | {"operation": DRIVEN["held"]})
    run = cosimulate(scene, record=[f"weights.weight[{k}].angle" for k in (1, 2)])
    right, _ = referred("held")
    error = np.abs([values[-1] for values in run.signals.values()] - right).max()
    assert error < 3.0 * run.estimated_error < 3e-4


def test_where_they_stay_depends_on_the_way_there():
    """Both have come to rest at the same speed, in different places, neither of them balanced."""
    (up, still_up), (held, still_held) = ends("run_up"), ends("held")
    assert not still_up.any()
    assert not still_held.any()
    apart = np.abs((up - held + math.pi) % (2.0 * math.pi) - math.pi)
    assert apart.max() > 0.3
    for angles in (up, held):
        assert abs(2e-3 + 2e-3 * np.exp(1j * angles).sum()) > 2e-4


HEAVY = {
    "rotor": {"kind": "planar", "mass": 1.0, "stiffness": 8e3, "damping": 40.0, "unbalance": 0.02},
    "balancer": [
        {"kind": "balls", "name": "weights", "count": 2, "mass": 0.8, "track_radius": 0.1,
         "drag": 0.6, "angles": [0.4, 2.5], "rolling_resistance": 0.05}
    ],
    "operation": {"speed": 150.0},
    "run": {"revolutions": 1},
}  # fmt: skip


def test_heavy_balls_that_may_stick_have_a_consistent_start():
    """Which of them slide depends on the rotor's acceleration, and that on them."""
    scene = Scene.from_document(HEAVY)
    with CoSimulation(scene) as cosim:
        cosim.start()
        assert cosim.gain > 0.25
        right = simulate(scene.assembly(), scene.profile(), [0.0], rtol=1e-10)
        (found,) = cosim.system.accelerations.now[:, 0]
        assert found == pytest.approx(right.plane_acceleration(0)[0], rel=1e-9)


def test_balls_whose_forces_cancel_break_away_once():
    """A force that grows out of nothing is not one event after another; in C the same."""
    rig = with_washers(with_fitted_balls(load_scene("bristol_friction")), 0).replace(
        {
            "balls.angles": [math.pi / 2, 3 * math.pi / 2],
            "operation.run_up": {"from": 282.7, "to": 136.1, "seconds": 56.0},
            "run.revolutions": 4,
        }
    )
    coarse, fine = (rig.replace({"coupling.steps_per_rev": steps}) for steps in (20, 40))
    first, second = (cosimulate(one, record=[BEARING])[BEARING][-1] for one in (coarse, fine))
    assert first == pytest.approx(second, rel=1e-3)
    assert cosimulate_many(coarse, {"balls.drag": [rig.balancer[0].drag]})["failure"] == [""]
