"""What happens late in a step under heavy drag, where its points alone do not show it."""

import itertools
import math

import numpy as np
import pytest
from scipy.optimize import brentq

from tests.native.test_relaxation_resistance import BOUND, RADIUS, Case

LATE = 0.98  # of a step, or of a way: behind the point before the last


@pytest.mark.parametrize("fall", [20.0, 300.0])
@pytest.mark.parametrize("resistance", [0.0, 0.003])
def test_a_ball_that_drifts_into_one_at_rest_at_the_end_touches_it(core, fall, resistance):
    """The mean of the gaps at the last two points is well above 0."""
    size = 0.02
    spacing = 2.0 * math.asin(size / RADIUS)
    case = Case(2e4, fall, resistance, [20.0 + 0j, 0j, 0j, 0j])
    alone = case.advance(core, [math.pi - spacing], [0.0], size=size)
    way = alone.angles[0] - (math.pi - spacing)
    found = case.advance(core, [math.pi - spacing - LATE * way, math.pi], [0.0, 0.0], size=size)
    assert found.events >= 1
    assert found.contacts == [1.0, 0.0]
    assert found.angles[1] - found.angles[0] == pytest.approx(spacing, abs=1e-13)


def late(fall, gained):
    """A case whose load alone changes, and the angle where that is just enough late in the step."""
    case = Case(2e4, fall, 0.02, [60.0 + 0j, 0j, 0j, 0j])
    case.rates = [gained / case.step, 0.0, 0.0, 0.0]

    def excess(angle, t=LATE * case.step):
        return abs(case.push(t, angle)) - case.limit(t, angle, 0.0)

    angles = np.linspace(0.0, 6.2, 800)
    ends = next(
        pair for pair in itertools.pairwise(angles) if excess(pair[0]) * excess(pair[1]) < 0.0
    )
    return case, brentq(excess, *ends)


@pytest.mark.parametrize("fall", [100.0, 300.0, 1000.0])
def test_a_weight_sets_off_at_the_end_where_the_rotor_slows_and_its_load_falls(core, fall):
    case, angle = late(fall, -5.0)
    found = case.advance(core, [angle, angle + 2.0], [0.0, 0.0])
    case.check(found, 0, *case.integrated(angle, 0.0), 3.0 * BOUND)
    assert case.changes == 1 <= found.events


@pytest.mark.parametrize("fall", [100.0, 300.0, 1000.0])
def test_a_weight_stops_at_the_end_where_the_rotor_quickens_and_its_load_grows(core, fall):
    case, angle = late(fall, 5.0)
    push = case.push(0.0, angle)
    rate = (push - math.copysign(case.limit(0.0, angle, 0.0), push)) / case.fast
    found = case.advance(core, [angle], [rate])
    case.check(found, 0, *case.integrated(angle, rate), 3.0 * BOUND)
    assert (found.events, found.speeds, case.changes) == (1, [0.0], 1)


@pytest.mark.parametrize("fall", [20.0, 300.0, 6000.0])
def test_a_weight_that_the_inner_wall_carries_needs_no_series(core, fall):
    case = Case(2e4, fall, 0.02, [20.0 + 0j, 0j, 0j, 0j], 10.0)
    angle = 0.5
    assert RADIUS * case.speed**2 < case.pulled(0.0, angle).real
    rate = (case.push(0.0, angle) + case.limit(0.0, angle, 0.0)) / case.fast
    found = case.advance(core, [angle], [rate])
    case.check(found, 0, *case.integrated(angle, rate))
    assert core("relaxed_points", case.track._carried) > 0
