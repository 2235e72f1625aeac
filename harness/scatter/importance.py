"""What matters most: how much of the scatter of the residual vibration each value brings.

Spearman's rank correlation always; with SALib also the first-order index of Sobol, the share of the
variance that a value explains alone, estimated from the same machines by RBD-FAST (Tissot and
Prieur 2012, doi:10.1016/j.ress.2012.06.010).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .study import Scatter

EXTRA = 'pip install "autobalancer[sensitivity]"'
FEWEST = 200  # machines for an index: ten harmonics need many samples each
_RESAMPLES = 30  # for its interval


@dataclass(frozen=True)
class Importance:
    """Of one value.

    Attributes:
        path: of the scene.
        rank_correlation: with the residual amplitude, -1 to 1; its square need not add up.
        first_order, uncertainty: Sobol's index and half its 95 % interval; None without SALib or
            with too few machines.
    """

    path: str
    rank_correlation: float
    first_order: float | None = None
    uncertainty: float | None = None

    @property
    def size(self) -> float:
        """By which values are ordered."""
        return self.rank_correlation**2 if self.first_order is None else self.first_order


def importances(study: Scatter) -> tuple[list[Importance], str]:
    """Most important first, and why there is no first-order index.

    Machines that failed are left out.  Nothing where all machines vibrate alike.
    """
    from scipy.stats import spearmanr

    values, residual = study.values[study.ran], study.residual[study.ran]
    paths = [one.path for one in study.variations]
    if len(residual) < 3 or np.ptp(residual) == 0.0:
        return [], "all machines vibrate alike"
    ranks = [float(spearmanr(column, residual).statistic) for column in values.T]
    indices, missing = _first_order(values, residual)
    rows = [Importance(*row) for row in zip(paths, ranks, *indices, strict=True)]
    return sorted(rows, key=lambda row: -row.size), missing


def _first_order(
    values: np.ndarray, residual: np.ndarray
) -> tuple[tuple[list[float | None], list[float | None]], str]:
    none: list[float | None] = [None] * values.shape[1]
    if len(residual) < FEWEST:
        return (none, none), f"{FEWEST} machines are needed"
    try:
        from SALib.analyze import rbd_fast
    except ImportError:
        return (none, none), f"needs SALib: {EXTRA}"
    problem = {"num_vars": values.shape[1], "names": list(map(str, range(values.shape[1])))}
    indices = rbd_fast.analyze(problem, values, residual, num_resamples=_RESAMPLES, seed=1)
    return ([float(s) for s in indices["S1"]], [float(s) for s in indices["S1_conf"]]), ""
