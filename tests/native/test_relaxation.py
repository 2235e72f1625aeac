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
