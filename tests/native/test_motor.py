"""The unit of a motor of limited power: SciPy, and a closed form."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

BENT = ((0.0, 50.0, 60.0, 200.0), (4.0, 9.0, 2.0, 0.0))  # rad/s, N m; breaks down at 50 rad/s


@pytest.fixture
def advance(fmus, packaging):
    """Speed and angle of a motor of these points after a step under a cubic torque."""

    def made(inertia, points, speed, torque, step):
        host = packaging.Host(fmus.native("Motor", points=len(points[0])))
        values = {"inertia": inertia, "speed0": speed}
        for k, point in enumerate(zip(*points, strict=True), start=1):
            values |= dict(zip((f"point[{k}].speed", f"point[{k}].torque"), point, strict=True))
        names = ("torque", "der(torque)", "der(torque,2)", "der(torque,3)")
        host.begin(values | dict(zip(names, torque, strict=True)))
        host.step(step)
        return host.get("speed", "angle")

    return made


@pytest.mark.parametrize(
    ("speed", "torque"),
    [
        (20.0, (0.0, 0.0, 0.0, 0.0)),
        (45.0, (2.0, -30.0, 1e3, 2e4)),  # up through two points
        (70.0, (-30.0, 0.0, 0.0, 0.0)),  # down through three, and backwards
        (49.0, (-2.0, 900.0, -9e3, -1e4)),  # to and fro
    ],
)
def test_a_step_is_exact_on_every_line_and_across_its_points(advance, speed, torque):
    def rate(t, state):
        tau = torque[0] + t * (torque[1] + t * (torque[2] / 2 + t * torque[3] / 6))
        own = np.interp(state[0], *BENT)
        own += min(state[0], 0.0) * 0.1 + max(state[0] - 200.0, 0.0) * -2.0 / 140.0
        return [(own + tau) / 0.2, state[0]]

    step = 0.4
    expected = solve_ivp(
        rate, (0.0, step), [speed, 0.0], "DOP853", rtol=1e-11, atol=1e-12, max_step=1e-3
    ).y[:, -1]
    assert advance(0.2, BENT, speed, torque, step) == pytest.approx(expected, rel=1e-8, abs=1e-8)


def test_a_motor_alone_comes_up_exponentially(advance):
    speed, angle = advance(0.1, ((0.0, 100.0), (5.0, 0.0)), 0.0, (0.0,) * 4, 3.0)
    rate = 5.0 / 100.0 / 0.1
    assert speed == pytest.approx(100.0 * -math.expm1(-3.0 * rate), rel=1e-14)
    assert angle == pytest.approx(300.0 - speed / rate, rel=1e-14)
