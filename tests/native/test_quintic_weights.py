"""Point weights under a quintic signal: order 6, any drag, and the force's second derivative."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from autobalancer.models.weights import KAPPA, Weights
from tests.native.equations import STEADY, quintic_advance

pytestmark = pytest.mark.slow

SIGNAL = (1.0 + 0.5j, -1.0 + 2.0j, 3.0 - 1.0j, 2.0j, -4.0 + 1.0j, 5.0 - 2.0j)
ANGLES, SPEEDS = (0.3, 1.0), (0.2, -3.0)
SPEED = 3.0
SPIN_UP, RATES = 2.0, (-3.0, 4.0, 5.0)  # w' [rad/s^2] and its derivatives
STILL = (0.0, *STEADY)


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


def in_steps(core, weights: Weights, t: float, count: int) -> np.ndarray:
    """The same by steps in each of which a weight moves so little that it is not divided."""
    state, h = (ANGLES, SPEEDS), t / count
    for j in range(count):
        signal = [derivative(k, j * h) for k in range(6)]
        state = quintic_advance(core, weights, *state, signal, STILL, h)
    return np.array(state).ravel()


@pytest.mark.parametrize("drag", [0.0, 0.3, 0.8])
def test_step_has_order_6(core, drag: float) -> None:
    weights, t = Weights(2, 0.1, 0.5, drag, KAPPA["balls"]), 1.2
    fine = in_steps(core, weights, t, 400)
    assert_allclose(fine, integrate(weights, t), atol=3e-12)
    errors = [np.abs(in_steps(core, weights, t, n) - fine).max() for n in (54, 81)]
    assert np.log(errors[0] / errors[1]) / np.log(1.5) == pytest.approx(6.0, abs=0.3)


def test_a_changing_speed_leaves_weights_behind_as_they_are_integrated(core) -> None:
    weights = Weights(2, 0.1, 0.5, 0.3, KAPPA["rollers"])
    angles, speeds = quintic_advance(core, weights, ANGLES, SPEEDS, SIGNAL, (SPIN_UP, *RATES), 0.1)
    assert_allclose([*angles, *speeds], integrate(weights, 0.1, still=False), atol=1e-9)


@pytest.mark.parametrize("still", [True, False])
def test_second_derivative_is_that_of_the_reaction_along_the_motion(
    core, track_of, still: bool
) -> None:
    weights = Weights(2, 0.1, 0.5, 0.3, KAPPA["balls"])

    def driven(t: float) -> tuple[float, float, float, float]:
        return (SPEED, *STEADY) if still else spin(t)

    def slope_at(t: float) -> complex:
        angles, speeds = np.split(integrate(weights, t, still=still), 2)
        motion, none = (derivative(0, t), derivative(1, t)), [0.0, 0.0]
        return track_of(weights).reaction(angles, speeds, none, *motion, *driven(t)[:3])[1]

    h = 2e-3  # four points: order 4 from one side would do less
    around = [slope_at(0.1 + k * h) for k in (-2, -1, 1, 2)]
    expected = (around[0] - 8.0 * around[1] + 8.0 * around[2] - around[3]) / (12.0 * h)
    angles, speeds = np.split(integrate(weights, 0.1, still=still), 2)
    motion, second = (derivative(0, 0.1), derivative(1, 0.1)), derivative(2, 0.1)
    track = track_of(weights)
    found = track.reaction(angles, speeds, [0.0, 0.0], *motion, *driven(0.1), second=second)
    assert found[2] == pytest.approx(expected, rel=1e-7)


def test_input_that_is_not_finite_is_refused(core) -> None:
    weights = Weights(1, 0.1, 0.5)
    for angle, speed, words in (
        (float("nan"), 0.0, "the weights' angles [nan] are not finite"),
        (0.0, 1e9, "the weights would need "),
    ):
        given = core, weights, [angle], [speed], SIGNAL, STILL, 0.1
        assert core.refusal(quintic_advance, *given).startswith(words)
