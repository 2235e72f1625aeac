"""Influence coefficients and trial runs of Polushkin 2016."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import linprog

from autobalancer.models.linear.critical import critical_speeds
from autobalancer.models.papers.influence import (
    find_correction,
    from_runs,
    influence,
    scalar_coefficients,
    unbalance_from_response,
)
from autobalancer.models.rotor import LinearRotor
from tests.studies.papers import inverse_dynamic_stiffness, left_plane, right_plane

MASS, INERTIA, SPAN, LEFT, RIGHT = 12.0, 0.7, 0.8, 0.15, 0.1
STIFFNESS = ((2e5, 6e5), (3e5, 4e5))
DAMPING = ((150.0, 30.0), (90.0, 300.0))
SPEEDS = (30.0, 178.0, 260.0, 1500.0)  # below, between and above the resonances


def machine(**changes):
    return LinearRotor.two_support(
        **{
            "mass": MASS,
            "inertia": INERTIA,
            "span": SPAN,
            "stiffness": STIFFNESS,
            "damping": DAMPING,
            "planes": (LEFT, SPAN - RIGHT),
            **changes,
        }
    )


def closed_forms(axis, speed):
    k = [support[axis] for support in STIFFNESS]
    c = [support[axis] for support in DAMPING]
    inverse = inverse_dynamic_stiffness(MASS, INERTIA, SPAN, k, c, speed)
    return np.column_stack(
        [left_plane(inverse, SPAN, speed, LEFT), right_plane(inverse, SPAN, speed, RIGHT)]
    )


@pytest.mark.parametrize("speed", SPEEDS)
def test_coefficients_of_the_matrices_are_the_papers_closed_forms(speed):
    x, y = influence(machine(), speed)
    np.testing.assert_allclose(x, closed_forms(0, speed), rtol=1e-12)
    np.testing.assert_allclose(y, -1j * closed_forms(1, speed), rtol=1e-12)


def test_isotropic_rotor_whirls_in_circles():
    alike = {"stiffness": ((2e5, 2e5), (3e5, 3e5)), "damping": ((9.0, 9.0), (5.0, 5.0))}
    nearly = {**alike, "stiffness": ((2e5, 2e5), (3e5, 3e5 * (1 + 1e-13)))}
    x, y = influence(machine(polar_inertia=0.3, **alike), 150.0)
    np.testing.assert_array_equal(y, -1j * x)
    np.testing.assert_allclose(
        influence(machine(polar_inertia=0.3, **nearly), 150.0)[1], y, rtol=1e-10
    )


def test_undamped_rotor_at_its_critical_speed_has_no_coefficients():
    rotor = LinearRotor.planar(1.0, 4.0)
    assert critical_speeds(rotor) == pytest.approx([2.0])
    with pytest.raises(ValueError, match=r"speed = 2.0 rad/s: a critical speed"):
        influence(rotor, 2.0)


UNBALANCE = np.array([3e-3 * np.exp(0.4j), 2e-3 * np.exp(-2.1j)])
TRIALS = np.array([1e-3 * np.exp(1.0j), 2e-3])


@pytest.mark.parametrize("speed", SPEEDS)
def test_trial_runs_recover_coefficients_and_unbalance(speed):
    k = influence(machine(), speed)[0]
    mounted = np.vstack([np.zeros(2), np.diag(TRIALS)])
    runs = (UNBALANCE + mounted) @ k.T
    found = from_runs(runs, mounted)
    np.testing.assert_allclose(found, k, rtol=1e-9)
    np.testing.assert_allclose(unbalance_from_response(found, runs[0]), UNBALANCE, rtol=1e-9)


def test_more_sensors_than_planes_are_used_by_least_squares():
    both_axes = influence(machine(), 260.0).reshape(4, 2)
    found = unbalance_from_response(both_axes, both_axes @ UNBALANCE)
    np.testing.assert_allclose(found, UNBALANCE, rtol=1e-10)


def test_scalar_coefficients_are_one_phase_for_all():
    k = influence(machine(), 178.0)[0]
    used = scalar_coefficients(k, lag=-0.3)
    np.testing.assert_allclose(np.angle(used), -0.3)
    np.testing.assert_allclose(np.abs(used), np.abs(k))


def test_two_planes_at_one_place_cannot_be_told_apart():
    k = influence(machine(planes=(0.2, 0.2)), 178.0)[0]
    with pytest.raises(ValueError, match="rank 1 for 2 planes"):
        unbalance_from_response(k, k @ UNBALANCE)


def polar(text):
    """Complex numbers from "amplitude@degrees ..."."""
    pairs = [part.split("@") for part in text.split()]
    return np.array([float(a) * np.exp(1j * np.radians(float(d))) for a, d in pairs])


def table(text):
    return np.array([polar(line) for line in text.strip().splitlines()])


DARLOW = "3.16@72 3.16@18 4.12@14 5.39@68"
# published least squares: coefficients, readings, corrections as printed
JOBS = {
    "Goodman 1964": ("3@0 2@180\n5@0 2@180\n5@0 3@180", "1@0 1@180 0@0", "0.81@0 1.48@0"),
    "Darlow 1982, three planes": (
        "1.41@45 2.24@27 3.61@34\n3.16@72 4.47@27 2.24@27\n2.83@45 2.24@27 5@37\n"
        "3.16@18 3.61@34 4.47@27", DARLOW, "1.39@-4 1.25@-144 .98@168"),
    "Darlow 1982, two of them": (
        "1.41@45 3.61@34\n3.16@72 2.24@27\n2.83@45 5@37\n3.16@18 4.47@27", DARLOW,
        "0.51@46 1.13@-155"),
}  # fmt: skip


@pytest.mark.parametrize("job", JOBS)
def test_published_balancing_jobs_have_the_corrections_printed(job):
    coefficients, readings, printed = JOBS[job]
    found = -unbalance_from_response(table(coefficients), polar(readings))
    np.testing.assert_allclose(found, polar(printed), atol=0.05)


# Foiles, Allaire and Gunter 2000: 11 readings, 4 planes
FOILES = table("""
9.8@117 17@124 7.2@114 38.5@77
2.7@43 14.3@317 4.5@213 14.3@270
12.5@323 25@261 15.2@158 30@238
22.4@92 32.6@45 23.3@315 27.8@210
26@94 40.3@9 25@330 34@213
40.3@355 43@144 29.6@61 65.4@322
20.6@339 32.3@152 36.7@41 61.8@322
12.6@226 37.6@52 18.8@153 26@176
13.4@209 26.9@76 47.5@98 71.7@312
13.4@154 22.4@307 52@299 102@165
5.4@24 7.2@199 22.4@2 27.8@99
""")
BEFORE = polar("55@259 45@118 124@21 138@349 107@349 90@280 58@354 108@201 88@190 56@48 73@158")


@pytest.mark.parametrize(
    ("largest", "printed"),
    [
        (None, "4.42@88 2.92@352 1.588@322 1.928@304"),
        (3.402, "3.402@91 2.325@354 1.361@318 1.786@305"),
    ],
)
def test_least_maximum_is_near_the_published_corrections_and_no_larger(largest, printed):
    bounds = None if largest is None else [largest] * 4
    found = find_correction(FOILES, BEFORE, bounds, min_max=True)
    np.testing.assert_allclose(found, polar(printed), atol=0.15)
    reached = np.abs(BEFORE + FOILES @ found).max()
    assert reached <= np.abs(BEFORE + FOILES @ polar(printed)).max()
    # nothing near it is better, as the problem is convex
    for other in near(found, largest):
        assert np.abs(BEFORE + FOILES @ other).max() >= reached * (1.0 - 1e-9)


def near(found, largest=None):
    """Corrections a little beside, none of them larger than `largest`."""
    rng = np.random.default_rng(1)
    for step in rng.normal(size=(500, 8)).view(complex) * 0.01:
        other = found + step
        yield other if largest is None else other * np.minimum(1.0, largest / np.abs(other))


def test_least_squares_with_a_largest_mass_keep_it_and_are_least():
    free = -unbalance_from_response(FOILES, BEFORE)
    assert find_correction(FOILES, BEFORE, [99.0] * 4) == pytest.approx(free, abs=1e-5)
    bound = 0.5 * np.abs(free).max()
    found = find_correction(FOILES, BEFORE, [bound] * 4)
    assert np.abs(found).max() == pytest.approx(bound, rel=1e-6)
    reached = (np.abs(BEFORE + FOILES @ found) ** 2).sum()
    for other in near(found, bound):
        assert (np.abs(BEFORE + FOILES @ other) ** 2).sum() >= reached * (1.0 - 1e-9)


PLANES_ALIKE = [(seed, s, p) for seed in range(6) for s, p in ((3, 2), (7, 2), (7, 4), (8, 3))]


def alike(seed, readings, planes):
    """Coefficients whose first two planes are nearly alike, readings, and bounds of the masses."""
    rng = np.random.default_rng(seed)
    k = rng.normal(size=(readings, 2 * planes)).view(complex)
    k[:, 1] = k[:, 0] * (1.0 + 10.0 ** rng.uniform(-3, -1) * rng.normal(size=readings))
    k *= 10.0 ** rng.uniform(-1.5, 1.5, size=(readings, 1)) * 10.0 ** rng.uniform(-3, 3)
    a = rng.normal(size=2 * readings).view(complex) * 10.0 ** rng.uniform(-3, 3)
    free = np.abs(np.linalg.lstsq(k, a, rcond=None)[0])
    return k, a, free * 10.0 ** rng.uniform(-2.0, 0.7, size=planes)


@pytest.mark.parametrize("case", PLANES_ALIKE)
def test_least_maximum_with_largest_masses_is_that_of_a_linear_program(case):
    k, a, bounds = alike(*case)
    found = find_correction(k, a, bounds, min_max=True)
    assert (np.abs(found) <= bounds * (1.0 + 1e-9)).all()
    size = np.abs(a).max()
    least = size * least_by_linear_program(k * bounds / size, a / size)
    assert np.abs(a + k @ found).max() <= (1.0 + 2e-5) * least + 1e-6 * size


def least_by_linear_program(k, a):
    """Least maximum of |a + k w| with |w| <= 1, or less by 1e-5: 720 edges for every circle."""
    turns = np.exp(2j * np.pi * np.arange(720) / 720)[:, None]
    own = np.eye(k.shape[1])
    planes = [np.hstack([(turns * row).real, -(turns * row).imag]) for row in (*k, *own)]
    left = np.repeat([-1.0, 0.0], [720 * len(a), 720 * len(own)])[:, None]
    limits = np.concatenate([-(turns * a).real.T.ravel(), np.ones(720 * len(own))])
    cost = np.eye(2 * len(own) + 1)[-1]
    return linprog(
        cost, np.hstack([np.vstack(planes), left]), limits, bounds=[(None, None)] * len(cost)
    ).fun


@pytest.mark.parametrize("case", PLANES_ALIKE)
def test_least_squares_with_largest_masses_leave_no_slope_into_the_bounds(case):
    k, a, bounds = alike(*case)
    found = find_correction(k, a, bounds)
    left = a + k @ found
    slope = k.conj().T @ left
    # of a convex function: no mass within its bound lowers half the sum by more than this
    gap = ((slope.conj() * found).real + bounds * np.abs(slope)).sum()
    assert gap <= 1e-6 * 0.5 * (np.abs(left) ** 2).sum()
