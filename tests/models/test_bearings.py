"""Bearings with cross terms: thresholds in closed form, and the ways by which they are found."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from autobalancer.models.assembly import Assembly, Mounted, SpeedProfile
from autobalancer.models.journal import coefficients, critical_mass, film_table, short_bearing
from autobalancer.models.linear.critical import critical_speeds
from autobalancer.models.linear.linearised import linearise
from autobalancer.models.reference.coupled import Monolith
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.stability import growth_rates
from autobalancer.models.supports import SpeedTable
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


def test_the_short_bearing_has_the_coefficients_of_its_film_integrated():
    """Friswell 2010; the film by Reynolds' equation: e .2662975, K and C to 1e-5."""
    film = short_bearing(0.1, 0.03, 1e-4, 0.1, 525.0, 1500.0 * math.pi / 30.0)
    assert film.eccentricity == pytest.approx(0.26629751, abs=1e-8)
    assert math.degrees(film.attitude) == pytest.approx(70.62005, abs=1e-5)
    expected = np.array([[12.807960, 16.393593], [-25.060393, 8.815303]])
    integrated = np.array([[12.80803, 16.39361], [-25.06045, 8.81537]])
    assert film.stiffness / 1e6 == pytest.approx(expected, rel=1e-6)
    assert film.stiffness / 1e6 == pytest.approx(integrated, rel=1e-5)
    expected = np.array([[232.8969, -81.9244], [-81.9244, 294.9116]])
    integrated = np.array([[232.8998, -81.9237], [-81.9231, 294.9113]])
    assert film.damping / 1e3 == pytest.approx(expected, rel=1e-6)
    assert film.damping / 1e3 == pytest.approx(integrated, rel=2e-5)


@pytest.mark.parametrize(
    ("e", "threshold", "whirl"),
    [(0.1, 2.741279, 0.502938), (0.3, 2.605786, 0.519417), (0.5, 2.541731, 0.514640)],
)
def test_a_rigid_rotor_in_short_bearings_whirls_from_the_speed_of_lund_on(e, threshold, whirl):
    """w sqrt(c/g) and whirl/w, and the same by the rotor's eigenvalues with load m g."""
    mass, square = critical_mass(*coefficients(e))
    assert math.sqrt(mass) == pytest.approx(threshold, abs=1e-6)
    assert math.sqrt(square) == pytest.approx(whirl, abs=1e-6)
    for factor, sign in ((0.99, -1.0), (1.01, 1.0)):
        k, c = coefficients(e)
        assert growth(on_a_bearing(factor * mass, k, c)) * sign > 0.0


def test_beyond_three_quarters_of_the_clearance_no_rigid_rotor_whirls():
    limit = brentq(lambda e: critical_mass(*coefficients(e))[1], 0.5, 0.95)
    assert limit == pytest.approx(0.7560304, abs=1e-7)
    assert critical_mass(*coefficients(0.76))[0] == math.inf


def test_a_long_bearing_and_a_thick_film_are_refused():
    with pytest.raises(ValueError, match=r"at most 0\.5 diameters"):
        short_bearing(0.1, 0.06, 1e-4, 0.1, 525.0, 100.0)
    with pytest.raises(ValueError, match=r"at most 0\.1 of the journal's radius"):
        short_bearing(0.1, 0.03, 6e-3, 0.1, 525.0, 100.0)


@pytest.mark.parametrize("load", [5e5, 1e9, 1e14])
def test_a_load_that_leaves_no_film_is_refused(load):
    with pytest.raises(ValueError, match=r"0\.3 % of the clearance as oil film at 1 rad/s"):
        short_bearing(0.1, 0.03, 1e-4, 0.1, load, 1.0)


@pytest.mark.parametrize("load", [1e5, 525.0, 1e-3, 1e-9, 1e-14])
def test_the_journal_stands_where_the_film_bears_its_load(load):
    """Ocvirk: S = (1 - e^2)^2/(e sqrt(pi^2 (1 - e^2) + 16 e^2))."""
    e = short_bearing(0.1, 0.03, 1e-4, 0.1, load, 1.0).eccentricity
    sommerfeld = 0.1 * 0.1 * 0.03**3 / (8.0 * load * 1e-4**2)
    square = e * e
    carried = (1.0 - square) ** 2 / (e * math.sqrt(math.pi**2 * (1.0 - square) + 16.0 * square))
    assert carried == pytest.approx(sommerfeld, rel=1e-6)


def squared_table(count=2001, high=200.0):
    """k = 1e5 + 2 w^2 N/m along both axes."""
    speeds = np.linspace(0.0, high, count)
    stiffness = (1e5 + 2.0 * speeds**2)[:, None, None] * np.eye(2)
    return SpeedTable(speeds, stiffness, np.zeros_like(stiffness))


def test_the_critical_speed_of_a_table_is_where_the_rotor_of_that_speed_has_it():
    """k0 + k2 w^2 = M w^2: sqrt(k0/(M - k2)) = 111.803399 rad/s."""
    rotor = LinearRotor.planar(10.0, 1.0, bearings=[(1, squared_table())])
    assert critical_speeds(rotor) == pytest.approx([111.803399], rel=1e-7)


def test_a_table_is_linear_between_its_rows_and_ends_with_them():
    table = SpeedTable(
        np.array([10.0, 20.0, 40.0]),
        np.arange(12.0).reshape(3, 2, 2),
        np.zeros((3, 2, 2)),
    )
    for speed, first in ((10.0, 0.0), (15.0, 2.0), (20.0, 4.0), (35.0, 7.0), (40.0, 8.0)):
        assert table.at(speed)[0][0, 0] == pytest.approx(first)
    for outside in (9.99, 40.01):
        with pytest.raises(ValueError, match="must be 10 to 40 rad/s"):
            table.at(outside)


def test_a_film_between_two_rows_of_its_table_is_as_near_as_said():
    size = (0.1, 0.03, 1e-4, 0.1, 525.0)
    table = film_table(*size, 10.0, 900.0)
    for speed in np.sqrt(table.speeds[:-1] * table.speeds[1:]).tolist():
        film, (k, c) = short_bearing(*size, speed), table.at(speed)
        assert np.abs(k - film.stiffness).max() < 1e-3 * np.abs(film.stiffness).max()
        assert np.abs(c - film.damping).max() < 1e-3 * np.abs(film.damping).max()


def test_stability_over_a_table_is_that_of_the_rotor_of_each_speed():
    speeds = np.array([3.0, 4.0, 5.0])
    stiffness = np.array([np.array([[3.0, 0.3], [-0.4, 2.0]]) * s for s in (1.0, 1.4, 2.5)])
    damping = np.array([np.array([[0.2, 0.02], [0.0, 0.3]]) * s for s in (1.0, 0.8, 1.5)])
    weights = Mounted("balls", Weights(2, 0.02, 0.7, 0.006, 1.4), 0, (2.0, 4.0))

    def assembly(bearing):
        return Assembly(
            LinearRotor.planar(1.0, 1.0, unbalance=0.004, bearings=[bearing]), (weights,)
        )

    table = SpeedTable(speeds, stiffness, damping)
    asked = np.array([3.0, 3.5, 4.5, 5.0])
    found = growth_rates(assembly((1, table)), asked)
    for speed, rate in zip(asked.tolist(), found.tolist(), strict=True):
        expected = growth_rates(assembly((1, *table.at(speed))), [speed])
        assert rate == pytest.approx(float(expected[0]), abs=1e-12)
