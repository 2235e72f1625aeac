"""The drag of a ball: found again from the motion of a scene's ball, and from published oils."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import odeint, solve_ivp

from autobalancer.harness import Scene, cosimulate
from autobalancer.models import drag

BALL = {"kind": "balls", "name": "race", "count": 1, "mass": 0.004, "track_radius": 0.1}


@pytest.mark.parametrize("start", [0.5, 2.5])
def test_the_drag_of_a_scene_s_ball_is_found_from_its_swing(start):
    known = 2e-3
    scene = Scene.from_document(
        {
            "title": "A ball in an upright race that stands still, and is held",
            "rotor": {"kind": "planar", "mass": 1e3, "stiffness": 1e7, "damping": 1e5},
            "balancer": [{**BALL, "drag": known, "angles": [-0.5 * np.pi + start]}],
            "operation": {"speed": 1e-3, "gravity": 9.81},
            "coupling": {"steps_per_rev": 1_000_000},
            "run": {"revolutions": 1e-3},
        }
    )  # fmt: skip
    run = cosimulate(scene)
    swing = np.abs(run["race.weight[1].angle"] + 1e-3 * run.time + 0.5 * np.pi)
    inner = swing[1:-1]
    tops = 1 + np.flatnonzero((inner > swing[:-2]) & (inner >= swing[2:]))
    first, last = tops[0], tops[-1]
    time = run.time[last] - run.time[first]
    found = drag.from_swing(0.004, 7.0 / 5.0, swing[first], swing[last], time)
    assert found == pytest.approx(known, rel=0.01)


@pytest.mark.parametrize("first", [20.0, 90.0, 150.0, 170.0, 179.0])
@pytest.mark.parametrize(("rate", "halves"), [(0.02, 4), (0.1, 4), (0.3, 1), (0.3, 2), (0.3, 3)])
def test_with_the_number_of_swings_the_drag_is_exact_from_any_angle(first, rate, halves):
    """Decays of a pendulum by LSODA in seconds, m R theta'' kappa = -m g sin theta - c R theta'."""
    mass, kappa, radius, start = 0.004, 1.4, 0.1, np.radians(first)
    w = np.sqrt(9.81 / (kappa * radius))
    drag_there = rate * w * kappa * mass
    times = np.linspace(0.0, 40.0 / w, 40_001)
    motion = odeint(
        lambda y, t: (y[1], -(w**2) * np.sin(y[0]) - drag_there / (kappa * mass) * y[1]),
        (start, 0.0), times, rtol=1e-11, atol=1e-13,
    )  # fmt: skip
    turns = 1 + np.flatnonzero(motion[1:-1, 1] * motion[2:, 1] < 0.0)[halves - 1]
    last, time = abs(motion[turns, 0]), times[turns]
    found = drag.from_swing(mass, kappa, start, last, time, halves / 2.0)
    assert found == pytest.approx(drag_there, rel=1e-3)
    low = drag.from_swing(mass, kappa, start, last, time)
    most = low * drag.swing_range(start, last)
    assert low * 0.999 <= drag_there <= most * 1.001
    if halves == 1:  # the fewest that there can be
        assert most == pytest.approx(drag_there, rel=1e-3)


@pytest.mark.parametrize("first", [20.0, 179.0])
def test_the_drag_of_many_swings_is_exact_too(first):
    """A decay by DOP853 over 100.5 swings, whose ends are where the speed is 0."""
    mass, kappa, rate, halves, start = 0.004, 1.4, 0.005, 201, np.radians(first)

    def at_rest(_, y):
        return y[1]

    motion = solve_ivp(
        lambda _, y: (y[1], -np.sin(y[0]) - rate * y[1]),
        (0.0, 800.0), (start, -1e-12), "DOP853", events=at_rest, rtol=1e-12, atol=1e-14,
    )  # fmt: skip
    time, last = motion.t_events[0][halves - 1], abs(motion.y_events[0][halves - 1][0])
    found = drag.from_swing(mass, kappa, start, last, time, halves / 2.0)
    assert found == pytest.approx(rate * kappa * mass, rel=1e-7)


def test_a_small_swing_and_a_slowing_ball_decay_exponentially():
    assert drag.from_swing(0.01, 1.4, 0.02, 0.01, 3.0) == pytest.approx(
        2.0 * 0.01 * 1.4 * np.log(2.0) / 3.0, rel=1e-4
    )
    assert drag.from_slowing(0.01, 1.4, 60.0, 60.0 * np.exp(-2.0), 4.0) == pytest.approx(0.007)


@pytest.mark.parametrize(
    ("grade", "hot"), [(32, 5.4), (46, 6.8), (68, 8.7), (100, 11.4), (220, 19.0)]
)
def test_viscosities_are_those_of_oils_on_sale(grade, hot):
    # data sheets of hydraulic and gear oils whose viscosity index is 95 to 105
    assert 1e6 * drag.oil_viscosity(grade, 313.15) == pytest.approx(grade)
    assert 1e6 * drag.oil_viscosity(grade, 373.15) == pytest.approx(hot, rel=0.04)


def test_viscosity_between_the_two_follows_astm_d341():
    # its chart for 32 mm^2/s at 40 degC and 5.4 at 100 degC reads 8.5 at 80 degC; ours is VI 95
    assert 1e6 * drag.oil_viscosity(32, 353.15) == pytest.approx(8.5, rel=0.025)
