"""Closed forms of cubic springs, stops and dampers with a free stroke, against given values."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from autobalancer.models.cubic_spring import CubicDisc, free_period
from autobalancer.models.free_stroke import equivalent_damping, loss_per_cycle, turning_points
from autobalancer.models.stops import DiscInRing, FreeBetweenStops, restitution

DISC = CubicDisc(1.0, 1.0, 0.05, 1.0)
RING = DiscInRing(1.0, 1.0, 0.1, 9.0, 0.2)


@pytest.mark.parametrize(
    ("speed", "expected"),
    [
        (0.8, [0.03521823]),
        (1.0, [0.24994503]),
        (1.08, [0.15247195, 0.36247278, 0.42209689]),
        (1.2, [0.06548073]),
    ],
)
def test_whirls_on_a_cubic_spring_have_the_exact_amplitudes(speed, expected):
    assert DISC.amplitudes(0.02, speed) == pytest.approx(expected, abs=5.1e-9)


def test_of_three_whirls_on_a_cubic_spring_the_middle_one_is_unstable():
    growth = [DISC.growth_rate(a, 1.08) for a in DISC.amplitudes(0.02, 1.08)]
    assert growth == pytest.approx([-0.025, 0.01582, -0.025], abs=5.1e-6)
    assert DISC.growth_rate(DISC.amplitudes(0.02, 1.0)[0], 1.0) == pytest.approx(-0.025)


def test_three_whirls_exist_between_two_speeds():
    def count(speed):
        return len(DISC.amplitudes(0.02, speed))

    assert [count(w) for w in (1.0656, 1.0658, 1.0931, 1.0934)] == [1, 3, 3, 1]
    assert DISC.backbone(0.5) == pytest.approx(math.sqrt(1.25))


@pytest.mark.parametrize(
    ("ratio", "expected"), [(0.1, 6.06065674), (1.0, 4.76802203), (10.0, 2.19182911)]
)
def test_the_free_period_on_a_cubic_spring_is_the_elliptic_one(ratio, expected):
    assert free_period(1.0, 1.0, ratio, 1.0) == pytest.approx(expected, abs=5.1e-9)
    with pytest.raises(ValueError, match="must not be below 0"):
        free_period(1.0, 1.0, -ratio, 1.0)


@pytest.mark.parametrize(
    ("speed", "period", "amplitude"),
    [
        (0.6, 5.41395730, 0.56817254),
        (1.0, 3.93528940, 0.73841681),
        (2.0, 2.99064315, 1.09232799),
    ],
)
def test_free_motion_between_stops_has_the_exact_period(speed, period, amplitude):
    found = FreeBetweenStops.of(1.0, 1.0, 8.0, 0.5, speed)
    assert (found.period, found.amplitude) == pytest.approx((period, amplitude), abs=5.1e-9)


def test_free_motion_between_stops_without_a_spring():
    found = FreeBetweenStops.of(1.0, 0.0, 8.0, 0.5, 1.0)
    assert found.period == pytest.approx(4.22144147, abs=5.1e-9)
    assert found.amplitude == pytest.approx(0.5 + 1.0 / math.sqrt(8.0))


@pytest.mark.parametrize(("stiffness", "speed"), [(1.0, 0.4), (0.0, 0.0), (1.0, -1.0)])
def test_a_body_too_slow_for_the_stops_has_no_motion_between_them(stiffness, speed):
    with pytest.raises(ValueError, match="too slow to reach"):
        FreeBetweenStops.of(1.0, stiffness, 8.0, 0.5, speed)


@pytest.mark.parametrize(
    ("ratio", "expected"), [(0.05, 0.85875810), (0.2, 0.57174003), (0.5, 0.29843606)]
)
def test_a_damped_stop_lets_go_at_zero_force(ratio, expected):
    assert restitution(1.0, 1.0, 2.0 * ratio) == pytest.approx(expected, abs=5.1e-9)


def test_restitution_needs_less_than_critical_damping():
    with pytest.raises(ValueError, match="below the critical one"):
        restitution(1.0, 1.0, 2.0)


def test_whirls_in_a_ring_have_the_exact_amplitudes():
    assert RING.amplitudes(0.05, 0.9) == pytest.approx([0.19263886], abs=5.1e-9)
    assert RING.amplitudes(0.05, 1.05) == pytest.approx([0.20799262], abs=5.1e-9)
    expected = [0.08935892, 0.21837086, 0.24597132]
    assert RING.amplitudes(0.05, 1.5) == pytest.approx(expected, abs=5.1e-9)


def test_the_ring_is_reached_where_the_whirl_without_contact_is_as_wide_as_the_gap():
    speed = RING.slowest_contact(0.05, 0.99, 0.5)
    assert RING.amplitudes(0.05, speed)[0] == pytest.approx(0.2, rel=1e-9)
    with pytest.raises(ValueError, match="none or both"):
        RING.slowest_contact(0.05, 0.2)


@pytest.mark.parametrize(("amplitude", "expected"), [(0.01, 0.0), (0.02, 0.15), (0.05, 0.75)])
def test_a_damper_with_free_stroke_loses_nothing_within_it(amplitude, expected):
    assert loss_per_cycle(5.0, 2e3, 0.02, amplitude) == pytest.approx(expected, abs=1e-12)
    damping = equivalent_damping(5.0, 2e3, 0.02, amplitude, 3.0)
    assert damping * math.pi * 3.0 * amplitude**2 == pytest.approx(expected, abs=1e-12)


def test_turning_points_of_a_decay_end_within_the_free_stroke():
    expected = [0.2, 0.106525, 0.022077, 0.002723]
    assert turning_points(100.0, 5.0, 0.02, 0.2) == pytest.approx(expected, abs=5.1e-7)
    assert turning_points(100.0, 5.0, 0.0, 0.2) == pytest.approx([0.2, 0.1, 0.0], abs=1e-12)


def test_the_whirl_in_a_ring_is_where_an_integration_ends():
    def rate(t, s):
        r = math.hypot(s[0], s[1])
        back = 9.0 * max(r - 0.2, 0.0) / max(r, 1e-300)
        pull = 0.05 * 1.05**2 * np.array([math.cos(1.05 * t), math.sin(1.05 * t)])
        return [*s[2:], *(-0.1 * s[2:] - (1.0 + back) * s[:2] + pull)]

    end = solve_ivp(rate, (0.0, 400.0), np.zeros(4), max_step=0.2, rtol=1e-8, atol=1e-10).y[:, -1]
    assert np.hypot(*end[:2]) == pytest.approx(RING.amplitudes(0.05, 1.05)[0], rel=1e-6)
