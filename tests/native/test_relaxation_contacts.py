"""Separate weights that may touch, under heavy drag, against an integration of each group."""

import cmath
import math
import random

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from autobalancer.models.weights import Weights
from tests.native.equations import Track

RADIUS, SIZE, MASS, KAPPA = 0.05, 0.005, 0.01, 1.4
APART = 2.0 * math.asin(SIZE / RADIUS)  # where two balls touch [rad]
BOUND = 1e-11  # rad: of a step, and of what events leave of it
ROLLS = (KAPPA - 1.0) * (RADIUS + SIZE)


def taylor(values, t):
    return sum(value * t**k / math.factorial(k) for k, value in enumerate(values))


class Case:
    """Some balls of one drag on a round track, whose plane and rotor move as drawn."""

    def __init__(self, core, number):
        draw = random.Random(f"relaxed contacts {number}")
        self.fast = 10 ** draw.uniform(2.5, 4.0)
        self.step = 10 ** draw.uniform(0.7, 2.7) / self.fast
        strength = 10 ** draw.uniform(-0.5, 1.5)
        self.signal = [
            strength / self.step**k * complex(draw.gauss(0.0, 0.2), draw.gauss(0.0, 0.2))
            for k in range(4)
        ]
        self.signal[0] += strength
        self.speed = draw.uniform(-100.0, 100.0)
        self.rates = [self.speed * draw.gauss(0.0, 0.02) / self.step**k for k in range(3)] + [0.0]
        self.draw, self.core = draw, core

    def free(self, t, angle):
        """phi'' of a ball at this angle, but for its drag, Filimonikhina 2017 (4)."""
        spun = taylor(self.rates, t)
        pulled = (taylor(self.signal, t) * cmath.rect(1.0, -angle)).imag
        return (ROLLS * spun - pulled) / (KAPPA * RADIUS) - spun

    def pushed(self, t, angle, size):
        """phi'' of each of `size` balls in a row from this angle on, without neighbours."""
        return [self.free(t, angle + k * APART) for k in range(size)]

    def integrated(self, angle, rate, size):
        """Motion of `size` balls as one, of which the last stands at this angle."""

        def slope(t, state):
            mean = sum(self.pushed(t, state[0], size)) / size
            return [state[1], mean - self.fast * state[1]]

        span = (0.0, self.step)
        return solve_ivp(slope, span, [angle, rate], "DOP853", rtol=1e-12, atol=1e-15)

    def advance(self, angles, speeds, contacts, size=SIZE):
        count = len(angles)
        drag = self.fast * KAPPA * MASS
        weights = Weights(count, MASS, RADIUS, drag=drag, kappa=KAPPA, radius=size)
        self.track = Track(self.core, weights, size)
        return self.track.advance(
            angles,
            speeds,
            contacts,
            self.signal,
            self.speed,
            self.rates[0],
            self.step,
            self.rates[1:],
        )


@pytest.mark.parametrize("number", range(8))
def test_balls_that_stay_apart_move_as_if_they_were_alone(core, number):
    case = Case(core, number)
    # either side of where the plane's acceleration leads them
    angles = [math.pi + 0.4, math.pi - 0.4, 0.3]
    speeds = [case.draw.gauss(0.0, 0.5) for _ in angles]
    found = case.advance(angles, speeds, [0.0] * 3)
    assert found.events == 0
    for k, (angle, rate) in enumerate(zip(angles, speeds, strict=True)):
        right = case.integrated(angle, rate, 1).y[:, -1]
        assert found.angles[k] == pytest.approx(right[0], abs=BOUND)
        assert found.speeds[k] == pytest.approx(right[1], abs=BOUND * case.fast)


@pytest.mark.parametrize("number", range(8))
@pytest.mark.parametrize("size", [2, 3])
def test_balls_that_press_on_each_other_move_as_one(core, number, size):
    case = Case(core, 100 + number)
    start = math.pi - 0.5 * (size - 1) * APART + case.draw.gauss(0.0, 0.02)
    rate = case.draw.gauss(0.0, 0.05)
    path = case.integrated(start, rate, size)
    found = case.advance(
        [start + k * APART for k in range(size)], [rate] * size, [1.0] * (size - 1) + [0.0]
    )
    if found.events:  # the plane's acceleration turns so far that they part
        presses = [
            np.cumsum(p - np.mean(p))[:-1].min()
            for p in (case.pushed(t, a, size) for t, a in zip(path.t, path.y[0], strict=True))
        ]
        assert min(presses) < 0.0
        return
    assert found.contacts == [1.0] * (size - 1) + [0.0]
    for k in range(size):
        assert found.angles[k] == pytest.approx(path.y[0, -1] + k * APART, abs=BOUND)
        assert found.speeds[k] == pytest.approx(path.y[1, -1], abs=BOUND * case.fast)
    assert found.angles[1] - found.angles[0] == pytest.approx(APART, abs=1e-15)


def symmetric(core, number, change):
    """A case whose plane moves along x alone, by an acceleration that changes so much in a step."""
    case = Case(core, number)
    strength = abs(case.signal[0])
    case.signal = [complex(strength), complex(change * strength / case.step), 0j, 0j]
    case.speed, case.rates = 50.0, [0.0] * 4
    return case


@pytest.mark.parametrize("number", range(4))
def test_balls_that_come_together_within_a_long_step_touch_from_then_on(core, number):
    case = symmetric(core, 200 + number, 0.0)
    drift = abs(case.free(0.0, math.pi - 0.5 * APART)) / case.fast * case.step
    angles = [math.pi - 0.5 * APART - 0.3 * drift, math.pi + 0.5 * APART + 0.3 * drift]
    found = case.advance(angles, [0.0, 0.0], [0.0, 0.0])
    assert found.events >= 1
    assert found.contacts == [1.0, 0.0]
    assert found.angles == pytest.approx([math.pi - 0.5 * APART, math.pi + 0.5 * APART], abs=1e-10)


@pytest.mark.parametrize("number", range(4))
def test_balls_that_cease_to_press_within_a_long_step_part_there(core, number):
    case = symmetric(core, 300 + number, -3.0)  # none at a third of the step
    angles = [math.pi - 0.5 * APART, math.pi + 0.5 * APART]
    found = case.advance(angles, [0.0, 0.0], [1.0, 0.0])
    begin = case.step / 3.0
    case.signal[0], case.step = 0j, case.step - begin
    assert found.events == 1
    assert found.contacts == [0.0, 0.0]
    for k, angle in enumerate(angles):
        right = case.integrated(angle, 0.0, 1).y[:, -1]
        assert found.angles[k] == pytest.approx(right[0], abs=1e-10)
        assert found.speeds[k] == pytest.approx(right[1], abs=1e-10 * case.fast)


@pytest.mark.parametrize("number", range(4))
def test_a_ball_that_drifts_to_one_at_rest_is_not_carried_through_it(core, number):
    case = symmetric(core, 400 + number, 0.0)
    size = 0.02
    spacing = 2.0 * math.asin(size / RADIUS)
    drift = abs(case.free(0.0, 0.5 * math.pi)) / case.fast * case.step  # at most
    case.signal[0] *= min(1.0, 0.05 / drift)
    gap = 0.5 * min(drift, 0.05)
    found = case.advance([math.pi - spacing - gap, math.pi], [0.0] * 2, [0.0] * 2, size)
    assert found.events >= 1
    assert found.contacts == [1.0, 0.0]
    assert found.angles[1] - found.angles[0] == pytest.approx(spacing, abs=1e-12)


def test_balls_that_part_between_the_points_of_a_step_are_seen_to(core):
    """The plane's acceleration turns round for less than a fifth of the step."""
    case = symmetric(core, 500, 0.0)
    strength = 1e-4 * KAPPA * RADIUS * case.fast / case.step  # moves them by 1e-4 rad at most
    case.signal = [
        complex(strength * share / case.step**k) for k, share in enumerate((0.1945, -0.9, 2.0, 0.0))
    ]
    angles = [math.pi - 0.5 * APART, math.pi + 0.5 * APART]
    assert case.advance(angles, [0.0, 0.0], [1.0, 0.0]).events >= 1


def test_balls_that_press_take_no_collocation(core):
    case = symmetric(core, 600, 0.0)
    found = case.advance([math.pi - 0.5 * APART, math.pi + 0.5 * APART], [0.0] * 2, [1.0, 0.0])
    assert found.contacts == [1.0, 0.0]
    assert core("collocated_passes", case.track._carried) == 0


def row_alone(case, start, masses, drags):
    """Angle and speed of the first ball of a row that moves as one: momenta of all add up."""
    shares = np.divide(masses, sum(masses))
    drag = np.dot(shares, drags)

    def slope(t, state):
        pushes = case.pushed(t, state[0], len(masses))
        return [state[1], np.dot(shares, pushes) - drag * state[1]]

    span = (0.0, case.step)
    return solve_ivp(slope, span, [start, 0.0], "Radau", rtol=1e-12, atol=1e-15).y[:, -1]


def unlike_row(core, ratios):
    """A case, and masses: the plane pushes a row of balls together and along, nearly steadily."""
    case = symmetric(core, 700, 0.02)
    case.fast, case.step, case.signal = 1000.0, 0.05, [5.0 + 0j, 4.0 + 0j, 0j, 0j]
    return case, [ratio * MASS for ratio in ratios]


def advanced_row(case, start, masses, drags):
    weights = Weights(
        len(masses), MASS, RADIUS, drag=case.fast * KAPPA * MASS, kappa=KAPPA, radius=SIZE,
        masses=tuple(masses),
        drags=tuple(rate * KAPPA * mass for rate, mass in zip(drags, masses, strict=True)),
    )  # fmt: skip
    case.track = Track(case.core, weights, SIZE)
    angles = [start + k * APART for k in range(len(masses))]
    return case.track.advance(
        angles, [0.0] * len(masses), [1.0] * (len(masses) - 1) + [0.0], case.signal,
        case.speed, case.rates[0], case.step, case.rates[1:],
    )  # fmt: skip


@pytest.mark.parametrize("ratios", [(1.0, 4.0), (4.0, 1.0), (1.0, 2.0, 8.0), (4.0, 1.0, 2.0)])
def test_unlike_balls_that_press_move_by_the_sum_of_their_momenta(core, ratios):
    """A mean that counts each ball alike leads them elsewhere by more than 1e-4 rad."""
    case, masses = unlike_row(core, ratios)
    start, drags = math.pi - 0.5 * (len(ratios) - 1) * APART, [case.fast] * len(ratios)
    found = advanced_row(case, start, masses, drags)
    angle, rate = row_alone(case, start, masses, drags)
    alike, _ = row_alone(case, start, [MASS] * len(ratios), drags)
    assert found.events == 0
    assert core("collocated_passes", case.track._carried) == 0
    assert abs(alike - angle) > 1e-4
    for k in range(len(ratios)):
        assert found.angles[k] == pytest.approx(angle + k * APART, abs=BOUND)
        assert found.speeds[k] == pytest.approx(rate, abs=BOUND * case.fast)


@pytest.mark.parametrize("ratios", [(1.0, 4.0), (4.0, 1.0, 2.0)])
def test_balls_of_unlike_drag_that_press_are_braked_by_the_sum_of_their_drags(core, ratios):
    """Such a row takes collocation, whose passes come together as fast as those of one ball."""
    case, masses = unlike_row(core, ratios)
    start = math.pi - 0.5 * (len(ratios) - 1) * APART
    drags = [case.fast * (1.0 + 0.2 * k) for k in range(len(ratios))]
    found = advanced_row(case, start, masses, drags)
    angle, rate = row_alone(case, start, masses, drags)
    assert found.events == 0
    assert 0 < core("collocated_passes", case.track._carried) <= 6
    assert found.angles[0] == pytest.approx(angle, abs=2.0 * BOUND)
    assert found.speeds[0] == pytest.approx(rate, abs=2.0 * BOUND * case.fast)
