"""The motor of limited power by itself, and what a resonance takes from it."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from autobalancer.models.assembly import Assembly, Mounted
from autobalancer.models.motor import Drive, advance
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.sommerfeld import Resonance
from autobalancer.models.weights import Weights

BENT = Drive(0.2, (0.0, 50.0, 60.0, 200.0), (4.0, 9.0, 2.0, 0.0))  # breaks down at 50 rad/s


@pytest.mark.parametrize(
    ("speed", "torque"),
    [
        (20.0, (0.0, 0.0, 0.0, 0.0)),
        (45.0, (2.0, -30.0, 1e3, 2e4)),  # up through two points
        (70.0, (-30.0, 0.0, 0.0, 0.0)),  # down through three, and backwards
        (49.0, (-2.0, 900.0, -9e3, -1e4)),  # to and fro
    ],
)
def test_a_step_is_exact_on_every_line_and_across_its_points(speed, torque):
    def rate(t, state):
        tau = torque[0] + t * (torque[1] + t * (torque[2] / 2 + t * torque[3] / 6))
        own = np.interp(state[0], BENT.speeds, BENT.torques)
        own += min(state[0], 0.0) * 0.1 + max(state[0] - 200.0, 0.0) * -2.0 / 140.0
        return [(own + tau) / BENT.inertia, state[0]]

    step = 0.4
    expected = solve_ivp(
        rate, (0.0, step), [speed, 0.0], "DOP853", rtol=1e-11, atol=1e-12, max_step=1e-3
    ).y[:, -1]
    assert advance(BENT, speed, torque, step) == pytest.approx(tuple(expected), rel=1e-8, abs=1e-8)


def test_a_motor_alone_comes_up_exponentially():
    motor = Drive.straight(0.1, 5.0, 100.0)
    speed, angle = advance(motor, 0.0, (0.0,) * 4, 3.0)
    rate = 5.0 / 100.0 / 0.1
    assert speed == pytest.approx(100.0 * -math.expm1(-3.0 * rate), rel=1e-14)
    assert angle == pytest.approx(300.0 - speed / rate, rel=1e-14)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ((0.0, (0.0, 1.0), (1.0, 0.0)), "inertia"),
        ((1.0, (0.0, 0.0), (1.0, 0.0)), "must ascend"),
        ((1.0, (0.0,), (1.0,)), "two points"),
        ((1.0, (0.0, math.nan), (1.0, 0.0)), "finite"),
    ],
)
def test_a_wrong_motor_is_refused(values, words):
    with pytest.raises(ValueError, match=words):
        Drive(*values)


def resonance(weights=True):
    rotor = LinearRotor.planar(1.0, 1e4, 10.0, 3.0, 0.01, 0.7)
    balls = Mounted("balls", Weights(2, 0.02, 0.1), angles=(0.0, 1.0), speeds=(0.0, 0.0))
    return Resonance.of(Assembly(rotor, (balls,) if weights else ()), 200.0)


def test_without_weights_the_torque_is_that_of_the_linear_response():
    found = resonance(weights=False)
    w = np.linspace(1.0, 190.0, 50)
    z = 0.01 * w**2 / (1e4 - w**2 + 10j * w)
    assert found.resistance(w) == pytest.approx(10.0 * w * np.abs(z) ** 2, rel=1e-12)


def test_weights_rest_where_the_rotor_is_bent_to():
    """The whirl of the closed form meets the equation of motion with weights at its own angle."""
    found = resonance()
    for w in (60.0, 95.0, 130.0):
        size, s = float(found.amplitude(w)), 2 * 0.02 * 0.1
        dynamic = 1e4 - 1.04 * w * w + 10j * w
        # D z - s w^2 z/|z| = U w^2 up to the turn of z
        assert abs(dynamic * size - s * w * w) == pytest.approx(0.01 * w * w, rel=1e-12)


@pytest.mark.parametrize("weights", [False, True])
def test_below_the_limit_a_motor_meets_the_rising_flank_and_above_it_none(weights):
    found = resonance(weights)
    limit, peak = found.limit()
    assert found.caught_at(0.9 * limit) < found.caught_at(0.99 * limit) < peak
    speeds = np.linspace(1.0, 1.3 * peak, 5000)
    assert (1.001 * limit * (1.0 - speeds / 200.0) > found.resistance(speeds)).all()


def test_a_motor_whose_top_is_below_the_resonance_has_no_limit():
    rotor = LinearRotor.planar(1.0, 1e4, 10.0, 0.0, 0.01)
    with pytest.raises(ValueError, match="no resonance below"):
        Resonance.of(Assembly(rotor), 80.0).limit()


def test_an_anisotropic_rotor_has_no_closed_form():
    with pytest.raises(ValueError, match="planar rotor with equal stiffness"):
        Resonance.of(Assembly(LinearRotor.planar(1.0, (1e4, 2e4), 10.0, 0.0, 0.01)), 80.0)
