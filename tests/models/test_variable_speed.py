"""The rotor's step at changing speed: order, the w' terms, and stiff supports."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from autobalancer.models.rotor import LinearRotor
from autobalancer.models.steps.variable_speed import Drive, VariableSpeedStep

pytestmark = pytest.mark.slow

FORCE = np.array([[0.3 + 0.1j], [-0.2 + 0.4j], [0.5 - 0.1j], [0.2 + 1.0j]])
ANGLE, SPEED = 0.7, 2.0


def rotor_of(*, isotropic: bool) -> LinearRotor:
    stiffness, damping = (4.0, 0.1) if isotropic else ([4.0, 9.0], [0.1, 0.2])
    return LinearRotor.planar(1.2, stiffness, damping, 0.3, 0.25, 0.4)


def shifted(t: float) -> np.ndarray:
    """Value and derivatives of the force's cubic at t."""
    f0, f1, f2, f3 = FORCE
    return np.array(
        [f0 + t * (f1 + t * (f2 / 2 + t * f3 / 6)), f1 + t * (f2 + t * f3 / 2), f2 + t * f3, f3]
    )


def slope(rotor: LinearRotor, spin_up: float, t: float, y: np.ndarray) -> list[float]:
    """Dubovik 2006 (5), written out per axis, with a force in the rotor frame."""
    x, yy, v_x, v_y = y
    beta, w = ANGLE + SPEED * t + spin_up * t * t / 2, SPEED + spin_up * t
    s, g = abs(rotor.unbalance[0]), beta + np.angle(rotor.unbalance[0])
    p, m = rotor.internal_damping[0, 0], rotor.mass[0, 0]
    force = shifted(t)[0, 0] * np.exp(1j * beta)
    f_x = s * (w**2 * np.cos(g) + spin_up * np.sin(g)) + force.real
    f_y = s * (w**2 * np.sin(g) - spin_up * np.cos(g)) + force.imag
    f_x -= (p + rotor.damping_x[0, 0]) * v_x + rotor.stiffness_x[0, 0] * x + p * yy * w
    f_y -= (p + rotor.damping_y[0, 0]) * v_y + rotor.stiffness_y[0, 0] * yy - p * x * w
    return [v_x, v_y, f_x / m, f_y / m]


def run(
    rotor: LinearRotor, state: np.ndarray, spin_up: float, t: float, steps: int, parts: int = 0
) -> np.ndarray:
    """State (x, y, vx, vy) after `steps` steps, each of `parts` parts or of as many as it needs."""
    stepper, h = VariableSpeedStep(rotor), t / steps
    y = state[[0, 2]] + 1j * state[[1, 3]] if rotor.isotropic else state
    for k in range(steps):
        s = k * h
        angle = ANGLE + SPEED * s + spin_up * s * s / 2
        drive = Drive(shifted(s), angle, SPEED + spin_up * s, spin_up)
        y = stepper.parts(y, drive, h, parts) if parts else stepper.advance(y, drive, h)
    return np.array([y[0].real, y[0].imag, y[1].real, y[1].imag]) if rotor.isotropic else y


@pytest.mark.parametrize("isotropic", [True, False])
@pytest.mark.parametrize("spin_up", [1.5, -4.0])
def test_its_parts_have_order_5_and_every_term_of_dubovik_5(
    isotropic: bool, spin_up: float
) -> None:
    rotor, state, t = rotor_of(isotropic=isotropic), np.array([0.1, -0.2, 0.3, 0.1]), 0.4
    expected = solve_ivp(
        lambda s, y: slope(rotor, spin_up, s, y), (0, t), state, "DOP853", rtol=1e-13, atol=1e-15
    ).y[:, -1]
    errors = [np.abs(run(rotor, state, spin_up, t, 2, n) - expected).max() for n in (2, 4, 8)]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert_allclose(orders, 5.0, atol=0.15)
    assert errors[-1] < 1e-8


@pytest.mark.parametrize("isotropic", [True, False])
def test_plane_motion_gives_acceleration_and_its_exact_slope(isotropic: bool) -> None:
    rotor, spin_up, d = rotor_of(isotropic=isotropic), 1.5, 1e-4
    state = np.array([0.1, -0.2, 0.3, 0.1])
    here = np.array(slope(rotor, spin_up, 0.0, state))
    after = solve_ivp(
        lambda s, y: slope(rotor, spin_up, s, y), (0, d), state, "DOP853", rtol=1e-13, atol=1e-15
    ).y[:, -1]
    before = solve_ivp(
        lambda s, y: slope(rotor, spin_up, s, y), (0, -d), state, "DOP853", rtol=1e-13, atol=1e-15
    ).y[:, -1]
    later, earlier = slope(rotor, spin_up, d, after), slope(rotor, spin_up, -d, before)
    jerk = (np.array(later) - np.array(earlier))[2:] / (2 * d)
    y = state[[0, 2]] + 1j * state[[1, 3]] if isotropic else state
    stepper = VariableSpeedStep(rotor)
    found = stepper.plane_motion(y, Drive(FORCE, ANGLE, SPEED, spin_up))
    if isotropic:
        found = tuple(np.array([value[0].real, value[0].imag]) for value in found)
    assert_allclose(found[0], here[2:], rtol=1e-13)
    assert_allclose(found[1], jerk, rtol=1e-6)


def test_a_stiff_support_sets_no_step_limit() -> None:
    rotor = LinearRotor.planar(1.0, [4.0, 1e14], [0.1, 10.0], 0.0, 0.25)
    soft = LinearRotor.planar(1.0, [4.0, 4.0], [0.1, 0.1], 0.0, 0.25)
    state = np.array([0.1, 0.0, 0.3, 0.0])
    found, expected = run(rotor, state, 1.5, 2.0, 64), run(soft, state, 1.5, 2.0, 64)
    # the axes do not couple, so the soft axis must not notice; the stiff one follows the force
    assert_allclose(found[[0, 2]], expected[[0, 2]], rtol=1e-12)
    beta, w = ANGLE + SPEED * 2 + 1.5 * 2, SPEED + 1.5 * 2
    force = 0.25 * (w**2 * np.sin(beta) - 1.5 * np.cos(beta))
    force += (shifted(2.0)[0, 0] * np.exp(1j * beta)).imag
    assert_allclose(found[1], force / 1e14, rtol=1e-4)


def test_a_free_vibration_faster_than_the_step_lives_on() -> None:
    """Undamped at 60 rad a step: an L-stable step alone would end it at once."""
    rotor = LinearRotor.planar(1.0, [1e6, 2e6], [0.0, 0.0], 0.0, 1e-3)
    state, spin_up, t = np.array([1e-3, -2e-3, 0.0, 0.0]), 10.0, 0.12
    expected = solve_ivp(
        lambda s, y: slope(rotor, spin_up, s, y), (0, t), state, "DOP853", rtol=1e-12, atol=1e-15
    ).y[:, -1]
    assert_allclose(run(rotor, state, spin_up, t, 2)[:2], expected[:2], rtol=0, atol=1e-11)


def test_a_vibration_too_fast_for_its_parts_is_refused() -> None:
    rotor = LinearRotor.planar(1.0, [1e14, 1e14], [0.0, 1.0], 0.0, 1e-3)
    with pytest.raises(ArithmeticError, match="use smaller communication steps"):
        run(rotor, np.array([1e-3, 0.0, 0.0, 0.0]), 10.0, 1.0, 4)
