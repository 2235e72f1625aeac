"""Steps too long for the signals: what is summed up, what is forgotten, and what is rounding."""

from __future__ import annotations

import math

import numpy as np
import pytest

from autobalancer.harness import load_scene
from autobalancer.harness.master.cosimulation import CoSimulation
from autobalancer.harness.master.resolution import Resolution
from autobalancer.models.constants import PERSISTENT_STEPS

STEPS = 40  # per revolution


@pytest.fixture
def still():
    """The two-ball scene at its start, with signals at zero."""
    with CoSimulation(load_scene("two_balls")) as cosim:
        cosim.start()
        for signals in (cosim.system.forces, cosim.system.accelerations):
            signals.now[:] = 0.0
        yield cosim


def watched(cosim, force=0.0, acceleration=0.0, revolutions=1.0):
    """What is found when the predictions miss by so much [N, m/s2] in every step."""
    resolution = Resolution(cosim.scene, cosim.system, 120.0)
    resolution.strict = False
    # no miss at all would be a step without a past
    cosim.system.forces.prediction_error = np.array([force or 1e-30])
    cosim.system.accelerations.prediction_error = np.array([acceleration])
    step = 2.0 * math.pi / (STEPS * cosim.scene.operation.speed)
    for number in range(round(revolutions * STEPS)):
        resolution.check(number * step, step)
    return resolution


def kept_steps() -> float:
    """Steps that count where what lies one revolution back counts for 1/e."""
    return 1.0 / (1.0 - math.exp(-1.0 / STEPS))


def test_pushes_of_the_last_revolution_add_up_and_older_ones_are_forgotten(still):
    rotor, weights = still.scene.rotor, still.scene.balancer[0]
    speed = still.scene.operation.speed
    assert math.sqrt(min(rotor.stiffness) / rotor.mass) < speed, "the rotor's pace is its speed"
    step = 2.0 * math.pi / (STEPS * speed)
    moment = weights.count * weights.mass * weights.track_radius + rotor.unbalance
    mass = rotor.mass + weights.count * weights.mass
    missed = 1e-3
    each = missed / 120.0 * step / (mass * speed)  # m: a push moves the rotor for 1/speed
    expected = each * kept_steps() / (moment / mass)
    assert watched(still, force=missed, revolutions=30).estimate == pytest.approx(expected, 1e-9)
    after_one = watched(still, force=missed, revolutions=1).estimate
    assert after_one == pytest.approx((1.0 - math.exp(-1.0)) * expected, rel=0.03)


def test_turns_of_the_last_revolution_add_up_and_older_ones_are_forgotten(still):
    weights, speed = still.scene.balancer[0], still.scene.operation.speed
    step = 2.0 * math.pi / (STEPS * speed)
    slowing = weights.drag / (weights.kappa * weights.mass)
    turned = 1.0 / (weights.kappa * weights.track_radius * max(speed, slowing))
    missed = 1e-3
    expected = missed / 120.0 * step * turned * kept_steps()
    found = watched(still, acceleration=missed, revolutions=30)
    assert found.estimate == pytest.approx(expected, 1e-9)


@pytest.mark.parametrize(("share", "counts"), [(1e-6, True), (1e-8, True), (1e-10, False)])
def test_a_force_that_nearly_cancels_is_a_signal_until_it_is_rounding(still, share, counts):
    weights, speed = still.scene.balancer[0], still.scene.operation.speed
    pull = weights.count * weights.mass * weights.track_radius * speed**2
    lost = 120.0 * 0.05 * 1.01  # a prediction that misses so much leaves the step's cubic lost
    found = watched(still, force=lost * share * pull)
    assert found.unresolved == (STEPS if counts else 0)
    assert found.refused is (counts and PERSISTENT_STEPS <= STEPS)


def test_a_start_at_another_speed_is_judged_by_that_speed():
    """As the scene of that speed is, whose weights pull a hundred times as hard."""
    scene, speed, estimates = load_scene("two_balls"), 30.0, []
    step = 2.0 * math.pi / (STEPS * speed)
    drive = {name: {"speed": speed} for name in ("rotor", "weights")}
    for one, changes in ((scene, drive), (scene.replace({"operation.speed": speed}), None)):
        with CoSimulation(one) as cosim:
            cosim.start(changes, step)
            for _ in range(STEPS):
                cosim.step(step)
            estimates.append(cosim.resolution.estimate)
    assert estimates[0] == estimates[1] > 0.0
