"""Steady vibration by harmonic balance against linear theory, an energy balance and long runs."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from autobalancer.models.harmonic_balance import (
    NoResponse,
    largest_displacement,
    unbalance_response,
)
from autobalancer.models.papers.influence import influence
from autobalancer.models.rotor import LinearRotor, Slider
from tests.native.equations import Excitation

pytestmark = pytest.mark.slow

MASS, STIFFNESS, DAMPING, UNBALANCE = 2.0, 8.0e3, 6.0, 1e-2
LIMIT, SPRING = 12.0, 4.0e3
SPEEDS = np.array([30.0, 55.0, 62.0, 68.0, 75.0, 200.0])  # rad/s: resonances at 63 to 77


@pytest.fixture
def linear():
    return LinearRotor.planar(MASS, (STIFFNESS, 1.2 * STIFFNESS), DAMPING, 0.0, UNBALANCE, 0.4)


@pytest.fixture
def rubbed(linear):
    return replace(linear, sliders=tuple(Slider(0, axis, LIMIT, SPRING) for axis in (0, 1)))


def test_without_friction_it_is_the_linear_response():
    rotor = LinearRotor.two_support(
        mass=1.3,
        inertia=1.4e-2,
        polar_inertia=1.2e-3,
        span=0.26,
        com=0.11,
        stiffness=((2e4, 1.5e4), (2e4, 1.5e4)),
        damping=((5.0, 4.0), (5.0, 4.0)),
        unbalances=((0.2, 2e-5, 0.7),),
    )
    found = unbalance_response(replace(rotor, sliders=(Slider(0, 0, 0.0),)), SPEEDS)
    for speed, one in zip(SPEEDS, found, strict=True):
        assert one == pytest.approx(influence(rotor, speed, np.eye(2)) @ rotor.unbalance, rel=1e-10)


def test_what_the_unbalance_feeds_in_damping_and_friction_take(rubbed):
    """A cycle of hysteresis takes 4 F (A - F/k_t), where the slider slips."""
    for speed, (x, y) in zip(SPEEDS, unbalance_response(rubbed, SPEEDS)[..., 0], strict=True):
        force = speed**2 * UNBALANCE * np.exp(0.4j)
        fed = math.pi * (force * x.conjugate() - 1j * force * y.conjugate()).imag
        taken = math.pi * speed * DAMPING * (abs(x) ** 2 + abs(y) ** 2)
        slipped = [max(0.0, abs(a) - LIMIT / SPRING) for a in (x, y)]
        assert fed == pytest.approx(taken + 4.0 * LIMIT * sum(slipped), rel=1e-7)


@pytest.mark.parametrize("speed", SPEEDS[1::2])
def test_long_runs_with_sticking_and_slipping_end_there(friction_of, rubbed, speed):
    """To 2 %: the first harmonic alone is balanced."""
    method = friction_of(rubbed, turning_force=False)
    state, steps = np.zeros(4), 40
    held, largest = method.at_start(state), 0.0
    for k in range(60 * steps):
        excitation = Excitation(np.zeros((4, 1), complex), math.tau * k / steps, speed)
        state, held = method.advance(state, held, excitation, math.tau / speed / steps)
        if k >= 59 * steps:
            largest = max(largest, math.hypot(state[0], state[1]))
    expected = largest_displacement(unbalance_response(rubbed, [speed]))
    assert largest == pytest.approx(expected.item(), rel=0.02)


def test_a_rigid_slider_and_an_undamped_resonance_are_refused(linear):
    with pytest.raises(NoResponse, match="requires a stiffness"):
        unbalance_response(replace(linear, sliders=(Slider(0, 0, LIMIT),)), SPEEDS)
    (support,) = linear.supports
    free = replace(support, damping=0.0 * support.damping)
    undamped = replace(linear, supports=(free,))
    with pytest.raises(NoResponse, match="undamped"):
        unbalance_response(undamped, [math.sqrt(STIFFNESS / MASS)])
