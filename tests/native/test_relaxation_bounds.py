"""What happens late in a step under heavy drag, where its points alone do not show it."""

import itertools
import math
import random

import numpy as np
import pytest
from scipy.optimize import brentq

from tests.native.test_relaxation_resistance import BOUND, RADIUS, Case

LATE = 0.98  # of a step, or of a way: behind the point before the last


SIZE = 0.02
SPACING = 2.0 * math.asin(SIZE / RADIUS)


def met(core, case, way, rate=0.0, ahead=False):
    """Two balls, one at rest; the other has a little less room than its way."""
    moving = math.pi + (SPACING if ahead else -SPACING) - way
    angles, rates = [moving, math.pi], [rate, 0.0]
    if ahead:
        angles, rates = angles[::-1], rates[::-1]
    found = case.advance(core, angles, rates, size=SIZE)
    assert found.events >= 1
    assert found.contacts == [1.0, 0.0]
    assert found.angles[1] - found.angles[0] == pytest.approx(SPACING, abs=1e-13)


@pytest.mark.parametrize("fall", [20.0, 300.0])
@pytest.mark.parametrize("resistance", [0.0, 0.003])
@pytest.mark.parametrize("ahead", [False, True])
def test_a_ball_that_drifts_into_one_at_rest_at_the_end_touches_it(core, fall, resistance, ahead):
    """The mean of the gaps at the last two points is well above 0."""
    case = Case(2e4, fall, resistance, [20.0 + 0j, 0j, 0j, 0j])
    start = math.pi + (SPACING if ahead else -SPACING)
    moved = case.advance(core, [start], [0.0], size=SIZE).angles[0] - start
    met(core, case, LATE * moved, ahead=ahead)


@pytest.mark.parametrize("ahead", [False, True])
def test_a_ball_that_is_faster_than_it_is_driven_touches_one_at_the_end(core, ahead):
    case = Case(2e4, 4.0, 0.0, [0j, 0j, 0j, 0j])
    rate = -1.0 if ahead else 1.0
    way = rate / case.fast * (1.0 - math.exp(-4.0))
    met(core, case, 0.998 * way, rate, ahead)


def late(fall, gained):
    """A case whose load alone changes, and angles where it is just enough late in the step."""
    case = Case(2e4, fall, 0.02, [60.0 + 0j, 0j, 0j, 0j])
    case.rates = [gained / case.step, 0.0, 0.0, 0.0]

    def excess(angle, t=LATE * case.step):
        return abs(case.push(t, angle)) - case.limit(t, angle, 0.0)

    angles = np.linspace(0.0, 6.2, 800)
    pairs = itertools.pairwise(angles)
    ends = [(low, high) for low, high in pairs if excess(low) * excess(high) < 0.0]
    return case, [brentq(excess, low, high) for low, high in ends]


@pytest.mark.parametrize("fall", [100.0, 300.0, 1000.0])
def test_a_weight_sets_off_at_the_end_where_the_rotor_slows_and_its_load_falls(core, fall):
    case, angles = late(fall, -5.0)
    ways = set()
    for angle in angles:
        found = case.advance(core, [angle, angle + 2.0], [0.0, 0.0])
        case.check(found, 0, *case.integrated(angle, 0.0), 3.0 * BOUND)
        assert case.changes == 1 <= found.events
        ways.add(math.copysign(1.0, found.speeds[0]))
    assert ways == {-1.0, 1.0}


@pytest.mark.parametrize("fall", [100.0, 300.0, 1000.0])
def test_a_weight_stops_at_the_end_where_the_rotor_quickens_and_its_load_grows(core, fall):
    case, angles = late(fall, 5.0)
    assert angles
    for angle in angles:
        push = case.push(0.0, angle)
        rate = (push - math.copysign(case.limit(0.0, angle, 0.0), push)) / case.fast
        found = case.advance(core, [angle], [rate])
        case.check(found, 0, *case.integrated(angle, rate), 3.0 * BOUND)
        assert (found.events, found.speeds, case.changes) == (1, [0.0], 1)


def test_a_weight_changes_walls_by_its_own_speed(core):
    """By its place its load stays that of the outer wall; it rolls against the rotor."""
    case = Case(1e5, 20.0, 0.02, [600.0 + 0j, 0j, 0j, 0j])
    angle = -math.acos((RADIUS * case.speed**2 - 0.3) / 600.0)
    found = case.advance(core, [angle], [0.0])
    rolled, rate = case.integrated(angle, 0.0)
    loads = [
        RADIUS * (case.speed + speed) ** 2 - case.pulled(0.0, place).real
        for place, speed in ((angle, 0.0), (rolled, 0.0), (rolled, rate))
    ]
    assert min(loads[:2]) > 0.0
    assert loads[2] < 0.0
    case.check(found, 0, rolled, rate, 3.0 * BOUND)


@pytest.mark.parametrize("fall", [20.0, 300.0, 6000.0])
def test_a_weight_that_the_inner_wall_carries_needs_no_series(core, fall):
    case = Case(2e4, fall, 0.02, [20.0 + 0j, 0j, 0j, 0j], 10.0)
    angle = 0.5
    assert RADIUS * case.speed**2 < case.pulled(0.0, angle).real
    rate = (case.push(0.0, angle) + case.limit(0.0, angle, 0.0)) / case.fast
    found = case.advance(core, [angle], [rate])
    case.check(found, 0, *case.integrated(angle, rate))
    assert core("relaxed_points", case.track._carried) > 0


def uneven(number):
    """A case whose plane, or rotor, changes its way within the step, and two places at rest."""
    draw = random.Random(f"uneven step {number}")
    fast, fall, strength = (
        10 ** draw.uniform(3, 5),
        10 ** draw.uniform(0.7, 2.7),
        draw.choice([3, 300]),
    )
    case = Case(fast, fall, 0.02, [strength + 0j] * 4, draw.uniform(-100, 100))
    case.offset = draw.choice([0j, 0.01 + 0j])
    changed, gained = draw.choice([0.0, 0.02, 0.3]), draw.choice([0.0, 0.02, 0.1])
    for k in range(1, 4):
        turned = complex(draw.gauss(0, 1), draw.gauss(0, 1)) * math.factorial(k)
        case.signal[k] = strength * changed * turned / case.step**k
    case.rates = [case.speed * gained * draw.gauss(0, 1) / case.step ** (k + 1) for k in range(2)]
    case.rates += [0.0, 0.0]
    return case, [draw.uniform(0, 6), draw.uniform(0, 6)]


@pytest.mark.parametrize("number", [2790, 21489, 5419, 9636, 7696, 17912, 10391, 11816])
def test_what_lies_between_the_points_of_an_uneven_step_is_found(core, number):
    """Drawn from 20,000: those that go wrong without a part of the bounds."""
    case, angles = uneven(number)
    found = case.advance(core, angles, [0.0, 0.0])
    for k, angle in enumerate(angles):
        case.check(found, k, *case.integrated(angle, 0.0), 3.0 * BOUND)


def turning(number):
    """A case of a plane with a steady acceleration, whose rotor alone changes the load."""
    draw = random.Random(f"turn {number}")
    fast, fall = 10 ** draw.uniform(3, 5), 10 ** draw.uniform(0.7, 2.7)
    resistance, strength = 10 ** draw.uniform(-2.5, -0.3), 10 ** draw.uniform(-1, 2.5)
    case = Case(fast, fall, resistance, [strength + 0j, 0j, 0j, 0j], draw.uniform(-100, 100))
    shares = [draw.gauss(0, 1) * draw.choice([0, 0.02, 0.1, 0.3]) for _ in range(3)]
    case.rates = [case.speed * math.factorial(k + 1) * share / case.step ** (k + 1)
                  for k, share in enumerate(shares)] + [0.0]  # fmt: skip
    return case, draw.uniform(0, 6.28), draw.random() < 0.5


def test_a_load_that_the_rotor_s_turning_bends_takes_more_points(core):
    """Drawn from 44,000: the one that errs by more than its bound with the points of a line."""
    case, angle, rests = turning(13999)
    push = case.push(0.0, angle)
    left = max(0.0, abs(push) - case.limit(0.0, angle, 0.0))
    rate = 0.0 if rests else math.copysign(left, push) / case.fast
    found = case.advance(core, [angle], [rate])
    case.check(found, 0, *case.integrated(angle, rate))
