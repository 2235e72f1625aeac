"""A rotor that is known by its matrices alone: from a finite element program, or a measurement."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .arrays import numbers
from .shaft import Matrix
from .supports import Support

SYMMETRIC = 1e-9  # of the largest entry: what a symmetric matrix may differ from its transpose


def from_matrices(
    *,
    mass: ArrayLike,
    stiffness: ArrayLike,
    damping: ArrayLike | None = None,
    internal_damping: ArrayLike | None = None,
    gyroscopic: ArrayLike | None = None,
    planes: ArrayLike | None = None,
    unbalance: ArrayLike | None = None,
    supports: Sequence[Support] = (),
    deflection: ArrayLike | None = None,
) -> dict[str, Any]:
    """Any linear rotor, q = displacements of n points of the machine.

    Args:
        mass, internal_damping, gyroscopic: (n, n), the same in both axes; `gyroscopic` is that of
            M q'' - i w G q' in z = x + i y [kg, N s/m, kg].
        stiffness, damping: of all that does not turn, without `supports`: (n, n) for both axes, or
            (2n, 2n) of (x..., y...) with everything that couples them [N/m, N s/m].
        planes: (p, n) displacement of the correction planes from that of the points; default: the
            points.
        unbalance: (n,) complex generalised unbalance in the rotor frame [kg m].
        supports: bearings whose force is an output.
        deflection: (d, n) rows whose largest modulus is the shaft's bending; default: none.

    Raises:
        ValueError: a matrix has another size, or the mass matrix is not symmetric and positive
            definite.
    """
    m = numbers(mass)
    n = len(m)
    zero = np.zeros((n, n))
    blocks = [_blocks("stiffness", stiffness, n), _blocks("damping", damping, n)]
    given = {"internal_damping": internal_damping, "gyroscopic": gyroscopic, "mass": mass}
    for name, one in given.items():
        if one is not None and np.shape(one) != (n, n):
            raise ValueError(f"{name}: has the shape {np.shape(one)}: must be ({n}, {n})")
    refuse_no_mass(m)
    rows = np.eye(n) if planes is None else numbers(planes)
    if rows.shape[1:] != (n,):
        raise ValueError(f"planes: must be rows of {n} numbers, one for each point")
    u = np.zeros(n, complex) if unbalance is None else np.asarray(unbalance, complex)
    if u.shape != (n,):
        raise ValueError(f"unbalance: has {u.size} values: must have {n}, one for each point")
    ground = Support(np.eye(n), blocks[0], blocks[1], across=0)
    plain = not any(block.any() for block in blocks[0][[0, 1], [1, 0]]) and np.array_equal(
        blocks[0][0, 0], blocks[0][1, 1]
    )
    if plain:
        ground = Support(np.eye(n), np.zeros_like(blocks[0]), blocks[1], across=0)
    return {
        "mass": m,
        "elastic": blocks[0][0, 0] if plain else zero,
        "supports": (ground, *supports),
        "internal_damping": zero if internal_damping is None else numbers(internal_damping),
        "gyroscopic": zero if gyroscopic is None else numbers(gyroscopic),
        "planes": rows,
        "unbalance": u,
        "deflection": np.zeros((1, n)) if deflection is None else numbers(deflection),
    }


def refuse_no_mass(mass: Matrix) -> None:
    """Raise ValueError unless a mass matrix is symmetric and positive definite."""
    scale = np.abs(mass).max(initial=0.0)
    if np.any(np.abs(mass - mass.T) > SYMMETRIC * scale):
        raise ValueError("mass: must be symmetric")
    if not np.all(np.linalg.eigvalsh(mass) > 0.0):
        raise ValueError("mass: must be positive definite: a point without mass has no motion")


def _blocks(name: str, matrix: Any, n: int) -> Matrix:
    """(2, 2, n, n) of a matrix for both axes, or of (x..., y...)."""
    found = np.zeros((2, 2, n, n))
    given = np.zeros((n, n)) if matrix is None else numbers(matrix)
    if given.shape == (n, n):
        found[0, 0] = found[1, 1] = given
    elif given.shape == (2 * n, 2 * n):
        found[:] = given.reshape(2, n, 2, n).transpose(0, 2, 1, 3)
    else:
        raise ValueError(
            f"{name}: has the shape {given.shape}: must be ({n}, {n}) or ({2 * n}, {2 * n})"
        )
    return found
