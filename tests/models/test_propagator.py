"""The exact step of the rotor against closed forms and independent integration."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import expm

from autobalancer.models.rotor import LinearRotor
from autobalancer.models.steps.propagator import exponential, step_matrix


def oscillator(frequency: float, ratio: float, t: float) -> np.ndarray:
    """e^{At} of x'' + 2 ratio frequency x' + frequency^2 x = 0, every case of damping."""
    if ratio > 1.0:
        fast = -frequency * (ratio + np.sqrt(ratio**2 - 1.0))
        slow = frequency**2 / fast  # not the difference, which cancels
        e1, e2, gap = np.exp(slow * t), np.exp(fast * t), slow - fast
        return np.array(
            [
                [(slow * e2 - fast * e1) / gap, (e1 - e2) / gap],
                [frequency**2 * (e2 - e1) / gap, (slow * e1 - fast * e2) / gap],
            ]
        )
    s, decay = frequency * np.sqrt(1.0 - ratio**2), np.exp(-ratio * frequency * t)
    cos, sin_over = (np.cos(s * t), np.sin(s * t) / s) if s else (1.0, t)
    drag = ratio * frequency * sin_over
    return decay * np.array([[cos + drag, sin_over], [-(frequency**2) * sin_over, cos - drag]])


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("size", [1, 4, 9])
@pytest.mark.parametrize("scale", [1e-6, 0.3, 5.0])
def test_exponential_agrees_with_scipy(seed: int, size: int, scale: float) -> None:
    random = np.random.default_rng(seed)
    matrix = scale * (random.normal(size=(size, size)) + 1j * random.normal(size=(size, size)))
    expected = expm(matrix)
    assert_allclose(exponential(matrix), expected, rtol=0, atol=1e-13 * np.abs(expected).max())


@pytest.mark.parametrize("ratio", [0.0, 1e-3, 0.5, 1.0, 10.0, 1e4])
@pytest.mark.parametrize("frequency", [1e-3, 1.0, 50.0])
def test_exponential_of_an_oscillator_is_the_closed_form(frequency: float, ratio: float) -> None:
    t = 0.3
    matrix = t * np.array([[0.0, 1.0], [-(frequency**2), -2.0 * ratio * frequency]])
    unit = np.array([[1.0, 1.0 / frequency], [frequency, 1.0]])  # displacement and velocity alike
    found = exponential(matrix) / unit
    assert_allclose(found, oscillator(frequency, ratio, t) / unit, rtol=0, atol=1e-14)


def test_a_soft_axis_keeps_its_digits_beside_1e14() -> None:
    for stiff in (1e8, 1e14):
        block = np.zeros((4, 4))
        block[0, 1] = block[2, 3] = 0.3
        block[1, :2] = -0.3, -0.3 * 0.02
        block[3, 2:] = -0.3 * stiff, 0.0
        soft = exponential(block)[:2, :2]
        assert_allclose(soft, oscillator(1.0, 0.01, 0.3), rtol=0, atol=4.5e-16)
        # undamped, so only the phase 0.3 * sqrt(stiff) can lose digits
        fast = exponential(block)[2:, 2:]
        assert_allclose(np.linalg.det(fast), 1.0, rtol=0, atol=1e-8)


def test_exponential_refuses_what_is_not_finite() -> None:
    with pytest.raises(OverflowError, match="not finite"):
        exponential(np.array([[np.inf]]))
    with pytest.raises(OverflowError, match="not finite"):
        exponential(np.array([[np.nan]]))


@pytest.mark.parametrize("damping", [1e3, 2e7, 1e8])
def test_a_stiff_damped_support_keeps_the_digits_of_acceleration_and_jerk(damping: float) -> None:
    # the fast part is gone after the step: the closed steady motion under the unbalance remains
    mass, w, u, k = 0.8, 3.0, 0.025, 1e12
    rotor = LinearRotor.planar(mass, [1.0, k], [0.5, damping], 0.0, u)
    start = np.zeros(14)
    start[-2] = 1.0
    h = 2 * np.pi / w / 20
    _, a_y, _, j_y = (step_matrix(rotor, w, h) @ start)[4:]
    steady = u * w**2 / (k - mass * w**2 + 1j * damping * w) * np.exp(1j * w * h)
    # y follows Im of the unbalance e^{i w t}
    fast = damping / (2 * mass) * h
    assert fast > 50
    assert_allclose(a_y, (-(w**2) * steady).imag, rtol=1e-6)
    assert_allclose(j_y, (-1j * w**3 * steady).imag, rtol=1e-6)


def test_ten_thousand_undamped_revolutions_keep_the_energy() -> None:
    rotor = LinearRotor.planar(1.0, [1.0, 49.0])
    step = step_matrix(rotor, 3.0, 2 * np.pi / 3.0 / 20)[:4, :4]
    state = np.array([0.1, 0.02, 0.3, -0.5])
    energy = np.array([1.0, 49.0, 1.0, 1.0])
    first = energy @ state**2
    for _ in range(13):  # 2^13 revolutions of 20 steps
        step = step @ step
    found = np.linalg.matrix_power(step, 24) @ state
    assert_allclose(energy @ found**2, first, rtol=1e-9)
