"""Influence coefficients: vibration of the supports per unbalance in a correction plane.

Polushkin 2016.  An unbalance D = |D| e^{i phi} [kg m] in plane j makes support i vibrate as
x_i = Re(K_ij D e^{i w t}): K_ij [1/kg] is complex, a coefficient of the old technology is a real
number.  Superposition gives A = K D (6); trial runs give K (20), (22) and its inverse gives D (23).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..arrays import Complex
from ..rotor import LinearRotor
from .bounded import least_bounded

_SMALLEST_SINGULAR_VALUE = 1e-6  # of the largest singular value: readings have three digits
_NOTHING = 1e-12  # of the largest reading: what rounding leaves


def influence(rotor: LinearRotor, speed: float, planes: NDArray | None = None) -> Complex:
    """Synchronous response of every station to a unit unbalance in every plane, (2, n, p) [1/kg].

    `[0, i, j]` is K_ij of x = Re(K D e^{i w t}), `[1, i, j]` that of y.  Gyroscopic coupling and
    anisotropy are in it.

    Args:
        speed: w [rad/s].
        planes: (p, n) rows instead of the rotor's own, for a plane at any position
            (`rotor_kinds.line_rows`).

    Raises:
        ValueError: an undamped rotor turns exactly at its critical speed: no bounded response.
    """
    rows = rotor.planes if planes is None else np.asarray(planes, float)
    mass, damping, stiffness = rotor.coefficients(speed)
    dynamic = stiffness - speed**2 * mass + 1j * speed * damping
    force = speed**2 * rows.T.astype(complex)
    try:
        if rotor.isotropic:
            z = np.linalg.solve(dynamic, force)
            return np.array([z, -1j * z])
        # z = e^{i w t}: y = sin w t = Re(-i e^{i w t})
        both = np.linalg.solve(dynamic, np.vstack([force, -1j * force]))
    except np.linalg.LinAlgError:
        raise ValueError(
            f"speed = {speed!r} rad/s: a critical speed of an undamped rotor, no bounded response"
        ) from None
    return both.reshape(2, rotor.stations, -1)


def from_runs(responses: NDArray, mounted: NDArray) -> Complex:
    """(20), (22): K (s, p) from runs with different unbalances mounted, the first the reference.

    Least squares where there are more runs than planes; trial masses may stay in place from run to
    run (Feese & Grazier 2004).

    Args:
        responses: (r, s) complex amplitudes.
        mounted: (r, p) complex unbalances that were mounted.

    Raises:
        ValueError: the runs do not tell the planes apart.
    """
    changes = np.asarray(mounted[1:], complex) - mounted[0]
    effects = np.asarray(responses[1:], complex) - responses[0]
    sizes = np.abs(changes).max(axis=0, initial=0.0)
    sizes[sizes == 0.0] = 1.0
    k, _, rank, _ = np.linalg.lstsq(changes / sizes, effects, rcond=_SMALLEST_SINGULAR_VALUE)
    if rank < changes.shape[1]:
        raise ValueError(
            f"{len(changes)} runs beside the reference distinguish {rank} of {changes.shape[1]} "
            "planes: each plane needs a run of its own in which its mass differs"
        )
    return (k / sizes[:, None]).T


def condition_number(coefficients: NDArray) -> float:
    """Of K (s, p) with columns of length 1: by how much errors of readings can grow in masses."""
    lengths = np.linalg.norm(coefficients, axis=0)
    return float(np.linalg.cond(coefficients / np.where(lengths > 0.0, lengths, 1.0)))


def unbalance_from_response(coefficients: NDArray, response: NDArray) -> Complex:
    """(23): unbalances D (p,) [kg m] from amplitudes A (s,) [m]; the correction to mount is -D.

    With more sensors than planes the least-squares solution.

    Raises:
        ValueError: the coefficients do not tell the planes apart.
    """
    k = np.asarray(coefficients, complex)
    solution, _, rank, _ = np.linalg.lstsq(k, np.asarray(response, complex), rcond=None)
    if rank < k.shape[1]:
        raise ValueError(
            f"influence coefficients of rank {rank} for {k.shape[1]} planes: "
            "move a plane or a sensor"
        )
    return solution


def find_correction(
    coefficients: NDArray,
    response: NDArray,
    largest: NDArray | None = None,
    min_max: bool = False,
) -> Complex:
    """Corrections w (p,) with the least sum of |A + K w|^2 over the sensors, or the least maximum.

    A convex problem.  With a bound or the maximum it is solved by `bounded`.
    Foiles, Allaire and Gunter 2000 compare such corrections.

    Args:
        coefficients: K (s, p).
        response: A (s,) complex amplitudes.
        largest: (p,) bounds of |w|, above 0; default: none.
        min_max: the largest |A + K w| is to be least.

    Raises:
        ValueError: the coefficients do not tell the planes apart.
        ArithmeticError: no correction was found.
    """
    best = -unbalance_from_response(coefficients, response)
    bounds = np.full(len(best), np.inf) if largest is None else np.asarray(largest, float)
    k, a = np.asarray(coefficients, complex), np.asarray(response, complex)
    left = np.abs(a + k @ best).max()
    if (np.abs(best) <= bounds).all() and not (min_max and left > _NOTHING * np.abs(a).max()):
        return best
    return least_bounded(k, a, bounds, min_max)


def scalar_coefficients(coefficients: NDArray, lag: float = 0.0) -> Complex:
    """(4): magnitudes |K_ij|, all with one phase `lag` [rad] that the machine was calibrated to."""
    return np.abs(coefficients) * np.exp(1j * lag)
