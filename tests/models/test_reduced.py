"""Filimonikhin 2011 (11), (12) against the linearised equations of every single weight."""

from __future__ import annotations

import numpy as np
import pytest

from autobalancer.models.assembly import Assembly, Mounted
from autobalancer.models.linear.linearised import linearise
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.weights import Weights, alignment
from tests.models.filimonikhin_reduced import reduced_eigenvalues, second_harmonic
from tests.papers import rodrigues_rotor

EQUAL = ((1.0, 1.0), (1.0, 1.0))
PAIR = (2 * np.pi / 3, 4 * np.pi / 3)  # two weights that balance one weight's moment
TRIPLE = (0.9, 2.6, 4.4)


def three_mass_shaft(unbalances=(), internal_damping=0.0):
    """The paper's section 6: supports at the outer discs, n = 3, p = 1, q = 3."""
    return LinearRotor.flexible(
        stations=(0.0, 0.4, 1.0),
        masses=(0.3, 0.4, 0.25),
        supports=(1, 3),
        support_stiffness=EQUAL,
        support_damping=((0.2, 0.2), (0.2, 0.2)),
        compliance=[[0.5]],
        internal_damping=internal_damping,
        unbalances=unbalances,
    )


def weights(count, kappa=1.0, drag=0.01):
    return Weights(count=count, mass=0.01, track_radius=1.0, drag=drag, kappa=kappa)


def two_pairs():
    rotor = three_mass_shaft([(0.0, 0.01, 0.0), (1.0, 0.01, 0.5)])
    turned = tuple(angle + 0.5 for angle in PAIR)
    return Assembly(
        rotor,
        (Mounted("left", weights(2), 0, PAIR), Mounted("right", weights(2, drag=0.02), 2, turned)),
    )


def three_balls():
    moment = -0.01 * np.exp(1j * np.array(TRIPLE)).sum()
    rotor = three_mass_shaft([(0.0, abs(moment), float(np.angle(moment)))], internal_damping=0.1)
    return Assembly(rotor, (Mounted("balls", weights(3, kappa=1.4), 0, TRIPLE),))


def gyroscopic_drum():
    rotor = rodrigues_rotor([(1.0, 0.01, 0.0), (5.0, 0.01, 0.0)])
    return Assembly(
        rotor,
        (Mounted("left", weights(2), 0, PAIR), Mounted("right", weights(2), 1, PAIR)),
    )


def accelerations(assembly, speed, state):
    """q'' in the rotor frame and theta'' of every weight, Filimonikhina 2017 (4), not linearised.

    `state` is (Re xi, Im xi, Re xi', Im xi', theta, theta'); solved for all unknowns at once.
    """
    rotor = assembly.rotor
    n = rotor.stations
    mounted = [(m, angle) for m in assembly.balancers for angle in m.angles]
    count = len(mounted)
    xi = state[:n] + 1j * state[n : 2 * n]
    rate = state[2 * n : 3 * n] + 1j * state[3 * n : 4 * n]
    theta, nu = state[4 * n : 4 * n + count], state[4 * n + count :]
    velocity = rate + 1j * speed * xi
    mass = rotor.mass.astype(complex)
    damping = rotor.damping_x + rotor.internal_damping - 1j * speed * rotor.gyroscopic
    stiffness = rotor.stiffness_x - 1j * speed * rotor.internal_damping
    force = speed**2 * rotor.unbalance - damping @ velocity - stiffness @ xi
    columns = np.zeros((n, count), complex)  # force per theta''
    rows = np.zeros((count, 2 * n))  # theta'' per acceleration
    drag = np.zeros(count)
    for k, (m, _) in enumerate(mounted):
        w, plane, turn = m.device, rotor.planes[m.plane], np.exp(1j * theta[k])
        mass = mass + w.mass * np.outer(plane, plane)
        moment = w.mass * w.track_radius * turn * plane
        force = force + moment * (speed + nu[k]) ** 2
        columns[:, k] = -1j * moment
        # -Im(a e^{-i theta}) = -(a_eta cos - a_xi sin)
        pull = np.concatenate([turn.imag * plane, -turn.real * plane])
        rows[k] = pull / (w.kappa * w.track_radius)
        drag[k] = w.damping_rate * nu[k]
    size = 2 * n + count
    system = np.zeros((size, size))
    system[: 2 * n, : 2 * n] = np.block([[mass.real, -mass.imag], [mass.imag, mass.real]])
    system[: 2 * n, 2 * n :] = -np.vstack([columns.real, columns.imag])
    system[2 * n :, : 2 * n] = -rows
    system[2 * n :, 2 * n :] = np.eye(count)
    solved = np.linalg.solve(system, np.concatenate([force.real, force.imag, -drag]))
    absolute = solved[:n] + 1j * solved[n : 2 * n]
    relative = absolute - 2j * speed * rate + speed**2 * xi
    return np.concatenate([state[2 * n : 4 * n], relative.real, relative.imag, nu, solved[2 * n :]])


def full_eigenvalues(assembly, speed):
    """Eigenvalues of the central-difference Jacobian at the main motion."""
    n = assembly.rotor.stations
    angles = np.concatenate([m.angles for m in assembly.balancers])
    start = np.concatenate([np.zeros(4 * n), angles, np.zeros(len(angles))])
    assert np.abs(accelerations(assembly, speed, start)).max() < 1e-12
    step = 1e-4
    columns = []
    for unit in np.eye(len(start)):
        # fourth order, so that the comparison is not one of difference errors
        near = accelerations(assembly, speed, start + step * unit) - accelerations(
            assembly, speed, start - step * unit
        )
        far = accelerations(assembly, speed, start + 2 * step * unit) - accelerations(
            assembly, speed, start - 2 * step * unit
        )
        columns.append((8.0 * near - far) / (12.0 * step))
    return np.linalg.eigvals(np.array(columns).T)


def unmatched(larger, smaller, tolerance):
    """What is left of `larger` when every eigenvalue of `smaller` has taken its nearest one."""
    rest = list(larger)
    for value in smaller:
        nearest = int(np.argmin(np.abs(np.array(rest) - value)))
        assert abs(rest[nearest] - value) < tolerance, value
        rest.pop(nearest)
    return np.array(rest)


@pytest.mark.parametrize("speed", [0.3, 1.1, 2.5, 6.0])
@pytest.mark.parametrize("scene", [two_pairs, gyroscopic_drum])
def test_two_weights_a_plane_have_the_eigenvalues_of_the_full_system(scene, speed):
    assembly = scene()
    reduced = reduced_eigenvalues(assembly, speed)
    full = full_eigenvalues(assembly, speed)
    assert len(full) == len(reduced)
    assert len(unmatched(full, reduced, 1e-7)) == 0


@pytest.mark.parametrize("speed", [0.4, 1.7, 3.0])
def test_third_weight_adds_only_a_neutral_pair_to_the_reduced_system(speed):
    assembly = three_balls()
    left = unmatched(full_eigenvalues(assembly, speed), reduced_eigenvalues(assembly, speed), 1e-7)
    d = assembly.weights[0].device.damping_rate
    assert sorted(left.real) == pytest.approx([-d, 0.0], abs=1e-7)


def test_single_weight_leaves_a_pair_of_the_reduced_system_unused():
    rotor = three_mass_shaft([(0.0, 0.01, 0.0)])
    assembly = Assembly(rotor, (Mounted("one", weights(1), 0, (np.pi,)),))
    left = unmatched(reduced_eigenvalues(assembly, 2.0), full_eigenvalues(assembly, 2.0), 1e-7)
    d = assembly.weights[0].device.damping_rate
    assert sorted(left.real) == pytest.approx([-d, 0.0], abs=1e-7)


def test_growth_rate_is_that_of_the_linearised_assembly():
    assembly = two_pairs()
    for speed in (0.5, 1.5, 3.0, 8.0):
        system = linearise(assembly)
        matrix = sum(speed**k * part for k, part in enumerate(system.steady))
        growth = np.linalg.eigvals(matrix).real.max()
        assert reduced_eigenvalues(assembly, speed)[0].real == pytest.approx(growth, abs=1e-9)


def test_second_harmonic_has_goncharovs_spread_for_modulus():
    assert abs(second_harmonic(TRIPLE)) == pytest.approx(alignment(TRIPLE))
    assert second_harmonic((0.3, 0.3 + np.pi)) == pytest.approx(np.exp(0.6j))


def test_anisotropic_supports_are_refused():
    rotor = LinearRotor.planar(1.0, (1.0, 2.0))
    assembly = Assembly(rotor, (Mounted("pair", weights(2), 0, (0.0, np.pi)),))
    with pytest.raises(ValueError, match="equal stiffness"):
        reduced_eigenvalues(assembly, 1.0)


def test_rotor_without_weights_is_refused():
    with pytest.raises(ValueError, match="no balancer with weights"):
        reduced_eigenvalues(Assembly(LinearRotor.planar(1.0, 1.0)), 1.0)


def test_weights_that_cannot_balance_are_refused():
    rotor = LinearRotor.planar(1.0, 1.0, unbalance=1.0)
    assembly = Assembly(rotor, (Mounted("pair", weights(2), 0, PAIR),))
    with pytest.raises(ValueError, match="unbalance"):
        reduced_eigenvalues(assembly, 1.0)
