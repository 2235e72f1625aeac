"""Whether residuals of a fit follow one another: a test of autocorrelation.

Intervals of a fit assume that residuals scatter independently.  What the model lacks, such as a
run-out, makes neighbours in speed deviate alike.  Two statistics are sensitive to it: the
correlation of neighbours, and the share of the squares in slow cosines (a smooth test, Neyman
1937).  Their distribution without autocorrelation is drawn: normal scatter of which the fit has
taken its part, by the projection off the columns of the Jacobian.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import rankdata

from ...models.arrays import Array

SIGNIFICANCE = 0.1  # of files with pure scatter so many are called systematic
_DRAWS, _SEED = 4000, 1
_SLOW = 4  # residuals per cosine that counts as slow
_FEWEST = 6  # residuals of which a sequence is judged


def significance(residuals: Array, jacobian: Array, sequences: Sequence[NDArray[np.int_]]) -> float:
    """Probability that independent scatter looks as systematic as these residuals.

    Args:
        residuals: (n,).
        jacobian: (n, p) at the minimum.
        sequences: numbers of residuals that are neighbours, each in their order.

    Returns:
        NaN where there are too few residuals to tell.
    """
    orders = [order for order in sequences if len(order) >= _FEWEST]
    if not orders or len(residuals) <= jacobian.shape[1]:
        return math.nan
    q, _ = np.linalg.qr(jacobian)
    drawn = np.random.default_rng(_SEED).standard_normal((_DRAWS, len(residuals)))
    drawn -= (drawn @ q) @ q.T
    statistics = _statistics(np.vstack([residuals, drawn]), orders)
    # how rare each is; the rarer of the two, against that of the draws
    rarity = np.min([rankdata(-one, "max") for one in statistics.T], axis=0)
    return float(np.mean(rarity[1:] <= rarity[0]))


def _statistics(residuals: Array, orders: Sequence[NDArray[np.int_]]) -> Array:
    """(k, 2) of residuals (k, n): correlation of neighbours, share in slow cosines."""
    neighbours, slow, squares = np.zeros((3, len(residuals)))
    for order in orders:
        e, n = residuals[:, order], len(order)
        neighbours += (e[:, 1:] * e[:, :-1]).sum(axis=1)
        k = np.arange(1, max(2, n // _SLOW) + 1)
        waves = math.sqrt(2.0 / n) * np.cos(math.pi / n * np.outer(np.arange(n) + 0.5, k))
        slow += ((e @ waves) ** 2).sum(axis=1)
        squares += (e**2).sum(axis=1)
    return np.column_stack([neighbours, slow]) / np.maximum(squares, 1e-300)[:, None]
