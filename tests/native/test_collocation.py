"""The error that one step by collocation states, against the closed form of a damped pendulum."""

from __future__ import annotations

import cmath
import math

import numpy as np
import pytest

from autobalancer.models.weights import Weights
from tests.native.equations import Track

RADIUS, MASS, STEP, DISPLACED = 0.05, 0.01, 0.01, 1e-3  # m, kg, s, rad


@pytest.mark.parametrize("turn", [3.0, 30.0, 300.0])
@pytest.mark.parametrize("fall", [0.0, 100.0])
def test_a_step_states_at_least_its_error_and_at_most_how_far_the_motion_is(core, turn, fall):
    """However fast the pendulum swings, by so many rad in the step, or its speed falls.

    The error is damped as stiff motions are, by what a place and what a speed changes.  Without
    the former a step states 4 times the displacement.
    """
    frequency, drag = turn / STEP, fall / STEP
    track = Track(core, Weights(1, MASS, RADIUS, drag=drag * MASS))
    plane = core.centre_motion([complex(RADIUS * frequency**2), 0j, 0j, 0j], 0.0, [0.0] * 4)
    angles, speeds, contacts = (np.array([x]) for x in (math.pi + DISPLACED, 0.0, 0.0))
    stated = core("collocated", track._carried, plane, STEP, 1e-9, contacts, angles, speeds)

    root = cmath.sqrt(0.25 * drag**2 - frequency**2)
    rates = -0.5 * drag + root, -0.5 * drag - root
    shares = [
        z * cmath.exp(own * STEP) for z, own in zip((-rates[1], rates[0]), rates, strict=True)
    ]
    left = (sum(shares) / (rates[0] - rates[1])).real
    assert abs(angles[0] - math.pi - DISPLACED * left) <= stated <= DISPLACED
