"""Bearings with cross terms: thresholds in closed form, and the ways by which they are found."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from autobalancer.models.assembly import Assembly, Mounted, SpeedProfile
from autobalancer.models.linear.linearised import linearise
from autobalancer.models.reference.coupled import Monolith
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.stability import growth_rates
from autobalancer.models.weights import Weights


def on_a_bearing(mass, stiffness, damping):
    return LinearRotor.from_matrices(mass=[[mass]], stiffness=stiffness, damping=damping)


def growth(rotor, speed=100.0):
    return rotor.free_rates(speed).real.max()


@pytest.mark.parametrize(
    ("k_xx", "k_yy", "threshold"),
    [(1e5, 1e5, 6000.0), (1.2e5, 0.8e5, 20880.613018)],
    ids=["round", "unlike axes"],
)
def test_cross_terms_beyond_the_threshold_drive_forward_whirl(k_xx, k_yy, threshold):
    """q*^2 = ((kxx - kyy)/2)^2 + c^2 km/M with kxy = q = -kyx; extensions in closed form."""

    def rate(q):
        return growth(on_a_bearing(10.0, [[k_xx, q], [-q, k_yy]], 60.0 * np.eye(2)))

    assert brentq(rate, 100.0, 1e5, xtol=1e-9) == pytest.approx(threshold, rel=1e-10)
    values = on_a_bearing(
        10.0, [[k_xx, 2.0 * threshold], [-2.0 * threshold, k_yy]], 60.0 * np.eye(2)
    )
    rates, vectors = np.linalg.eig(values.first_order(0.0))
    fastest = int(rates.real.argmax())
    x, y = vectors[:2, fastest]
    turn = (x.conjugate() * y).imag * np.sign(rates[fastest].imag)
    assert turn < 0.0  # y lags x by a quarter: x = cos, y = sin


def test_a_bearing_of_any_terms_has_the_critical_mass_of_lund():
    k, c = [[1.2e5, 5e4], [-3e4, 0.9e5]], [[80.0, 5.0], [5.0, 40.0]]
    found = brentq(lambda m: growth(on_a_bearing(m, k, c)), 1e-3, 1e3, xtol=1e-14)
    assert found == pytest.approx(0.2405251989, rel=1e-9)
    whirl = np.abs(on_a_bearing(found, k, c).free_rates(0.0).imag)
    assert whirl.min() == pytest.approx(642.09985, rel=1e-7)


def test_internal_damping_is_the_same_as_cross_stiffness_that_grows_with_speed():
    """p (z' - i w z): kxy = p w, kyx = -p w, and p more damping."""
    p, w, eye = 30.0, 150.0, np.eye(2)
    turned = LinearRotor.planar(10.0, 1e5, 60.0, internal_damping=p)
    crossed = on_a_bearing(10.0, 1e5 * eye + p * w * np.array([[0, 1], [-1, 0]]), (60.0 + p) * eye)
    both = zip(crossed.real_coefficients(w), turned.real_coefficients(w), strict=True)
    for found, expected in both:
        assert found == pytest.approx(expected, rel=1e-15)


def machine(stiffness, damping):
    rotor = LinearRotor.from_matrices(
        mass=[[1.0, 0.1], [0.1, 0.8]],
        stiffness=stiffness,
        damping=damping,
        gyroscopic=[[0.2, -0.1], [-0.1, 0.2]],
        internal_damping=[[0.02, 0.0], [0.0, 0.01]],
        planes=[[0.8, 0.3]],
        unbalance=[0.004, 0.0015],
    )
    return Assembly(rotor, (Mounted("balls", Weights(2, 0.02, 0.7, 0.006, 1.4), 0, (2.0, 4.0)),))


CROSSED = (
    [[3.0, -0.4, 0.3, 0.1], [-0.4, 2.0, 0.0, 0.2], [-0.5, 0.0, 5.0, 0.1], [0.0, -0.1, 0.1, 6.0]],
    [[0.2, 0.0, 0.03, 0.0], [0.0, 0.3, 0.0, 0.01], [-0.02, 0.0, 0.2, 0.0], [0.0, 0.02, 0.0, 0.1]],
)


def test_floquet_multipliers_of_cross_terms_are_those_of_the_equations_of_motion():
    """Against derivatives of an integration in fixed axes, which shares no equation with them."""
    assembly, speed = machine(*CROSSED), 4.0
    system = linearise(assembly)
    rotor = assembly.rotor
    monolith = Monolith(assembly, SpeedProfile.constant(speed))
    still = monolith.initial()
    still[-4:-2] = system.angles
    period = 2.0 * math.pi / speed

    def after(state):
        return solve_ivp(
            monolith.rhs, (0.0, period), state, method="DOP853", rtol=1e-12, atol=1e-14
        ).y[:, -1]

    columns = []
    for k in range(len(still)):
        step = np.zeros(len(still))
        step[k] = 1e-5
        columns.append((after(still + step) - after(still - step)) / 2e-5)
    multipliers = np.linalg.eigvals(np.array(columns).T)
    largest = np.log(np.abs(multipliers).max()) / period
    found = growth_rates(assembly, [speed])
    assert not rotor.isotropic
    assert rotor.crossed
    assert float(found[0]) == pytest.approx(largest, abs=2e-6)
