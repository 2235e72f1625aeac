"""Stability of the main motion by the weights' static moments instead of their angles.

Filimonikhin 2011 (11), (12), with dimensions.  Near a main motion, in the rotor frame with
D = d/dt + i w, an isotropic rotor (displacements xi) and the moment s_j [kg m] that the weights of
balancer j have gained obey

    M D^2 xi + (C + C_i - i w G) D xi + (K - i w C_i) xi + sum_j S_j^T D^2 s_j = 0
    s_j'' + d_j s_j' = -(m_j N_j / (2 kappa_j)) (a_j - conj(a_j) b_j e^{i th_j}),   a_j = S_j D^2 xi

with b_j e^{i th_j} the mean of e^{2 i theta} over the weights' angles theta: any number of weights
counts as two complex variables.  The paper's numbers are d_j/omega_0 for its h_j,
m_j N_j/(2 kappa_j M_sum) for its m_j and 1/omega_0 as the unit of time.

Against the full system, N >= 3 weights lack N - 2 pairs of eigenvalues 0 and -d (positions that
leave s alone); weights on one diameter (b = 1; N = 1, or two opposite or together) have one such
pair too many, since s can then move along that diameter only on paper.
"""

from __future__ import annotations

import cmath
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from autobalancer.models.assembly import Assembly
from autobalancer.models.linear.balanced import balanced_angles
from autobalancer.models.rotor import LinearRotor
from autobalancer.models.weights import Weights


def second_harmonic(angles: Sequence[float] | NDArray) -> complex:
    """b e^{i th} = mean of e^{2 i theta}; its modulus is Goncharov's p."""
    return sum(cmath.rect(1.0, 2.0 * angle) for angle in angles) / len(angles)


def reduced_matrix(assembly: Assembly, speed: float) -> NDArray:
    """Matrix of the first-order system in (y, conj y), y = (xi, xi', s, s'), of size 4 (n + B).

    Args:
        assembly: isotropic rotor with B balancers of weights (liquid is added mass) whose
            angles lie near the main motion (exactly in it, or `balanced_angles` finds it).
        speed: w [rad/s].

    Raises:
        ValueError: the rotor is anisotropic, no balancer has weights, or they cannot balance.
    """
    rotor = assembly.loaded_rotor
    if not rotor.isotropic:
        raise ValueError("the reduced system needs equal stiffness and damping in x and y")
    n, mounted = rotor.stations, assembly.weights
    count = len(mounted)
    if not count:
        raise ValueError("no balancer with weights: the rotor's own modes decide")
    planes = rotor.planes[[m.plane for m in mounted]].reshape(count, n)
    drag = np.array([_weights(m.device).damping_rate for m in mounted])
    share = np.array([_reduced_mass(_weights(m.device)) for m in mounted])
    ends = np.cumsum([_weights(m.device).count for m in mounted])[:-1]
    angles = np.split(balanced_angles(assembly), ends)
    pair = share * np.array([second_harmonic(of_one) for of_one in angles])
    alpha = _acceleration(rotor, speed, planes, drag, share, pair)
    size = 2 * (n + count)
    half = np.zeros((size, 2 * size), complex)
    half[:n, n : 2 * n] = np.eye(n)
    half[n : 2 * n] = alpha
    half[n : 2 * n, :n] += speed**2 * np.eye(n)
    half[n : 2 * n, n : 2 * n] -= 2j * speed * np.eye(n)
    half[2 * n : 2 * n + count, 2 * n + count : size] = np.eye(count)
    seen = planes @ alpha
    half[2 * n + count :] = -share[:, None] * seen + pair[:, None] * _conjugate(seen)
    half[2 * n + count :, 2 * n + count : size] -= np.diag(drag)
    return np.vstack([half, _conjugate(half)])


def reduced_eigenvalues(assembly: Assembly, speed: float) -> NDArray:
    """Eigenvalues of `reduced_matrix` (4 (n + B),) [1/s], the fastest growing first."""
    values = np.linalg.eigvals(reduced_matrix(assembly, speed))
    return values[np.lexsort((values.imag, -values.real))]


def _acceleration(
    rotor: LinearRotor, speed: float, planes: NDArray, drag: NDArray, share: NDArray, pair: NDArray
) -> NDArray:
    """Rows (n, 4 (n + B)) on (y, conj y) that give alpha = D^2 xi, (11) with (12) put in."""
    mass, damping, stiffness = rotor.coefficients(speed)
    spin = 1j * speed
    # M alpha - S^T (share a - pair conj a) = -rest y,  a = S alpha
    own = mass - planes.T @ (share[:, None] * planes)
    crossed = planes.T @ (pair[:, None] * planes)
    rest = np.hstack(
        [
            stiffness + spin * damping,
            damping,
            -(speed**2) * planes.T,
            planes.T * (2.0 * spin - drag),
        ]
    )
    alpha = np.linalg.solve(_doubled(own, crossed), -_doubled(rest, np.zeros_like(rest)))
    return alpha[: rotor.stations]


def _weights(device: object) -> Weights:
    assert isinstance(device, Weights)  # Assembly.weights holds no other
    return device


def _reduced_mass(weights: Weights) -> float:
    """m N/(2 kappa) [kg]."""
    return weights.added_mass / (2.0 * weights.kappa)


def _doubled(own: NDArray, crossed: NDArray) -> NDArray:
    """Matrix on (v, conj v) of v -> own v + crossed conj(v)."""
    return block_diag(own, own.conj()) + np.block(
        [
            [np.zeros_like(own), crossed],
            [crossed.conj(), np.zeros_like(own)],
        ]
    )


def _conjugate(half: NDArray) -> NDArray:
    """Rows on (y, conj y) of the conjugate of what `half` gives."""
    left, right = np.hsplit(half, 2)
    return np.hstack([right.conj(), left.conj()])
