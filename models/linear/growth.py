"""A growth rate with its error: when it can be told from zero.

Rounding moves an eigenvalue by up to its condition number times a rounding of the matrix (Golub &
Van Loan 2013, 7.2.2).  Both depend on the units of the states, so the matrix is balanced first:
rows and columns get like norms (Osborne 1960), as if the states were made nondimensional.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

State = Literal["stable", "unstable", "neutral"]

_SWEEPS = 6  # of balancing: further ones change norms by less than a factor of 2
_ROUNDINGS = 4.0  # per row of a matrix: of its entries, and of the reduction to triangular form


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
    matrices: NDArray, roundings: float = 1.0
) -> tuple[NDArray[np.complex128], NDArray[np.float64]]:
    """Eigenvalues (b, d) of matrices (b, d, d), and how far rounding may have moved each (b, d).

    Args:
        roundings: of the entries, relative to the largest of a balanced matrix, in units of the
            last place; what one matrix product leaves is 1.

    Raises:
        numpy.linalg.LinAlgError: the matrices are not finite.
    """
    balanced = balance(matrices)
    values, right = np.linalg.eig(balanced)
    conditions = _conditions(right)
    size = np.linalg.norm(balanced, axis=(1, 2))
    rounding = (_ROUNDINGS * balanced.shape[-1] + roundings) * np.finfo(float).eps
    return values.astype(complex), rounding * size[:, None] * conditions


def balance(matrices: NDArray) -> NDArray[np.float64]:
    """Similar matrices (b, d, d) whose rows and columns have like norms.

    The factors are powers of two, so that nothing is rounded.
    """
    result = np.array(matrices)
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
    return result


def _conditions(right: NDArray) -> NDArray[np.float64]:
    """Condition numbers (b, d) of the eigenvalues with these eigenvectors (b, d, d), in columns."""
    try:
        left = np.linalg.inv(right)
    except np.linalg.LinAlgError:  # two eigenvectors are equal to the last digit
        left = np.linalg.pinv(right)
        parallel = np.finfo(float).eps ** -0.5
        return np.maximum(np.linalg.norm(left, axis=2) * np.linalg.norm(right, axis=1), parallel)
    return np.linalg.norm(left, axis=2) * np.linalg.norm(right, axis=1)
