"""Exact step of the linear rotor at constant speed.

Within a communication step the force on a plane is a cubic in the rotor frame,
F(t) = e^{i w t} (f_0 + f_1 t + f_2 t^2/2 + f_3 t^3/6), and the unbalance a constant one.  Both
obey linear equations, f_k' = i w f_k + f_{k+1}, so state and force together are one autonomous
linear system and one matrix exponential moves them: no limit from step size, stiffness, resonance.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ..constants import TAYLOR_TERMS
from ..rotor import LinearRotor


def exponential(matrix: NDArray) -> NDArray:
    """e^matrix for a square matrix, by a Taylor series and doubling of e^A - 1.

    Doubling E -> 2E + E^2 instead of squaring e^A keeps slow modes exact next to fast ones: with
    1e14 N/m beside 1 N/m, squaring would lose the soft axis in the rounding of 1 + small.
    Unlike `scipy.linalg.expm` it needs NumPy alone, which is all an FMU may ask of its host.
    """
    norm = float(np.abs(matrix).sum(axis=0).max(initial=0.0))
    if not math.isfinite(norm):
        raise OverflowError("the rotor's matrices are not finite")
    doublings = max(0, math.frexp(norm)[1] + 1)
    scaled = matrix / 2.0**doublings
    term = scaled.copy()
    result = scaled.copy()
    for k in range(2, TAYLOR_TERMS + 1):
        term = term @ scaled / k
        result += term
    for _ in range(doublings):
        result = 2.0 * result + result @ result
    result[np.diag_indices_from(result)] += 1.0
    return result


@lru_cache(maxsize=64)  # rotors and speeds of a run; a map's sweep passes through
def generator(rotor: LinearRotor, speed: float, turning_force: bool = True) -> NDArray:
    """Matrix Z of the autonomous system (q, v, f_0..f_3, e)' = Z (q, v, f_0..f_3, e).

    Complex for an isotropic rotor, else real with every block as (x..., y...); f_k (p,) is the k-th
    derivative of the force in the rotor frame, turned to fixed axes; e is the turning unit vector.
    With `turning_force` False the f_k are the derivatives in fixed axes.
    """
    mass, damping, stiffness = rotor.coefficients(speed)
    axes = 1 if rotor.isotropic else 2
    turning = speed * np.array([[1j]] if axes == 1 else [[0.0, -1.0], [1.0, 0.0]])
    dof = axes * rotor.stations
    forces = axes * rotor.plane_count
    size = 2 * dof + 4 * forces + axes
    z = np.zeros((size, size), dtype=mass.dtype)
    v, f, e = slice(dof, 2 * dof), 2 * dof, size - axes
    z[:dof, v] = np.eye(dof)
    right = np.hstack([-stiffness, -damping, np.kron(np.eye(axes), rotor.planes.T)])
    z[v, : 2 * dof + forces] = np.linalg.solve(mass, right)
    z[v, e:] = np.linalg.solve(mass, speed**2 * rotor.unbalance_columns)
    for k in range(4):
        row = slice(f + k * forces, f + (k + 1) * forces)
        if turning_force:
            z[row, row] = np.kron(turning, np.eye(rotor.plane_count))
        if k < 3:
            z[row, f + (k + 1) * forces : f + (k + 2) * forces] = np.eye(forces)
    z[e:, e:] = turning
    z.flags.writeable = False  # one for all who ask
    return z


def step_matrix(
    rotor: LinearRotor, speed: float, step: float, turning_force: bool = True
) -> NDArray:
    """Matrix that takes (q, v, f_0..f_3, e) to (q, v, a, j) one `step` [s] later.

    a and j are acceleration and jerk of the p planes in fixed axes (complex for an isotropic rotor,
    else x then y).  With `step` = 0 it evaluates them at the start.
    """
    z = generator(rotor, speed, turning_force)
    axes = 1 if rotor.isotropic else 2
    dof = axes * rotor.stations
    propagated = exponential(z * step) if step else np.eye(len(z), dtype=z.dtype)
    planes = np.kron(np.eye(axes), rotor.planes)
    # e^{Zt} Z, not Z e^{Zt}: a stiff support would lose the small acceleration between k q and F
    rates = propagated[dof : 2 * dof] @ z
    return np.vstack([propagated[: 2 * dof], planes @ rates, planes @ rates @ z])
