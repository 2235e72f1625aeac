"""A growth rate with its error: when it can be told from zero.

Rounding moves an eigenvalue by up to its condition number times a rounding of the matrix (Golub &
Van Loan 2013, 7.2.2).  Both depend on the units of the states, so the matrix is balanced first:
rows and columns get like norms (Osborne 1960), as if the states were made nondimensional.

The norm is that of the fastest motion, and a slow growth may be smaller than its rounding.  So each
eigenvalue is corrected by its residual, y^H (A x - lambda x)/(y^H x), in the longest floating-point
numbers there are.  What is left is what rounding of the entries makes, |y|^H |A| |x|/|y^H x|.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

State = Literal["stable", "unstable", "neutral"]

_SWEEPS = 6  # of balancing: further ones change norms by less than a factor of 2
_ROUNDINGS = 4.0  # per row of a matrix: of its entries, and of the reduction to triangular form
_LONG = np.longdouble  # 64 digits in binary on x86, elsewhere as many as a double has


def is_neutral(rate: float, error: float) -> bool:
    """Whether a growth rate [1/s] cannot be told from zero, by the error [1/s] of its method.

    >>> is_neutral(1.6e-14, 1e-12), is_neutral(1e-6, 1e-12)
    (True, False)
    """
    return bool(abs(rate) <= error)


@dataclass(frozen=True)
class Growth:
    """The largest growth rate of a small deviation, and how well it is known.

    Attributes:
        rate: [1/s]; negative: the deviation decays.
        error: largest error of the rate [1/s].

    >>> Growth(-3e-17, 1e-13).state
    'neutral'
    """

    rate: float
    error: float

    @property
    def is_neutral(self) -> bool:
        """Whether the rate cannot be told from zero, as of an undamped motion."""
        return is_neutral(self.rate, self.error)

    @property
    def state(self) -> State:
        """What the rate says; "neutral" where its sign is within its error."""
        if self.is_neutral:
            return "neutral"
        return "unstable" if self.rate > 0.0 else "stable"


def eigenvalues_with_errors(
    matrices: NDArray, roundings: float = 0.0
) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
    """Eigenvalues (b, d) of matrices (b, d, d), and how far rounding may have moved each (b, d).

    Args:
        roundings: errors of the matrices, beyond those of single entries, relative to the norm of a
            balanced matrix in units of the last place; a product of n matrices has about n.

    Raises:
        numpy.linalg.LinAlgError: the matrices are not finite.
    """
    values, _, errors = eigenpairs_with_errors(matrices, roundings)
    return values, errors


def eigenpairs_with_errors(
    matrices: NDArray, roundings: float = 0.0
) -> tuple[NDArray[np.complex128], NDArray, NDArray[np.float64]]:
    """As `eigenvalues_with_errors`, with eigenvectors (b, d, d) in columns between the two."""
    balanced, factors = balance(matrices)
    values, right = np.linalg.eig(balanced)
    left = _inverse(right)
    conditions = np.linalg.norm(left, axis=2) * np.linalg.norm(right, axis=1)
    rounding = np.finfo(float).eps * np.linalg.norm(balanced, axis=(1, 2))[:, None] * conditions
    first = _ROUNDINGS * balanced.shape[-1] * rounding
    values, left_over = _corrected(balanced, values, left, right, first)
    products = np.einsum("bij,bjk,bki->bi", np.abs(left), np.abs(balanced), np.abs(right))
    of_entries = _ROUNDINGS * np.finfo(float).eps * balanced.shape[-1] * products
    errors = np.minimum(left_over + of_entries, first) + roundings * rounding
    return values, right * factors[:, :, None], errors


def _corrected(
    matrices: NDArray, values: NDArray, left: NDArray, right: NDArray, errors: NDArray
) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
    """Eigenvalues corrected by their residuals, and what is left of their errors, (b, d) each.

    A correction is of first order: it squares an error over the distance to the next eigenvalue.
    """
    long = np.result_type(_LONG, values.dtype)
    x = right.astype(long)
    residual = matrices.astype(long) @ x - x * values[:, None, :]
    found = values + np.einsum("bij,bji->bi", left, residual)
    apart = np.abs(values[:, :, None] - values[:, None, :])
    both = errors[:, :, None] + errors[:, None, :]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(np.eye(values.shape[1], dtype=bool), 0.0, both / apart)
    share = np.where(np.isnan(share), 1.0, share).max(axis=2, initial=0.0)
    left_over = errors * np.minimum(share, 1.0)
    return np.where(share < 1.0, found, values).astype(complex), left_over


def balance(matrices: NDArray) -> tuple[NDArray, NDArray[np.float64]]:
    """Similar matrices F^-1 A F (b, d, d) whose rows and columns have like norms, and F (b, d).

    F is diagonal, of powers of two, so that nothing is rounded.
    """
    result, factors = np.array(matrices), np.ones(matrices.shape[:2])
    for _ in range(_SWEEPS):
        for i in range(result.shape[-1]):
            own = np.abs(result[:, i, i])
            column = np.abs(result[:, :, i]).sum(axis=1) - own
            row = np.abs(result[:, i, :]).sum(axis=1) - own
            apart = (column > 0.0) & (row > 0.0)
            ratio = np.where(apart, row, 1.0) / np.where(apart, column, 1.0)
            factor = np.exp2(np.round(np.log2(ratio) / 2.0))[:, None]
            result[:, :, i] *= factor
            result[:, i, :] /= factor
            factors[:, i] *= factor[:, 0]
    return result, factors


def _inverse(right: NDArray) -> NDArray:
    """Inverse (b, d, d) of eigenvectors in columns; a very large one where two are equal."""
    try:
        return np.linalg.inv(right)
    except np.linalg.LinAlgError:  # to the last digit
        alike = np.finfo(float).eps ** 0.5
        return np.linalg.inv(right + alike * np.eye(right.shape[-1]))


def largest(growth: NDArray, errors: NDArray) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Largest of growth rates (b, d), and its error (b,): another may be the largest instead."""
    found = growth.max(axis=1, initial=-np.inf)
    most = (growth + errors).max(axis=1, initial=-np.inf)
    least = (growth - errors).max(axis=1, initial=-np.inf)
    return found, np.maximum(most - found, found - least)
