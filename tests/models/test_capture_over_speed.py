"""Weights that are left behind where the rotor's matrices are not linear in the speed."""

import math
from dataclasses import replace

import numpy as np
import pytest

from autobalancer.models.assembly import Assembly, Mounted
from autobalancer.models.capture import capture
from autobalancer.models.ring import Ring
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.supports import SpeedTable
from autobalancer.models.weights import Weights

COUNT, MASS, DRAG = 3, 0.02, 0.004
BALLS = Mounted("balls", Weights(COUNT, MASS, 1.0, DRAG, 1.4), 0, (0.0,) * COUNT)


def on_table(low=0.5, high=4.0):
    """A planar rotor whose bearing grows stiffer, and has cross terms, with the speed."""
    speeds = np.linspace(low, high, 8)
    stiffness, damping = np.zeros((2, len(speeds), 2, 2))
    stiffness[:, 0, 0] = 1.0 + 0.05 * speeds
    stiffness[:, 1, 1] = 1.3 + 0.05 * speeds
    stiffness[:, 0, 1], stiffness[:, 1, 0] = 0.01, -0.01
    damping[:, [0, 1], [0, 1]] = 0.08
    table = SpeedTable(speeds, stiffness, damping)
    rotor = LinearRotor.planar(1.0, 0.0, bearings=[(1, table)], unbalance=0.005)
    return Assembly(rotor, (BALLS,))


def possible(assembly, speed):
    return {(round(one.frequency, 9), m.weights) for one, m in capture(assembly, speed).motions}


@pytest.mark.parametrize("speed", [1.6, 2.2, 3.9])
def test_a_table_gives_the_motions_of_the_bearings_of_its_speed(speed):
    assembly = on_table()
    found, fixed = (capture(each, speed) for each in (assembly, assembly.at_speed(speed)))
    assert found.drag_ratio == pytest.approx(fixed.drag_ratio, rel=1e-9)
    frequencies = [[m.frequency for _, m in each.motions] for each in (found, fixed)]
    assert frequencies[0] == pytest.approx(frequencies[1], rel=1e-9)
    assert possible(assembly, speed) == possible(assembly.at_speed(speed), speed)


def test_weights_are_let_go_at_the_speed_whose_bearings_let_them_go():
    assembly = on_table()
    released = {
        m.release_speed
        for one in capture(assembly, 1.6).natural
        for m in one.motions
        if m.weights == COUNT and m.release_speed < 4.0
    }
    assert released
    for speed in released:
        below, above = (
            [m for _, m in capture(assembly.at_speed(w), w).motions if m.weights == COUNT]
            for w in (0.999 * speed, 1.001 * speed)
        )
        assert len(below) == len(above) + 1


def test_a_release_speed_beyond_the_table_is_not_known():
    assembly = on_table(high=1.8)
    motions = [m for one in capture(assembly, 1.6).natural for m in one.motions]
    assert all(m.release_speed <= 1.8 or math.isnan(m.release_speed) for m in motions)
    assert any(math.isnan(m.release_speed) and m.weights == COUNT for m in motions)


def test_balls_beside_a_ring_are_held_by_the_receptance_of_rotor_and_liquid():
    ring = Ring(1.0, 0.8, 1.0, 0.02, wave_damping=0.3)
    stiffness, damping, speed = 1.0, 0.08, 1.7
    rotor = LinearRotor.planar(1.0, stiffness, damping, unbalance=0.005)
    found = capture(Assembly(rotor, (BALLS, Mounted("ring", ring, 0))), speed)
    (w,) = {m.frequency for _, m in found.motions if m.weights == COUNT}
    liquid, f = ring.liquid_mass, ring.hollow
    wave = -(1.0 + f) * w**2 + 0.3j * (w - speed) + 4.0 * speed * w - 2.0 * speed**2
    dynamic = stiffness + 1j * damping * w - (1.0 + COUNT * MASS + liquid) * w**2
    dynamic -= liquid * f * w**4 / wave
    brake = COUNT * MASS**2 * w**4 * -(1.0 / dynamic).imag
    assert brake == pytest.approx(DRAG * (speed - w), rel=1e-4)
    alone = capture(Assembly(rotor, (BALLS,)), speed)
    assert all(abs(m.frequency - w) > 1e-3 * w for _, m in alone.motions)


def test_more_drag_than_the_limit_holds_no_weights_on_a_table():
    assembly, speed = on_table(), 2.2
    limit = capture(assembly, speed).drag_ratio
    for factor, held in ((0.98, True), (1.02, False)):
        device = replace(BALLS.device, drag=DRAG * limit * factor)
        other = replace(assembly, balancers=(replace(BALLS, device=device),))
        assert bool(capture(other, speed).motions) is held
