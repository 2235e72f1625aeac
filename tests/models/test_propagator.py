"""The exact step of the rotor against closed forms and independent integration."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from autobalancer.models.liquid import Liquid
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.steps.propagator import exponential, generator, step_matrix

FORCE = np.array([0.3 + 0.1j, -0.2 + 0.4j, 0.5 - 0.1j, 0.2 + 1.0j])


def two_stations(*, isotropic: bool) -> LinearRotor:
    """Two coupled stations, three planes, gyroscopic and internal damping: every term present."""
    stiffness = np.array([[9.0, -2.0], [-2.0, 7.0]])
    damping = np.array([[0.5, 0.1], [0.1, 0.3]])
    return LinearRotor(
        mass=np.array([[1.2, 0.2], [0.2, 0.9]]),
        damping_x=damping,
        damping_y=damping if isotropic else 2.0 * damping,
        stiffness_x=stiffness,
        stiffness_y=stiffness if isotropic else stiffness + np.diag([3.0, 5.0]),
        internal_damping=np.array([[0.2, -0.1], [-0.1, 0.4]]),
        gyroscopic=np.array([[0.3, -0.1], [-0.1, 0.2]]),
        planes=np.array([[1.0, 0.0], [0.4, 0.6], [-0.2, 1.2]]),
        unbalance=np.array([0.02 + 0.01j, -0.03j]),
        deflection=np.eye(2),
    )


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
        assert_allclose(soft, oscillator(1.0, 0.01, 0.3), rtol=0, atol=2e-16)
        # undamped, so only the phase 0.3 * sqrt(stiff) can lose digits
        fast = exponential(block)[2:, 2:]
        assert_allclose(np.linalg.det(fast), 1.0, rtol=0, atol=1e-8)


def test_exponential_refuses_what_is_not_finite() -> None:
    with pytest.raises(OverflowError, match="not finite"):
        exponential(np.array([[np.inf]]))
    with pytest.raises(OverflowError, match="not finite"):
        exponential(np.array([[np.nan]]))


def as_real(values: np.ndarray) -> np.ndarray:
    return np.concatenate([values.real, values.imag])


def start_vector(rotor: LinearRotor, q: np.ndarray, v: np.ndarray, angle: float) -> np.ndarray:
    """(q, v, f_0..f_3, e) with the same FORCE, times its number, on every plane."""
    turn = np.exp(1j * angle)
    forces = [turn * f * np.arange(1, rotor.plane_count + 1) for f in FORCE]
    blocks = [q, v, *forces, np.array([turn])]
    return np.concatenate(blocks if rotor.isotropic else [as_real(b) for b in blocks])


def integrate(
    rotor: LinearRotor, speed: float, q: np.ndarray, v: np.ndarray, angle: float, t: float
) -> np.ndarray:
    """(q, v) at t from the second-order equations written out per axis."""
    n = rotor.stations
    inverse = np.linalg.inv(rotor.mass)
    inner, gyro = rotor.internal_damping, speed * rotor.gyroscopic
    number = np.arange(1, rotor.plane_count + 1)

    def slope(s: float, y: np.ndarray) -> np.ndarray:
        x, yy, v_x, v_y = y.reshape(4, n)
        turn = np.exp(1j * (angle + speed * s))
        force = FORCE[0] + s * FORCE[1] + s**2 / 2 * FORCE[2] + s**3 / 6 * FORCE[3]
        pull = rotor.planes.T @ (number * force * turn) + rotor.unbalance * speed**2 * turn
        f_x = pull.real - (rotor.damping_x + inner) @ v_x - gyro @ v_y
        f_y = pull.imag - (rotor.damping_y + inner) @ v_y + gyro @ v_x
        f_x -= rotor.stiffness_x @ x + speed * inner @ yy
        f_y -= rotor.stiffness_y @ yy - speed * inner @ x
        return np.concatenate([v_x, v_y, inverse @ f_x, inverse @ f_y])

    y0 = np.concatenate([as_real(q), as_real(v)])
    return solve_ivp(slope, (0.0, t), y0, "DOP853", rtol=1e-13, atol=1e-15).y[:, -1]


@pytest.mark.parametrize("isotropic", [True, False])
@pytest.mark.parametrize("speed", [0.0, 1.7])
def test_one_step_is_exact_whatever_its_length(isotropic: bool, speed: float) -> None:
    rotor = two_stations(isotropic=isotropic)
    q, v = np.array([0.1 + 0.2j, -0.3j]), np.array([0.5, -0.2 + 0.4j])
    for t in (0.05, 0.7, 6.0):
        found = step_matrix(rotor, speed, t) @ start_vector(rotor, q, v, 0.6)
        state = found[: 4 if isotropic else 8]
        found_real = np.concatenate([as_real(state[:2]), as_real(state[2:])])
        expected = integrate(rotor, speed, q, v, 0.6, t)
        actual = found_real if isotropic else state
        assert_allclose(actual, expected, rtol=0, atol=1e-11 * np.abs(expected).max())


def test_complex_and_real_form_are_the_same_rotor() -> None:
    rotor = two_stations(isotropic=True)
    # one rounding apart in stiffness: alike in every digit that counts, but not by comparison
    almost = replace(rotor, stiffness_y=np.nextafter(rotor.stiffness_y, 100.0))
    assert not almost.isotropic
    q, v = np.array([0.1 + 0.2j, -0.3j]), np.array([0.5, -0.2 + 0.4j])
    short = step_matrix(rotor, 1.7, 0.4) @ start_vector(rotor, q, v, 0.6)
    long = step_matrix(almost, 1.7, 0.4) @ start_vector(almost, q, v, 0.6)
    blocks = np.split(short, [2, 4, 7])  # q, v, a and j of three planes
    assert_allclose(long, np.concatenate([as_real(b) for b in blocks]), rtol=0, atol=1e-13)


@pytest.mark.parametrize("isotropic", [True, False])
def test_two_half_steps_are_one(isotropic: bool) -> None:
    rotor, speed, h = two_stations(isotropic=isotropic), 1.7, 0.4
    start = start_vector(rotor, np.array([0.1j, 0.2]), np.array([0.3, -0.1j]), 0.2)
    half = exponential(generator(rotor, speed) * h / 2)
    twice = step_matrix(rotor, speed, h / 2) @ (half @ start)
    assert_allclose(twice, step_matrix(rotor, speed, h) @ start, rtol=0, atol=1e-13)


@pytest.mark.parametrize("isotropic", [True, False])
def test_acceleration_and_jerk_are_the_derivatives_of_the_planes_motion(isotropic: bool) -> None:
    rotor, speed, t, d = two_stations(isotropic=isotropic), 1.7, 0.4, 1e-3
    start = start_vector(rotor, np.array([0.1j, 0.2]), np.array([0.3, -0.1j]), 0.2)
    size = 2 if isotropic else 4
    planes = np.kron(np.eye(size // 2), rotor.planes)

    def at(time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        found = step_matrix(rotor, speed, time) @ start
        velocity = planes @ found[size : 2 * size]
        acceleration, jerk = np.split(found[2 * size :], 2)
        return velocity, acceleration, jerk

    earlier, now, later = at(t - d), at(t), at(t + d)
    assert_allclose(now[1], (later[0] - earlier[0]) / (2 * d), atol=3e-5)
    assert_allclose(now[2], (later[1] - earlier[1]) / (2 * d), atol=3e-5)
    before, after = at(t - d / 2), at(t + d / 2)
    # Richardson of two central differences: fourth order
    rich = (4 * (after[1] - before[1]) / d - (later[1] - earlier[1]) / (2 * d)) / 3
    assert_allclose(now[2], rich, atol=1e-9)


def test_a_step_of_no_length_evaluates_the_equations() -> None:
    rotor = LinearRotor.planar(2.0, [3.0, 5.0], [0.1, 0.2], 0.3, 0.5)
    start = start_vector(rotor, np.array([0.1 + 0.2j]), np.array([0.3 - 0.4j]), 0.0)
    a = step_matrix(rotor, 1.5, 0.0)[4:6] @ start
    expected_x = 0.3 + 0.5 * 1.5**2 - (0.1 + 0.3) * 0.3 - 3.0 * 0.1 - 1.5 * 0.3 * 0.2
    expected_y = 0.1 - (0.2 + 0.3) * -0.4 - 5.0 * 0.2 + 1.5 * 0.3 * 0.1
    assert_allclose(a, [expected_x / 2.0, expected_y / 2.0], rtol=1e-14)


def test_undamped_resonance_grows_as_the_closed_form() -> None:
    mass, w, u = 2.0, 3.0, 0.01
    rotor = LinearRotor.planar(mass, mass * w**2, 0.0, 0.0, u)
    start = np.zeros(7, complex)
    start[-1] = 1.0
    for t in (0.1, 1.0, 100.0):
        expected = u * w / (2j * mass) * (t * np.exp(1j * w * t) - np.sin(w * t) / w)
        assert_allclose((step_matrix(rotor, w, t) @ start)[0], expected, rtol=1e-12)


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


@pytest.mark.parametrize("damping_ratio", [0.0, 1.0])
def test_at_standstill_a_constant_force_moves_the_rotor_as_a_textbook_oscillator(
    damping_ratio: float,
) -> None:
    mass, omega, f = 1.5, 4.0, 0.7
    rotor = LinearRotor.planar(mass, mass * omega**2, 2 * damping_ratio * omega * mass)
    start = np.zeros(7, complex)
    start[2] = f
    for t in (0.2, 3.0):
        rest = np.cos(omega * t) if damping_ratio == 0 else np.exp(-omega * t) * (1 + omega * t)
        expected = f / (mass * omega**2) * (1.0 - rest)
        assert_allclose((step_matrix(rotor, 0.0, t) @ start)[0], expected, atol=1e-15)


@pytest.mark.parametrize("internal", [0.0, 30.0])
@pytest.mark.parametrize("speed", [5.0, 20.0, 31.6, 80.0])
def test_the_steady_bending_is_dubovik_6(speed: float, internal: float) -> None:
    m1, c, chi, e = 2.0, 2000.0, 15.0, 1e-3
    liquid = Liquid(0.05, 0.04, 0.1, 1000.0)
    rotor = LinearRotor.planar(m1, c, chi, internal, m1 * e).with_added_mass([liquid.added_mass])
    h = 0.01
    step = step_matrix(rotor, speed, h)[:2]
    turning = np.exp(1j * speed * h)
    # the motion that one step only turns
    found = np.linalg.solve(turning * np.eye(2) - step[:, :2], step[:, -1])[0]
    m = m1 + liquid.added_mass
    bending = m1 * e * speed**2 / np.hypot(c - m * speed**2, chi * speed)
    gamma = np.arctan2(-chi * speed, c - m * speed**2)
    assert_allclose(abs(found), bending, rtol=1e-11)
    assert_allclose(np.angle(found), gamma, atol=1e-11)


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
