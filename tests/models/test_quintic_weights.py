"""Point weights under a quintic signal: order 6, any drag, and the force's second derivative."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.interpolate import BPoly

from autobalancer.models import quintic
from autobalancer.models.quintic_weights import advance, reaction_second, substep
from autobalancer.models.spin import STEADY
from autobalancer.models.weights import KAPPA, Weights, reaction

pytestmark = pytest.mark.slow

SIGNAL = (1.0 + 0.5j, -1.0 + 2.0j, 3.0 - 1.0j, 2.0j, -4.0 + 1.0j, 5.0 - 2.0j)
ANGLES, SPEEDS = (0.3, 1.0), (0.2, -3.0)
SPEED = 3.0
SPIN_UP, RATES = 2.0, (-3.0, 4.0, 5.0)  # w' [rad/s^2] and its derivatives


def derivatives(values: Sequence[complex]) -> list[Polynomial]:
    """A polynomial with these values and derivatives at 0, and its own."""
    taylor = Polynomial(np.array(values) / [math.factorial(k) for k in range(len(values))])
    return [taylor.deriv(k) for k in range(len(values))]


SIGNAL_DERIVATIVES = derivatives(SIGNAL)
SPEED_DERIVATIVES = derivatives((SPEED, SPIN_UP, *RATES))[:4]


def derivative(k: int, t: float) -> complex:
    """The signal's k-th derivative, by NumPy's polynomials."""
    return complex(SIGNAL_DERIVATIVES[k](t))


def spin(t: float) -> tuple[float, float, float, float]:
    """The rotor's speed and its derivatives of order 1 to 3, by NumPy's polynomials."""
    w, w1, w2, w3 = (derivative(t) for derivative in SPEED_DERIVATIVES)
    return w, w1, w2, w3


def integrate(weights: Weights, t: float, method: str = "DOP853", still: bool = True) -> np.ndarray:
    """Filimonikhina 2017 (4) in the rotor frame by SciPy: angles, then rates."""
    n, d = weights.count, weights.damping_rate

    def slope(s: float, y: np.ndarray) -> np.ndarray:
        pull = -(derivative(0, s) * np.exp(-1j * y[:n])).imag
        lag = 0.0 if still else weights.spin_share * spin(s)[1]
        along = pull / (weights.kappa * weights.track_radius) - lag
        return np.concatenate([y[n:], along - d * y[n:]])

    y0 = np.array([*ANGLES, *SPEEDS])
    return solve_ivp(slope, (0.0, t), y0, method, rtol=1e-12, atol=1e-14).y[:, -1]


def in_substeps(weights: Weights, t: float, count: int) -> np.ndarray:
    state, h = list(zip(ANGLES, SPEEDS, strict=True)), t / count
    motions = [tuple(derivative(k, j * h) for k in range(3)) for j in range(count + 1)]
    for ends in pairwise(motions):
        drive = ends, (STEADY, STEADY), weights.lever, weights.damping_rate, h
        state = [substep(angle, rate, *drive) for angle, rate in state]
    return np.array(state).T.ravel()


def test_quintic_is_that_of_scipy_through_the_same_ends() -> None:
    step, start, end = 0.7, (1.0, -2.0, 3.0), (0.5, 4.0, -1.0)
    expected = BPoly.from_derivatives([0.0, step], [start, end])
    found = (*start, *quintic.hermite(start, end, step))
    for t in (0.0, 0.1, 0.5, step):
        values = [float(expected.derivative(k)(t)) if k else float(expected(t)) for k in range(3)]
        assert_allclose(quintic.at(found, t), values, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("drag", [0.0, 0.3, 0.8])
def test_substep_has_order_6(drag: float) -> None:
    weights, t = Weights(2, 0.1, 0.5, drag, KAPPA["balls"]), 1.2
    expected = integrate(weights, t)
    errors = [np.abs(in_substeps(weights, t, n) - expected).max() for n in (8, 12, 18)]
    orders = np.log(np.divide(errors[:-1], errors[1:])) / np.log(1.5)
    assert_allclose(orders, 6.0, atol=0.4)


@pytest.mark.parametrize("drag", [0.0, 1e-2, 1.0, 1e2, 1e4, 1e6])
def test_any_drag_is_integrated_in_one_step(drag: float) -> None:
    weights = Weights(2, 0.1, 1.0, drag, KAPPA["rollers"])
    expected = integrate(weights, 0.1, "Radau" if weights.damping_rate > 1e3 else "DOP853")
    angles, speeds = advance(weights, ANGLES, SPEEDS, SIGNAL, 0.0, 0.1)
    # the first instants of weights that heavy drag stops are no quintic
    within = 1e-9 if weights.damping_rate * 0.1 < 1.0 else 2e-6
    assert_allclose([*angles, *speeds], expected, rtol=0, atol=within)


def test_turns_behind_a_weight_change_nothing() -> None:
    weights = Weights(1, 0.1, 1.0, 0.1)
    turned = 2.0 * np.pi * 1e6
    near = advance(weights, [0.3], [0.2], SIGNAL, 0.0, 0.1)
    far = advance(weights, [0.3 + turned], [0.2], SIGNAL, 0.0, 0.1)
    assert far[0][0] - turned == pytest.approx(near[0][0], abs=1e-8)


def test_a_changing_speed_leaves_weights_behind_as_they_are_integrated() -> None:
    weights = Weights(2, 0.1, 0.5, 0.3, KAPPA["rollers"])
    angles, speeds = advance(weights, ANGLES, SPEEDS, SIGNAL, SPIN_UP, 0.1, RATES)
    assert_allclose([*angles, *speeds], integrate(weights, 0.1, still=False), atol=1e-9)


@pytest.mark.parametrize("still", [True, False])
def test_second_derivative_is_that_of_the_reaction_along_the_motion(still: bool) -> None:
    weights = Weights(2, 0.1, 0.5, 0.3, KAPPA["balls"])

    def driven(t: float) -> tuple[float, float, float, float]:
        return (SPEED, *STEADY) if still else spin(t)

    def slope_at(t: float) -> complex:
        angles, speeds = np.split(integrate(weights, t, still=still), 2)
        return reaction(
            weights, angles, speeds, derivative(0, t), derivative(1, t), *driven(t)[:3]
        )[1]

    h = 2e-3  # four points: order 4 from one side would do less
    around = [slope_at(0.1 + k * h) for k in (-2, -1, 1, 2)]
    expected = (around[0] - 8.0 * around[1] + 8.0 * around[2] - around[3]) / (12.0 * h)
    angles, speeds = np.split(integrate(weights, 0.1, still=still), 2)
    motion = derivative(0, 0.1), derivative(1, 0.1), derivative(2, 0.1)
    w, *spin_up = driven(0.1)
    found = reaction_second(weights, angles, speeds, motion, w, tuple(spin_up))
    assert found == pytest.approx(expected, rel=1e-7)


def test_input_that_is_not_finite_is_refused() -> None:
    weights = Weights(1, 0.1, 0.5)
    with pytest.raises(ArithmeticError, match="not finite"):
        advance(weights, [float("nan")], [0.0], SIGNAL, 0.0, 0.1)
    with pytest.raises(ArithmeticError, match="substeps"):
        advance(weights, [0.0], [1e9], SIGNAL, 0.0, 0.1)
