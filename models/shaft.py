"""Compliance and stiffness of a massless elastic shaft on two supports.

Filimonikhin 2011 (1): the discs' bending relative to the line through the supports p and q is
T q = delta F, so the shaft pulls on all discs with the stiffness T^T delta^-1 T, per axis.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .arrays import numbers
from .constants import SHAFT_SINGULAR, SHAFT_SYMMETRIC

Matrix = NDArray[np.float64]
Moment = tuple[float, complex]  # of an unbalance: its place [m], static moment [kg m]


def bending_rows(z: Sequence[float] | Matrix, supports: tuple[int, int]) -> Matrix:
    """T (n-2, n): bending of the discs relative to the line through both supports.

    Filimonikhin 2011 (1): x_j - (1 - zt_j) x_p - zt_j x_q for every disc but p, q (from 0).
    """
    z = numbers(z)
    p, q = supports
    rows = np.eye(len(z), dtype=z.dtype)
    share = (z - z[p]) / (z[q] - z[p])
    rows[:, p] -= 1.0 - share
    rows[:, q] -= share
    return np.delete(rows, [p, q], axis=0)


def beam_compliance(
    z: Sequence[float] | Matrix, supports: tuple[int, int], bending_stiffness: float
) -> Matrix:
    """Euler-Bernoulli influence coefficients delta (n-2, n-2) [m/N], overhangs included.

    A unit force on a free beam bends it by |z - z_k|^3/(12 E I) plus a straight line; taking out
    the line through the supports - the rows T, from both sides - leaves the supported beam:
    delta = T |z_j - z_k|^3 T^T / (12 E I).  A single disc at mid-span gives l^3/(48 E I).
    """
    z = numbers(z)
    rows = bending_rows(z, supports)
    gaps = np.abs(z[:, None] - z)
    delta = rows @ (gaps * gaps * gaps) @ rows.T / (12.0 * bending_stiffness)
    return (delta + delta.T) / 2.0


def beam_shares(z: Matrix, position: float) -> Matrix:
    """Shares (n,) of the discs in a force at a position between them [m].

    A uniform shaft loaded at its discs alone bends in the natural cubic spline through them; its
    values for one disc displaced are, by reciprocity, the shares.
    """
    from scipy.interpolate import CubicSpline  # few rotors need it

    return np.asarray(CubicSpline(z, np.eye(len(z)), bc_type="natural")(position))


def symmetric_compliance(compliance: Sequence[Sequence[float]], size: int) -> Matrix:
    """A measured compliance made symmetric, (size, size) [m/N]; ValueError if it is not nearly."""
    delta = numbers(compliance).reshape(size, size)
    scale = np.abs(delta).max(initial=0.0)
    if np.any(np.abs(delta - delta.T) > SHAFT_SYMMETRIC * scale):
        raise ValueError("compliance: must be symmetric (Maxwell's reciprocity)")
    return (delta + delta.T) / 2.0


def shaft_stiffness(delta: Matrix, rows: Matrix) -> tuple[Matrix, float]:
    """T^T delta^-1 T (n, n) [N/m], and the largest delta_jj [m/N].

    Args:
        delta, rows: compliance (n-2, n-2) [m/N], and T (n-2, n).

    Raises:
        ValueError: the compliance is not positive definite.
    """
    # scaled: discs close to a support are stiffer by orders of magnitude
    scale = np.sqrt(np.abs(delta.diagonal()))
    try:
        with np.errstate(all="ignore"):
            lower = np.linalg.cholesky(delta / np.outer(scale, scale))
        if not lower.diagonal().min(initial=1.0) ** 2 > SHAFT_SINGULAR:  # NaN fails too
            raise np.linalg.LinAlgError
    except np.linalg.LinAlgError:
        raise ValueError(
            f"compliance = {delta.tolist()} m/N: must be positive definite: every load bends the "
            "shaft its own way (are two stations almost at one place?)"
        ) from None
    bent = np.linalg.inv(lower) / scale @ rows
    return bent.T @ bent, float(delta.diagonal().max(initial=0.0))
