"""Separate weights under heavy drag, against an integration that shares no code with them."""

import math
import random

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from autobalancer.models.weights import Weights
from tests.native.equations import Track

RADIUS = 0.05
BOUND = 1e-11  # rad: of a step


def drawn(number):
    """A track, the state of its weights, how the plane and the rotor move, and a step."""
    generator = random.Random(f"relaxation {number}")
    kappa, size = generator.choice([(1.4, 0.005), (1.5, 0.01), (1.0, 0.0)])
    count = generator.choice([1, 2, 3])
    size = size if count == 1 else 0.0  # those that can meet move otherwise
    drag, step = 10 ** generator.uniform(2.0, 4.5), 10 ** generator.uniform(-3.0, -0.5)
    mass, speed = 0.01, generator.uniform(-300.0, 300.0)
    weights = Weights(count, mass, RADIUS, drag=drag * kappa * mass, kappa=kappa, radius=size)
    offset = generator.choice([0j, 1e-3 + 2e-3j])
    strength = 10 ** generator.uniform(-1.0, 2.5)
    signal = [
        strength / step**k * complex(generator.gauss(0.0, 0.3), generator.gauss(0.0, 0.3))
        for k in range(4)
    ]
    rates = [speed * generator.gauss(0.0, 0.03) / step**k for k in range(3)] + [0.0]
    angles = [generator.uniform(0.0, math.tau) for _ in range(count)]
    start = 10 ** generator.uniform(-3.0, 1.0)
    speeds = [generator.gauss(0.0, start) for _ in range(count)]
    return weights, offset, angles, speeds, signal, speed, rates, step


def integrated(weights, offset, angle, rate, signal, speed, rates, step):
    """Angle and speed of one weight at the end: kappa R phi'' as Filimonikhina 2017 (4) has it."""
    kappa, drag = weights.kappa, weights.drag / (weights.kappa * weights.mass)
    rolls = (kappa - 1.0) * (RADIUS + weights.radius)
    spins = (speed, *rates)

    def taylor(values, t):
        return sum(value * t**k / math.factorial(k) for k, value in enumerate(values))

    def slope(t, state):
        w, spun = taylor(spins, t), taylor(rates, t)
        felt = taylor(signal, t) + offset * (1j * spun - w * w)
        pulled = (felt * np.exp(-1j * state[0])).imag
        return [state[1], (rolls * spun - pulled) / (kappa * RADIUS) - spun - drag * state[1]]

    method = "DOP853" if drag * step < 3000.0 else "Radau"
    return solve_ivp(slope, (0.0, step), [angle, rate], method, rtol=1e-13, atol=1e-16).y[:, -1]


@pytest.mark.parametrize("number", range(24))
def test_a_step_under_heavy_drag_is_right_however_long_it_is(core, number):
    weights, offset, angles, speeds, signal, speed, rates, step = drawn(number)
    track = Track(core, weights, weights.radius, offset=offset)
    found = track.advance(
        angles, speeds, [0.0] * len(angles), signal, speed, rates[0], step, rates[1:]
    )
    for k, (angle, rate) in enumerate(zip(angles, speeds, strict=True)):
        right = integrated(weights, offset, angle, rate, signal, speed, rates, step)
        fast = weights.drag / (weights.kappa * weights.mass)
        assert abs(found.angles[k] - right[0]) <= BOUND
        assert abs(found.speeds[k] - right[1]) <= BOUND * fast


@pytest.mark.parametrize("step", [0.03, 0.1])
def test_a_track_off_the_centre_moves_its_weight_by_its_own_acceleration_alone(core, step):
    """The plane is at rest: a bound that leaves the offset out ends the iteration at once."""
    weights = Weights(1, 0.01, RADIUS, drag=1000.0 * 1.4 * 0.01, kappa=1.4, radius=0.005)
    offset, speed = 4e-3 + 3e-3j, 60.0
    track = Track(core, weights, weights.radius, offset=offset)
    still, steady = [0j] * 4, [0.0] * 4
    found = track.advance([1.0], [0.0], [0.0], still, speed, 0.0, step, steady[1:])
    angle, rate = integrated(weights, offset, 1.0, 0.0, still, speed, steady, step)
    assert abs(angle - 1.0) > 1e-3
    assert abs(found.angles[0] - angle) <= BOUND
    assert abs(found.speeds[0] - rate) <= BOUND * 1000.0


@pytest.mark.parametrize("turn", [0.01, 0.03, 0.1])
def test_iteration_leaves_a_small_share_of_the_bound_of_a_step(core, turn):
    """Of any displacement, against the closed form of a pendulum that drag brakes.

    `turn` is what one iteration leaves of the one before, about; the points give far more digits.
    """
    drag, step = 1000.0, 0.1
    square = turn * drag / step
    track = Track(core, Weights(1, 0.01, RADIUS, drag=drag * 0.01))
    root = math.sqrt(0.25 * drag**2 - square)
    slow = -square / (0.5 * drag + root)
    for displaced in np.geomspace(1e-8, 1e-4, 60):  # sin differs from it by 2e-13 at most
        found = track.advance(
            [math.pi + displaced], [slow * displaced], [0.0], [RADIUS * square + 0j, 0j, 0j, 0j],
            0.0, 0.0, step, [0.0] * 3,
        )  # fmt: skip
        right = math.pi + displaced * math.exp(slow * step)
        assert abs(found.angles[0] - right) <= 0.1 * BOUND
