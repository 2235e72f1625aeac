"""Where a paper's print is wrong, by numbers: the corrected form holds, the print does not."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from autobalancer.models.assembly import Assembly, Mounted, SpeedProfile
from autobalancer.models.reference.coupled import Monolith
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.steps.propagator import generator
from autobalancer.models.weights import Weights

MASS, STIFFNESS, CHI, INTERNAL = 2.0, 18.0, 0.7, 0.4


def coefficients(speed: float, *, printed: bool) -> list[float]:
    """a0..a4 of Dubovik 2006 (8), with a4 as printed or corrected."""
    both = INTERNAL + CHI
    a4 = STIFFNESS**2 + ((CHI if printed else INTERNAL) * speed) ** 2
    return [MASS**2, 2 * MASS * both, both**2 + 2 * STIFFNESS * MASS, 2 * STIFFNESS * both, a4]


def hurwitz_limit(*, printed: bool) -> float:
    """Speed at which the third minor a3 (a1 a2 - a0 a3) - a1^2 a4 changes its sign."""
    a0, a1, a2, a3, _ = coefficients(0.0, printed=printed)
    a4 = (a3 * (a1 * a2 - a0 * a3)) / a1**2
    return np.sqrt(a4 - STIFFNESS**2) / (CHI if printed else INTERNAL)


@pytest.mark.parametrize("speed", [0.0, 2.0, 8.0, 11.0])
def test_dubovik_a4_has_the_internal_damping(speed: float) -> None:
    rotor = LinearRotor.planar(MASS, STIFFNESS, CHI, INTERNAL)
    # (8) is real and of order 4: the roots of the complex z'' form and their conjugates
    roots = np.linalg.eigvals(generator(rotor, speed)[:2, :2])
    expected = MASS**2 * np.poly(np.concatenate([roots, roots.conj()])).real
    assert_allclose(coefficients(speed, printed=False), expected, rtol=1e-12)
    if speed:
        assert abs(coefficients(speed, printed=True)[4] / expected[4] - 1.0) > 1e-3


def test_dubovik_10_follows_from_the_corrected_a4_only() -> None:
    limit = (1.0 + CHI / INTERNAL) * np.sqrt(STIFFNESS / MASS)
    assert_allclose(hurwitz_limit(printed=False), limit, rtol=1e-12)
    assert abs(hurwitz_limit(printed=True) / limit - 1.0) > 0.1
    rotor = LinearRotor.planar(MASS, STIFFNESS, CHI, INTERNAL)
    for factor, stable in ((0.999, True), (1.001, False)):
        roots = np.linalg.eigvals(generator(rotor, factor * limit)[:2, :2])
        assert bool(roots.real.max() < 0.0) is stable


def weight_equation_gap(size: float, *, printed: bool) -> float:
    """What Filimonikhin 2011 (1) leaves over for a motion `size` away from a main motion."""
    w, count, mass, radius, kappa, drag, t = 3.0, 4, 0.1, 0.5, 1.4, 0.2, 0.37
    # two opposite pairs: balanced, and not so even that the mean of e^{2 i psi} vanishes
    psi = np.array([0.2, 0.2 + np.pi, 1.3, 1.3 + np.pi])
    random = np.random.default_rng(3)
    delta, delta1 = size * random.normal(size=(2, count))
    rotor = LinearRotor.planar(2.0, [3.0, 5.0], [0.1, 0.2])
    balls = Mounted("w", Weights(count, mass, radius, drag, kappa), 0, tuple(psi))
    system = Monolith(Assembly(rotor, (balls,)), SpeedProfile.constant(w))
    phi, phi1 = w * t + psi + delta, w + delta1
    derivative = system.rhs(t, np.array([*size * random.normal(size=4), *phi, *phi1]))
    a_x, a_y, phi2 = derivative[2], derivative[3], np.array(derivative[4 + count :])
    unit = np.exp(1j * phi)
    s = mass * radius * unit.sum()
    s1 = mass * radius * (1j * phi1 * unit).sum()
    s2 = mass * radius * ((1j * phi2 - phi1**2) * unit).sum()
    mean = np.exp(2j * psi).mean()
    turning, bend = 2 * w * t + np.angle(mean), abs(mean)
    same = (s.real, s1.real, s.imag, s1.imag)
    sx, sx1, sy, sy1 = same if printed else (s.imag, s1.imag, s.real, s1.real)
    left_x = kappa * (s2.real + 2 * w * sx1 - w**2 * s.real) + drag / mass * (s1.real + w * sx)
    left_y = kappa * (s2.imag - 2 * w * sy1 - w**2 * s.imag) + drag / mass * (s1.imag - w * sy)
    half = mass * count / 2
    right_x = -half * (a_x * (1 - bend * np.cos(turning)) - a_y * bend * np.sin(turning))
    right_y = half * (a_x * bend * np.sin(turning) - a_y * (1 + bend * np.cos(turning)))
    return float(np.hypot(left_x - right_x, left_y - right_y))


def test_filimonikhin_1_couples_the_axes_in_its_cross_terms() -> None:
    corrected = [weight_equation_gap(size, printed=False) for size in (1e-3, 1e-4, 1e-5)]
    printed = [weight_equation_gap(size, printed=True) for size in (1e-3, 1e-4, 1e-5)]
    # a linearisation leaves the square of the distance; a wrong one leaves the distance itself
    assert_allclose(np.diff(np.log10(corrected)), -2.0, atol=0.1)
    assert_allclose(np.diff(np.log10(printed)), -1.0, atol=0.1)
