"""Elementary functions against arbitrary precision, in units of the last place."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest

RANDOM = np.random.default_rng(7)


def _ulps(found, exact_function, x, bits=400):
    """Largest error of `found` in units of the last place of the exact value."""
    worst = 0.0
    with mpmath.workprec(bits):
        for value, *arguments in zip(found.tolist(), *x, strict=True):
            exact = exact_function(*(mpmath.mpf(float(a)) for a in arguments))
            ulp = math.ulp(float(exact))
            worst = max(worst, float(abs(mpmath.mpf(value) - exact) / ulp))
    return worst


def _angles():
    """Of all sizes, and the numbers next to multiples of a quarter turn."""
    wide = RANDOM.choice([-1.0, 1.0], 1500) * 10.0 ** RANDOM.uniform(-300.0, 15.6, 1500)
    usual = RANDOM.uniform(-20.0, 20.0, 1500)
    large = RANDOM.uniform(-1e9, 1e9, 800)
    quarters = np.concatenate([np.arange(-200.0, 201.0), RANDOM.integers(1, 2**49, 300)])
    with mpmath.workprec(200):
        near = np.array([float(mpmath.mpf(float(k)) * mpmath.pi / 4) for k in quarters])
    # of all numbers, the one nearest to a multiple of a quarter turn below 2^52, and of any size
    hardest = np.array([6381956970095103.0 * 2.0**-1, 5.3e15 / 2.0, 1e5, 99999.99, 1e5 + 1e-6])
    up, down = np.nextafter(near, np.inf), np.nextafter(near, -np.inf)
    return np.concatenate([wide, usual, large, near, up, down, hardest])


@pytest.mark.slow
@pytest.mark.parametrize("name", ["sine", "cosine"])
def test_sine_and_cosine_are_within_an_ulp_up_to_2_to_the_52(core, name):
    x = _angles()
    assert _ulps(core.real(name, x), getattr(mpmath, name[:3]), [x]) < 0.8


def test_sine_and_cosine_beyond_stay_on_the_unit_circle_and_infinite_angles_have_none(core):
    x = 10.0 ** RANDOM.uniform(15.7, 308.0, 500)
    assert np.abs(np.hypot(core.real("sine", x), core.real("cosine", x)) - 1.0).max() < 4e-16
    assert np.isnan(core.real("sine", np.array([np.inf, -np.inf, np.nan]))).all()


def test_exponential_is_within_an_ulp_down_to_the_smallest_number(core):
    x = np.concatenate(
        [
            RANDOM.uniform(-745.0, 709.7, 1500),
            RANDOM.uniform(-2.0, 2.0, 1500),
            RANDOM.choice([-1.0, 1.0], 1000) * 10.0 ** RANDOM.uniform(-320.0, 0.0, 1000),
        ]
    )
    assert _ulps(core.real("natural_exp", x), mpmath.exp, [x]) < 0.8
    ends = core.real("natural_exp", np.array([0.0, 800.0, -800.0, np.inf, -np.inf, np.nan]))
    assert ends[:5].tolist() == [1.0, np.inf, 0.0, np.inf, 0.0]
    assert np.isnan(ends[5])


def test_arc_sine_is_within_an_ulp_up_to_its_ends(core):
    x = np.concatenate(
        [
            RANDOM.uniform(-1.0, 1.0, 1500),
            1.0 - 10.0 ** RANDOM.uniform(-16.0, 0.0, 2000),
            10.0 ** RANDOM.uniform(-300.0, 0.0, 1000),
            [0.5, np.nextafter(0.5, 1.0), 1.0, -1.0, 0.0],
        ]
    )
    assert _ulps(core.real("arc_sine", x), mpmath.asin, [x]) < 1.0
    assert np.isnan(core.real("arc_sine", np.array([1.0000001, -2.0, np.nan]))).all()


def test_hypotenuse_is_rounded_almost_correctly_without_overflow(core):
    size = 10.0 ** RANDOM.uniform(-300.0, 300.0, 1500)
    x = np.concatenate([size, RANDOM.normal(size=1500)])
    y = x * 10.0 ** RANDOM.uniform(-18.0, 1.0, 3000)
    assert _ulps(core.real("hypotenuse", x, y), mpmath.hypot, [x, y]) < 0.51
    assert core("hypotenuse", 3.0, -4.0) == 5.0
    assert core("hypotenuse", 0.0, -4.0) == 4.0
    assert core("hypotenuse", math.inf, math.nan) == math.inf
    assert core("hypotenuse", 1e-310, 1e-310) == pytest.approx(
        math.hypot(1e-310, 1e-310), abs=1e-323
    )


def test_modulo_and_remainder_are_those_of_python_to_the_last_bit(core):
    x = RANDOM.choice([-1.0, 1.0], 1500) * 10.0 ** RANDOM.uniform(-20.0, 200.0, 1500)
    x = np.concatenate([x, np.arange(-40.0, 41.0) * math.pi, np.arange(-40.0, 41.0)])
    for y in (math.tau, 4.0, 1.0, 0.3):
        modulus = np.full_like(x, y)
        assert core.real("modulo", x, modulus).tolist() == [a % y for a in x.tolist()]
        exact = [math.remainder(a, y) for a in x.tolist()]
        assert core.real("ieee_remainder", x, modulus).tolist() == exact


def test_nearest_and_powers_of_two_are_those_of_python_to_the_last_bit(core):
    x = np.concatenate(
        [RANDOM.uniform(-1e3, 1e3, 2000), np.arange(-9.5, 10.0), [2.0**52 + 1.0, 1e300, -0.5, 2.5]]
    )
    assert core.real("nearest", x).tolist() == [float(round(a)) for a in x.tolist()]
    for a in [*x.tolist(), 5e-324, 1e-310, 1.7e308]:
        if a:
            assert core("binary_exponent", a) == math.frexp(a)[1]
        for power in (-1100, -1074, -1060, -1022, -30, 0, 1, 900):
            try:
                exact = math.ldexp(a, power)
            except OverflowError:
                exact = math.copysign(math.inf, a)
            assert core("scaled_by_power", a, power) == exact


@pytest.mark.parametrize("parts", [1, 2])
def test_systems_of_equations_are_solved_with_any_pivots(core, parts):
    """Diagonals of zeros, real, imaginary and other ones."""
    for n in (1, 2, 7):
        a, b = (RANDOM.normal(size=(n, m, parts)) @ [1.0, 1.0j][:parts] for m in (n, 3))
        for diagonal in (0.0, 5.0, 5.0j, 1.0 + 4.0j)[n == 1 : 2 * parts]:
            np.fill_diagonal(a, diagonal)
            expected, found = np.linalg.solve(a, b), b.copy()
            assert core("matrix_solve", parts, n, 3, a.copy(), found) == 0
            assert found == pytest.approx(expected, rel=1e-12)
    assert core("matrix_solve", parts, 2, 1, np.zeros(4 * parts), np.zeros(2 * parts)) == 1


def test_response_to_rate_and_drive_is_exact_whatever_the_drag(core):
    phi = np.empty(6)
    for z in [0.0, -1e-12, -1e-3, -0.3, -0.999999, -1.0, -1.0000001, -1.5, -30.0, -1e3, -1e9]:
        core("phi_functions", z, phi)
        with mpmath.workdps(80):
            exact = [mpmath.hyp1f1(1, k + 1, mpmath.mpf(z)) / mpmath.factorial(k) for k in range(6)]
            errors = [
                abs(mpmath.mpf(a) - b) / (b + 1e-300)
                for a, b in zip(phi.tolist(), exact, strict=True)
            ]
        # the upward recursion loses a factor of at most k!/|z|^k
        assert max(errors) < 2e-14, (z, [float(e) for e in errors])
