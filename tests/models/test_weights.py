"""The weights' own integrator and their reaction on the rotor."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from autobalancer.models.steps.weights import advance, phi_functions, reaction
from autobalancer.models.weights import KAPPA, Weights, alignment, static_moment

SIGNAL = (1.0 + 0.5j, -1.0 + 2.0j, 3.0 - 1.0j, 2.0j)
ANGLES, SPEEDS = (0.3, 1.0), (0.2, -3.0)


def signal_at(t: float) -> tuple[complex, complex, complex, complex]:
    a0, a1, a2, a3 = SIGNAL
    return (
        a0 + t * (a1 + t * (a2 / 2 + t * a3 / 6)),
        a1 + t * (a2 + t * a3 / 2),
        a2 + t * a3,
        a3,
    )


def integrate(
    weights: Weights, spin_up: float, t: float, method: str, rtol: float = 1e-12
) -> tuple[np.ndarray, np.ndarray]:
    """Filimonikhina 2017 (4) in the rotor frame, corrected for rolling in a run-up, by SciPy."""
    n = weights.count
    gain = 1.0 / (weights.kappa * weights.track_radius)
    rate = weights.drag / (weights.kappa * weights.mass)
    lag = spin_up * (1.0 - (weights.kappa - 1.0) * weights.radius / weights.track_radius)
    lag /= weights.kappa

    def slope(s: float, y: np.ndarray) -> np.ndarray:
        pull = -gain * (signal_at(s)[0] * np.exp(-1j * y[:n])).imag
        return np.concatenate([y[n:], pull - lag - rate * y[n:]])

    y0 = np.concatenate([ANGLES, SPEEDS])
    y = solve_ivp(slope, (0.0, t), y0, method, rtol=rtol, atol=1e-14).y[:, -1]
    return y[:n], y[n:]


def in_steps(weights: Weights, spin_up: float, t: float, steps: int) -> np.ndarray:
    angles, speeds, h = list(ANGLES), list(SPEEDS), t / steps
    for k in range(steps):
        angles, speeds = advance(weights, angles, speeds, signal_at(k * h), spin_up, h)
    return np.array([*angles, *speeds])


@pytest.mark.parametrize("drag", [0.0, 0.3, 3.0])
@pytest.mark.parametrize("spin_up", [0.0, 2.0])
def test_advance_has_order_4(drag: float, spin_up: float) -> None:
    weights, t = Weights(2, 0.1, 0.5, drag, KAPPA["balls"], 0.1), 0.4
    expected = np.concatenate(integrate(weights, spin_up, t, "DOP853"))
    errors = [np.abs(in_steps(weights, spin_up, t, n) - expected).max() for n in (16, 32, 64)]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert_allclose(orders, 4.0, atol=0.25)
    assert errors[-1] < 2e-8


@pytest.mark.slow
@pytest.mark.parametrize("drag", [0.0, 1e-6, 1e-2, 1.0, 1e2, 1e4, 1e6, 1e8])
def test_any_drag_is_integrated_in_one_step(drag: float) -> None:
    weights = Weights(2, 0.1, 1.0, drag, KAPPA["rollers"])
    method = "Radau" if weights.damping_rate > 1e3 else "DOP853"
    angles, speeds = integrate(weights, 0.5, 0.1, method, 1e-10)
    found = advance(weights, ANGLES, SPEEDS, SIGNAL, 0.5, 0.1)
    assert_allclose(found[0], angles, rtol=0, atol=2e-6)
    assert_allclose(found[1], speeds, rtol=5e-6, atol=0)


@pytest.mark.parametrize("drag", [0.0, 1e-9, 1.0, 1e3, 1e8])
def test_without_a_field_the_rate_decays_as_the_closed_form(drag: float) -> None:
    weights, t = Weights(1, 0.1, 1.0, drag), 0.37
    d = weights.damping_rate
    angles, speeds = advance(weights, [0.2], [5.0], (0j, 0j, 0j, 0j), 0.0, t)
    assert_allclose(speeds[0], 5.0 * math.exp(-d * t), rtol=1e-13, atol=0)
    assert_allclose(angles[0], 0.2 + (-5.0 * math.expm1(-d * t) / d if d else 5.0 * t), rtol=1e-13)


@pytest.mark.parametrize("kind", KAPPA)
@pytest.mark.parametrize("radius", [0.0, 0.02, 0.3])
def test_a_track_that_spins_up_drives_what_rolls_as_newton_and_euler_have_it(kind, radius) -> None:
    """m R phi'' = f, (kappa - 1) m r^2 W' = r f, R phi' + r W = (R + r) w at the race."""
    m, R, kappa, spin_up = 0.1, 0.9, KAPPA[kind], 3.0
    r = radius or 1e-9
    rows = [[m * R, 0.0, -1.0], [0.0, (kappa - 1.0) * m * r, -1.0], [R, r, 0.0]]
    phi_2 = 0.0  # a pendulum hangs from the centre: nothing drives it
    if kind != "pendulums":
        phi_2 = np.linalg.solve(rows, [0.0, 0.0, (R + r) * spin_up])[0]
    weights = Weights(1, m, R, 0.0, kappa, radius)
    _, speeds = advance(weights, [0.2], [0.0], (0j, 0j, 0j, 0j), spin_up, 0.1)
    assert speeds[0] == pytest.approx((phi_2 - spin_up) * 0.1, rel=1e-7)


@pytest.mark.parametrize("z", [0.0, -1e-12, -1e-3, -0.999, -1.0, -1.001, -3.0, -40.0])
def test_phi_functions_are_those_of_the_exponential(z: float) -> None:
    companion = np.diag(np.ones(6), 1)
    companion[0, 0] = z
    expected = expm(companion)[0][:6]
    assert_allclose(phi_functions(z, 5), expected, rtol=2e-13, atol=0)


def test_phi_functions_of_a_huge_drag_are_their_limit() -> None:
    z = -1e9
    found = phi_functions(z, 5)
    assert found[0] == 0.0
    assert_allclose(found[1:], [-1 / z / math.factorial(k) for k in range(5)], rtol=1e-8)


@pytest.mark.parametrize("drag", [0.0, 0.3, 30.0])
def test_reaction_is_minus_the_second_derivative_of_the_static_moment(drag: float) -> None:
    weights, speed, spin_up = Weights(2, 0.1, 0.5, drag, KAPPA["balls"], 0.1), 3.0, 2.0
    h = 0.02 / max(20.0, weights.damping_rate)

    def moment(t: float) -> complex:
        """Static moment in fixed axes."""
        angles, _ = integrate(weights, spin_up, t, "DOP853", 1e-13) if t else (ANGLES, SPEEDS)
        return static_moment(weights, angles) * np.exp(1j * (speed * t + spin_up * t * t / 2))

    force, _ = reaction(weights, ANGLES, SPEEDS, SIGNAL[0], SIGNAL[1], speed, spin_up)
    values = [moment(k * h) for k in range(-3, 4)]
    second = np.dot([2, -27, 270, -490, 270, -27, 2], values) / (180 * h**2)
    assert_allclose(force, -second, rtol=1e-7)


@pytest.mark.parametrize("drag", [0.0, 0.3, 30.0])
def test_the_slope_of_the_reaction_is_its_derivative(drag: float) -> None:
    weights, speed, spin_up = Weights(2, 0.1, 0.5, drag, KAPPA["balls"], 0.1), 3.0, 2.0
    h = 0.02 / max(20.0, weights.damping_rate)

    def force(t: float) -> complex:
        angles, speeds = integrate(weights, spin_up, t, "DOP853", 1e-13) if t else (ANGLES, SPEEDS)
        a0, a1, _, _ = signal_at(t)
        w = speed + spin_up * t
        return reaction(weights, list(angles), list(speeds), a0, a1, w, spin_up)[0]

    _, slope = reaction(weights, ANGLES, SPEEDS, SIGNAL[0], SIGNAL[1], speed, spin_up)
    near = (force(h) - force(-h)) / (2 * h)
    far = (force(2 * h) - force(-2 * h)) / (4 * h)
    assert_allclose(slope, (4 * near - far) / 3, rtol=1e-7)


def test_balanced_weights_that_turn_with_the_rotor_pull_nothing() -> None:
    weights = Weights(3, 0.1, 0.5, 0.2)
    angles = [0.1 + k * 2 * math.pi / 3 for k in range(3)]
    force, slope = reaction(weights, angles, [0.0] * 3, 0j, 0j, 7.0, 0.0)
    assert abs(force) < 1e-14
    assert abs(slope) < 1e-13


def test_packed_weights_pull_with_their_centrifugal_force() -> None:
    weights = Weights(2, 0.1, 0.5, 0.2)
    force, _ = reaction(weights, [0.4, 0.4], [0.0, 0.0], 0j, 0j, 7.0, 0.0)
    assert_allclose(force, weights.point_capacity * 49.0 * np.exp(0.4j), rtol=1e-14)


def test_alignment_of_goncharov_2() -> None:
    assert alignment([0.3, 0.3 + math.pi]) == pytest.approx(1.0)
    assert alignment([0.3 + k * 2 * math.pi / 3 for k in range(3)]) == pytest.approx(0.0, abs=1e-15)
    assert alignment([0.0, math.pi / 2]) == pytest.approx(0.0, abs=1e-15)


def test_what_is_not_finite_or_endless_is_an_error(monkeypatch) -> None:
    weights = Weights(2, 0.1, 0.5)
    for bad in (math.nan, math.inf):
        with pytest.raises(ArithmeticError):
            advance(weights, [0.0, 1.0], [0.0, 0.0], (bad, 0j, 0j, 0j), 0.0, 0.1)
        with pytest.raises(ArithmeticError):
            advance(weights, [0.0, bad], [0.0, 0.0], (1.0, 0j, 0j, 0j), 0.0, 0.1)
        with pytest.raises(ArithmeticError):
            advance(weights, [0.0, 1.0], [0.0, bad], (1.0, 0j, 0j, 0j), 0.0, 0.1)
        with pytest.raises(ArithmeticError):
            advance(weights, [0.0, 1.0], [0.0, 0.0], (1.0, 0j, 0j, 0j), bad, 0.1)
    # refused before the first of them is computed
    monkeypatch.setattr("autobalancer.models.steps.weights.substep", None)
    with pytest.raises(ArithmeticError, match="substeps"):
        advance(weights, [0.0, 1.0], [0.0, 1e12], (1.0, 0j, 0j, 0j), 0.0, 0.1)
