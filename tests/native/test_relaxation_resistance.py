"""Separate weights with rolling resistance under heavy drag, against an integration by events."""

import cmath
import math
import random

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from autobalancer.models.weights import Weights
from tests.native.equations import Track

RADIUS, MASS, KAPPA = 0.05, 0.01, 1.4
BOUND = 1e-11  # rad: of a step, and of what events leave of it
STEADY = [0.0] * 4


def taylor(values, t):
    return sum(value * t**k / math.factorial(k) for k, value in enumerate(values))


class Case:
    """Point weights of one drag that resist rolling, and how their plane and the rotor move."""

    def __init__(self, fast, fall, resistance, signal, speed=100.0, rates=STEADY, offset=0j):
        self.fast, self.step, self.resistance = fast, fall / fast, resistance
        self.signal, self.speed, self.rates, self.offset = list(signal), speed, rates, offset

    def pulled(self, t, angle):
        spun, w = taylor(self.rates, t), taylor([self.speed, *self.rates], t)
        felt = taylor(self.signal, t) + self.offset * (1j * spun - w * w)
        return felt * cmath.rect(1.0, -angle)

    def push(self, t, angle):
        """theta'' without drag and resistance, Filimonikhina 2017 (4)."""
        spun = taylor(self.rates, t)
        rolls = (KAPPA - 1.0) * RADIUS * spun
        return (rolls - self.pulled(t, angle).imag) / (KAPPA * RADIUS) - spun

    def limit(self, t, angle, rate):
        load = RADIUS * (taylor([self.speed, *self.rates], t) + rate) ** 2
        return self.resistance / (KAPPA * RADIUS) * abs(load - self.pulled(t, angle).real)

    def integrated(self, angle, rate, masses=(1.0,), apart=0.0):
        """End of a row that moves as one: phase by phase, the first of which may be at rest."""
        shares = np.divide(masses, sum(masses))

        def mean(function):
            return sum(share * function(k * apart) for k, share in enumerate(shares))

        def excess(t, x):
            push = mean(lambda more: self.push(t, x + more))
            return abs(push) - mean(lambda more: self.limit(t, x + more, 0.0)), push

        t, self.changes = 0.0, 0
        while t < self.step:
            if rate == 0.0 and excess(t, angle)[0] <= 0.0:
                times = np.linspace(t, self.step, 2001)[1:]
                freed = [s for s in times if excess(s, angle)[0] > 0.0][:1]
                if not freed:
                    break
                low, high = freed[0] - (times[1] - times[0]), freed[0]
                for _ in range(60):
                    middle = 0.5 * (low + high)
                    low, high = (low, middle) if excess(middle, angle)[0] > 0.0 else (middle, high)
                t = high
                self.changes += 1
            way = math.copysign(1.0, rate or excess(t, angle)[1])

            def slope(t, state, way=way):
                total = mean(
                    lambda more: (
                        self.push(t, state[0] + more)
                        - way * self.limit(t, state[0] + more, state[1])
                    )
                )
                return [state[1], total - self.fast * state[1]]

            def rest(t, state, way=way):
                return way * state[1] + 1e-300

            rest.terminal, rest.direction = True, -1.0
            found = solve_ivp(
                slope, (t, self.step), [angle, rate], "LSODA", events=rest, rtol=1e-12, atol=1e-15
            )
            t, (angle, rate) = found.t[-1], found.y[:, -1]
            if found.status == 1:
                rate = 0.0
                self.changes += 1
        return angle, rate

    def advance(self, core, angles, speeds, contacts=None, size=0.0, masses=()):
        drag = self.fast * KAPPA * MASS
        drags = tuple(self.fast * KAPPA * mass for mass in masses)
        weights = Weights(
            len(angles), MASS, RADIUS, drag=drag, kappa=KAPPA, radius=size,
            **({"masses": tuple(masses), "drags": drags} if masses else {}),
        )  # fmt: skip
        self.track = Track(
            core, weights, size, rolling_resistance=self.resistance, offset=self.offset
        )
        return self.track.advance(
            angles, speeds, contacts or [0.0] * len(angles), self.signal, self.speed,
            self.rates[0], self.step, self.rates[1:],
        )  # fmt: skip

    def check(self, found, k, angle, rate, bound=BOUND):
        assert abs(found.angles[k] - angle) <= bound
        assert abs(found.speeds[k] - rate) <= bound * self.fast


def drawn(number):
    """A case in which a weight rolls on for the whole step, and where it starts."""
    draw = random.Random(f"relaxed rolling {number}")
    fast, fall = 10 ** draw.uniform(3.0, 5.0), 10 ** draw.uniform(0.7, 2.7)
    step, speed = fall / fast, draw.uniform(-100.0, 100.0)
    strength = 10 ** draw.uniform(0.5, 2.0)
    slow = min(1.0, 30.0 / (strength * step))
    signal = [
        strength * (slow * draw.gauss(0.0, 0.1) / step) ** k * cmath.rect(1.0, draw.uniform(0, 6))
        for k in range(4)
    ]
    signal[0] = complex(strength)
    rates = [speed * draw.gauss(0.0, 0.01) / step**k for k in range(3)] + [0.0]
    drives = strength / (RADIUS * speed**2 + strength)
    offset = draw.choice([0j, 1e-4 + 2e-4j])
    case = Case(fast, fall, draw.uniform(0.01, 0.3) * drives, signal, speed, rates, offset)
    angle = draw.choice([-1.0, 1.0]) * draw.uniform(1.0, 2.0)
    push = case.push(0.0, angle)
    rate = math.copysign(max(0.0, abs(push) - case.limit(0.0, angle, 0.0)), push) / fast
    return case, angle, rate * draw.choice([0.9, 1.0, 1.1])


@pytest.mark.parametrize("number", range(16))
def test_a_weight_that_rolls_on_against_its_resistance_needs_no_collocation(core, number):
    case, angle, rate = drawn(number)
    found = case.advance(core, [angle], [rate])
    case.check(found, 0, *case.integrated(angle, rate))
    assert case.changes == found.events == 0
    assert abs(found.angles[0] - angle) > 1e-8
    assert core("collocated_passes", case.track._carried) == 0


def changing(fall, resistance, first, last):
    """A case whose plane's acceleration changes evenly along x, from `first` to `last` [m/s^2]."""
    fast = 2e4
    slope = complex((last - first) * fast / fall)
    return Case(fast, fall, resistance, [complex(first), slope, 0j, 0j])


@pytest.mark.parametrize("fall", [20.0, 300.0, 6000.0])
@pytest.mark.parametrize("last", [-20.0, 0.5])
def test_a_weight_stops_where_nothing_drives_it_any_more(core, fall, last):
    """With -20 m/s^2 it sets off again, the other way."""
    case = changing(fall, 0.003, 20.0, last)
    angle = 1.4
    rate = (case.push(0.0, angle) + case.limit(0.0, angle, 0.0)) / case.fast
    found = case.advance(core, [angle], [rate])
    case.check(found, 0, *case.integrated(angle, rate), 3.0 * BOUND)
    assert case.changes == (2 if last < 0.0 else 1) <= found.events <= 2 * case.changes
    assert core("collocated_passes", case.track._carried) == 0


@pytest.mark.parametrize("fall", [20.0, 300.0, 6000.0])
def test_a_weight_at_rest_sets_off_where_its_resistance_is_exceeded(core, fall):
    case = changing(fall, 0.003, 0.5, 20.0)
    found = case.advance(core, [1.4], [0.0])
    case.check(found, 0, *case.integrated(1.4, 0.0), 3.0 * BOUND)
    assert case.changes == 1 <= found.events <= 2


@pytest.mark.parametrize("fall", [20.0, 300.0])
def test_a_weight_changes_walls_where_its_load_does(core, fall):
    """The plane's acceleration is more than the centrifugal one until the rotor is fast enough."""
    case = Case(2e4, fall, 0.02, [20.0 + 0j, 0j, 0j, 0j], 10.0)
    case.rates = [40.0 / case.step, 0.0, 0.0, 0.0]
    angle, rate = 0.5, (case.push(0.0, 0.5) + case.limit(0.0, 0.5, 0.0)) / case.fast
    loads = [
        RADIUS * taylor([case.speed, *case.rates], t) ** 2 - case.pulled(t, angle).real
        for t in (0.0, case.step)
    ]
    assert loads[0] < 0.0 < loads[1]
    found = case.advance(core, [angle], [rate])
    case.check(found, 0, *case.integrated(angle, rate), 3.0 * BOUND)
    assert found.events == case.changes == 0


def test_one_rests_to_the_last_digit_while_another_rolls(core):
    case = changing(300.0, 0.02, 18.0, 20.0)
    found = case.advance(core, [0.3, 1.4], [0.0, 0.0])
    angle, rate = case.integrated(1.4, 0.0)
    assert (found.angles[0], found.speeds[0]) == (0.3, 0.0)
    case.check(found, 1, angle, rate)
    assert abs(found.angles[1] - 1.4) > 1e-5


@pytest.mark.parametrize("masses", [(1.0, 1.0), (1.0, 4.0), (4.0, 1.0, 2.0)])
def test_a_row_that_presses_rolls_by_the_sum_of_its_resistances(core, masses):
    size = 0.005
    apart = 2.0 * math.asin(size / RADIUS)
    case = changing(100.0, 0.003, 20.0, 22.0)
    start = math.pi - 0.5 * (len(masses) - 1) * apart - 0.3
    found = case.advance(
        core, [start + k * apart for k in range(len(masses))], [0.0] * len(masses),
        [1.0] * (len(masses) - 1) + [0.0], size, [MASS * mass for mass in masses],
    )  # fmt: skip
    angle, rate = case.integrated(start, 0.0, masses, apart)
    assert found.events == case.changes == 0
    assert abs(angle - start) > 1e-6
    for k in range(len(masses)):
        case.check(found, k, angle + k * apart, rate)
    assert core("collocated_passes", case.track._carried) == 0


def test_a_weight_that_stops_in_a_long_step_stops_once(core):
    """A polynomial through the fall of its speed had 1,123 events here."""
    step = 2.0 * math.pi / 4000.0
    case = Case(3000.0 / step, 3000.0, 0.003, STEADY)
    ring = (-2.0 + 130.0j, 70 * step)
    case.signal = [8.0 * ring[0] ** k * cmath.exp(ring[0] * ring[1]) for k in range(4)]
    case.signal[0] += 20.0
    found = case.advance(core, [0.40000498290369607], [8.728966537819251e-07])
    assert (found.events, found.speeds) == (1, [0.0])
