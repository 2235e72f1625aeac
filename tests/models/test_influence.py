"""Influence coefficients and trial runs of Polushkin 2016."""

from __future__ import annotations

import numpy as np
import pytest

from autobalancer.models.linear.modes import critical_speeds
from autobalancer.models.papers.influence import (
    from_trial_runs,
    influence,
    scalar_coefficients,
    unbalance_from_response,
)
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.rotor_kinds import line_rows
from tests.papers import inverse_dynamic_stiffness, left_plane, right_plane

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


def test_either_closed_form_gives_any_plane():
    """The paper's remark: (17) with C = l - A is (15) with A, overhung planes too."""
    inverse = inverse_dynamic_stiffness(MASS, INERTIA, SPAN, (2e5, 3e5), (150.0, 90.0), 260.0)
    for distance in (-0.2, 0.0, LEFT, 1.1):
        np.testing.assert_allclose(
            left_plane(inverse, SPAN, 260.0, distance),
            right_plane(inverse, SPAN, 260.0, SPAN - distance),
            rtol=1e-12,
        )


def test_planes_can_be_asked_for_by_position():
    rotor = machine()
    np.testing.assert_array_equal(
        influence(rotor, 200.0, line_rows([LEFT, SPAN - RIGHT], SPAN)), influence(rotor, 200.0)
    )


def test_coefficients_are_the_vibration_after_the_transient():
    """Fixed-step integration of the equations of motion, gyroscopic and anisotropic."""
    rotor, speed = machine(polar_inertia=0.3, damping=np.multiply(DAMPING, 20)), 260.0
    mass, damping, stiffness = rotor.coefficients(speed)
    pull = speed**2 * rotor.planes[1]
    inverse = np.linalg.inv(mass)

    def slope(t, state):
        force = np.concatenate([pull * np.cos(speed * t), pull * np.sin(speed * t)])
        q, v = state
        return np.array([v, inverse @ (force - damping @ v - stiffness @ q)])

    steps_per_turn, turns = 400, 60
    h = 2 * np.pi / speed / steps_per_turn
    state, last = np.zeros((2, 4)), []
    for i in range(steps_per_turn * turns):
        t = i * h
        a = slope(t, state)
        b = slope(t + h / 2, state + h / 2 * a)
        c = slope(t + h / 2, state + h / 2 * b)
        d = slope(t + h, state + h * c)
        state = state + h / 6 * (a + 2 * b + 2 * c + d)
        if i >= steps_per_turn * (turns - 1):
            last.append(state[0] * np.exp(-1j * speed * (t + h)))
    phasor = 2.0 * np.mean(last, axis=0).reshape(2, 2)
    np.testing.assert_allclose(phasor, influence(rotor, speed)[:, :, 1], rtol=1e-6)


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
    first = k @ UNBALANCE
    runs = np.array([k @ (UNBALANCE + TRIALS * plane) for plane in np.eye(2)])
    found = from_trial_runs(first, runs, TRIALS)
    np.testing.assert_allclose(found, k, rtol=1e-9)
    np.testing.assert_allclose(unbalance_from_response(found, first), UNBALANCE, rtol=1e-9)


def test_more_sensors_than_planes_are_used_by_least_squares():
    both_axes = influence(machine(), 260.0).reshape(4, 2)
    found = unbalance_from_response(both_axes, both_axes @ UNBALANCE)
    np.testing.assert_allclose(found, UNBALANCE, rtol=1e-10)


def test_scalar_coefficients_are_one_phase_for_all():
    k = influence(machine(), 178.0)[0]
    used = scalar_coefficients(k, lag=-0.3)
    np.testing.assert_allclose(np.angle(used), -0.3)
    np.testing.assert_allclose(np.abs(used), np.abs(k))


def test_wrong_trials_are_refused():
    first, runs = np.zeros(2), np.ones((2, 2))
    with pytest.raises(ValueError, match="none may be zero"):
        from_trial_runs(first, runs, np.array([1.0, 0.0]))
    with pytest.raises(ValueError, match=r"shape \(2, 2\): must be \(1, 2\)"):
        from_trial_runs(first, runs, np.array([1.0]))


def test_two_planes_at_one_place_cannot_be_told_apart():
    k = influence(machine(planes=(0.2, 0.2)), 178.0)[0]
    with pytest.raises(ValueError, match="rank 1 for 2 planes"):
        unbalance_from_response(k, k @ UNBALANCE)
