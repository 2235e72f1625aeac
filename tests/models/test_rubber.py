"""Rubber as an element with one state: closed forms, and an integration of its own equations."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from autobalancer.models.bodies import Body, Foot, with_bodies
from autobalancer.models.forces import forces
from autobalancer.models.harmonic_balance import unbalance_response
from autobalancer.models.linear.critical import critical_speeds
from autobalancer.models.linear.modes import modes
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.rubber import Zener, with_rubber, with_turning_rubber, zener


@pytest.mark.parametrize(
    ("eta", "static", "branch", "damper", "time"),
    [(0.2, 0.836039, 0.407922, 106.4478, 2.60952e-3),
     (1.0, 0.585786, 2.828427, 372.9232, 1.31848e-3)],
)  # fmt: skip
def test_the_element_has_the_stiffness_and_loss_factor_that_were_measured(
    eta, static, branch, damper, time
):
    found = zener(1e5, eta, 100.0 * math.pi)
    assert found.static / 1e5 == pytest.approx(static, abs=1e-6)
    assert found.branch / 1e5 == pytest.approx(branch, abs=1e-6)
    assert found.branch * found.time == pytest.approx(damper, rel=1e-6)
    assert found.time == pytest.approx(time, rel=1e-5)
    dynamic = found.dynamic(100.0 * math.pi)
    assert dynamic.real == pytest.approx(1e5, rel=1e-12)
    assert dynamic.imag / dynamic.real == pytest.approx(eta, rel=1e-12)
    losses = [(k := found.dynamic(100.0 * math.pi * x)).imag / k.real for x in (0.5, 0.9, 1.1, 2.0)]
    assert max(losses) < eta
    assert min(losses) > 0.79 * eta


def on_rubber(mass=10.0, eta=0.2, frequency=100.0, **values):
    one = zener(1e5, eta, frequency)
    return with_rubber(LinearRotor.planar(mass, one.static, **values), {0: (one, one)})


def test_the_rates_are_the_roots_of_the_cubic_and_none_is_added_to_the_modes():
    """tau m s^3 + m s^2 + (k0 + k1) tau s + k0 = 0."""
    found = modes(on_rubber(), 0.0).eigenvalues
    expected = [-99.758175, -11.111107 + 100.495291j]
    for value in expected:
        assert np.abs(found - value).min() == pytest.approx(0.0, abs=1e-6)
    assert len(found) == 3  # the oscillation turns both ways


@pytest.mark.parametrize(("share", "size"), [(0.5, 0.37854654), (1.0, 5.0), (2.0, 1.39257950)])
def test_unbalance_moves_a_disc_on_rubber_as_its_dynamic_stiffness_says(share, size):
    found = unbalance_response(on_rubber(unbalance=0.01), [100.0 * share])[0]
    assert 1e3 * abs(found[0, 0]) == pytest.approx(size, rel=1e-8)


def test_the_most_damped_rubber_has_one_triple_rate():
    """k1 = 8 k0, 1/tau = 3 sqrt(3 k0/m): s = -sqrt(3 k0/m)."""
    static, mass = 2e4, 5.0
    rate = math.sqrt(3.0 * static / mass)
    one = Zener(static, 8.0 * static, 1.0 / (3.0 * rate))
    rotor = with_rubber(LinearRotor.planar(mass, static), {0: (one, one)})
    own = modes(rotor, 0.0).eigenvalues
    assert np.abs(own + rate).max() < 1e-4 * rate  # a triple root is known to a third of the digits


def test_a_critical_speed_on_rubber_is_that_of_the_dynamic_stiffness():
    """kd = 1e5 N/m at 100 rad/s and m = 10 kg: 100 rad/s; at others K(i w) = m w^2."""
    assert critical_speeds(on_rubber()) == pytest.approx([100.0], rel=1e-9)
    one = zener(1e5, 0.2, 100.0)
    found = critical_speeds(on_rubber(mass=2.0))[0]
    assert one.dynamic(found).real == pytest.approx(2.0 * found**2, rel=1e-9)


def test_force_and_motion_of_unlike_axes_and_a_rubber_foot_are_those_of_the_dynamic_stiffness():
    """Two masses with K1(i w), K2(i w) along each axis, solved apart."""
    rotor = LinearRotor.planar(3.0, (4e4, 6e4), (10.0, 20.0), unbalance=0.004)
    feet = (Foot(0.0, (5e4, 9e4), (30.0, 15.0)),)
    machine = with_bodies(rotor, [0.0], [0.0], [Body("base", 8.0, feet=feet)], "base")
    pairs = {
        0: (zener(4e4, 0.3, 80.0), zener(6e4, 0.1, 80.0)),
        1: (zener(5e4, 0.25, 60.0), zener(9e4, 0.4, 60.0)),
    }
    rubber, w = with_rubber(machine, pairs), 90.0
    motion = unbalance_response(rubber, [w])[0]
    found = {one.name: one.force for one in forces(rubber, motion, w)}
    for axis, phase in ((0, 1.0), (1, -1j)):
        k1 = pairs[0][axis].dynamic(w) + 1j * w * (10.0, 20.0)[axis]
        k2 = pairs[1][axis].dynamic(w) + 1j * w * (30.0, 15.0)[axis]
        matrix = np.array([[k1 - 3.0 * w**2, -k1], [-k1, k1 + k2 - 8.0 * w**2]])
        z = np.linalg.solve(matrix, [0.004 * w**2 * phase, 0.0])
        assert motion[axis, :2] == pytest.approx(z, rel=1e-10)
        assert found["base.foot[1]"][axis] == pytest.approx(k2 * z[1], rel=1e-10)
        assert found["support[1]"][axis] == pytest.approx(k1 * (z[0] - z[1]), rel=1e-10)


def test_a_motion_that_begins_relaxed_stays_one_of_the_element():
    """Against an integration of f = k0 d + k1 (d - u), tau u' = d - u itself."""
    one, mass = zener(1e5, 0.5, 100.0), 10.0
    rotor = with_rubber(LinearRotor.planar(mass, 1.0), {0: (one, one)})
    system = rotor.first_order(0.0).real
    start = np.array([1e-3, 1e-3, 0.2, 0.0])  # d, u, d', u'

    def element(_t, y):
        d, v, u = y
        force = one.static * d + one.branch * (d - u)
        return [v, -force / mass, (d - u) / one.time]

    times = np.linspace(0.0, 0.2, 21)
    options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-16, "t_eval": times}
    ours = solve_ivp(lambda _t, y: system @ y, (0.0, 0.2), start, **options).y
    theirs = solve_ivp(element, (0.0, 0.2), [1e-3, 0.2, 1e-3], **options).y
    assert ours[0] == pytest.approx(theirs[0], abs=1e-12)
    assert ours[1] == pytest.approx(theirs[2], abs=1e-12)


@pytest.mark.parametrize(
    ("relaxation", "limits"), [(1e-3, (310.0899, 4462.9394)), (1e-2, (121.3872, 544.4714))]
)
def test_rubber_that_turns_drives_whirl_within_a_band(relaxation, limits):
    """m 10, c 40, k 1e5 outside, k_i 2e4 inside: from the balance c nu = k_i q/(1 + q^2)."""
    disc = replace(LinearRotor.planar(10.0, 1e5, 40.0), elastic=np.array([[2e4]]))
    turning = with_turning_rubber(disc, 1, Zener(0.0, 1.0, relaxation))

    def growth(speed: float) -> float:
        return float(np.linalg.eigvals(turning.first_order(speed)).real.max())

    low, high = limits
    found = [brentq(growth, 0.95 * limit, 1.05 * limit, xtol=1e-9) for limit in limits]
    assert found == pytest.approx(limits, abs=1e-4)
    assert growth(0.5 * (low + high)) > 0.0 > max(growth(0.9 * low), growth(1.1 * high))
