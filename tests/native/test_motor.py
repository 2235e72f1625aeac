"""The motor of limited power by itself: SciPy, and a closed form."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from autobalancer.models.motor import Drive
from tests.native.equations import motor_advance

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
def test_a_step_is_exact_on_every_line_and_across_its_points(core, speed, torque):
    def rate(t, state):
        tau = torque[0] + t * (torque[1] + t * (torque[2] / 2 + t * torque[3] / 6))
        own = np.interp(state[0], BENT.speeds, BENT.torques)
        own += min(state[0], 0.0) * 0.1 + max(state[0] - 200.0, 0.0) * -2.0 / 140.0
        return [(own + tau) / BENT.inertia, state[0]]

    step = 0.4
    expected = solve_ivp(
        rate, (0.0, step), [speed, 0.0], "DOP853", rtol=1e-11, atol=1e-12, max_step=1e-3
    ).y[:, -1]
    found = motor_advance(core, BENT, speed, torque, step)
    assert found == pytest.approx(tuple(expected), rel=1e-8, abs=1e-8)


def test_a_motor_alone_comes_up_exponentially(core):
    motor = Drive(0.1, (0.0, 100.0), (5.0, 0.0))
    speed, angle = motor_advance(core, motor, 0.0, (0.0,) * 4, 3.0)
    rate = 5.0 / 100.0 / 0.1
    assert speed == pytest.approx(100.0 * -math.expm1(-3.0 * rate), rel=1e-14)
    assert angle == pytest.approx(300.0 - speed / rate, rel=1e-14)
