"""Whether a constant run-out explains the residuals of a fit, and what it would change.

A sensor near the shaft also shows the run-out of its surface: a vector that turns with the rotor
and is the same at every speed.  To values of a fit it can look like stiffness or unbalance.  The
linear model about the minimum, with one free vector for each column of the measurements, tells by
an F test how rarely independent scatter is explained so well, and which values the fit has then.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.stats import f as fisher

from ...models.arrays import Array
from .measured import MeasuredAmplitudes
from .model import Turning
from .search import known

SIGNIFICANCE = 0.2  # of files with pure scatter so many are told that a run-out is likely
HIDDEN = math.sqrt(10.0)  # times wider with a free run-out: the residuals do not show it
_PART = 0.1  # of the typical amplitude: a run-out that is not rare
_EXACT = 1e-7  # rms of residuals that are rounding
_STEP = 1e-6  # of the typical amplitude


@dataclass(frozen=True, eq=False)
class Runout:
    """Constant vectors, one for each column, that explain the residuals best.

    Attributes:
        sizes: of the vectors by column [m].
        chance: probability that independent scatter is explained so well; NaN where it cannot be
            told: too few measurements, or all run-outs have been subtracted.
        shift: (p,) what the run-outs change in the values, over their start.
        uncertainty: (p,) half the interval of 95 % of the values with free run-outs, over their
            start; infinite where they cannot be told apart.
        pull: (p,) what a run-out of 10 % of the typical amplitude changes at most, over the start.
        explained: share of the squares of the residuals.
    """

    sizes: Mapping[str, float]
    chance: float
    shift: Array
    uncertainty: Array
    pull: Array
    explained: float

    @property
    def is_likely(self) -> bool:
        """Whether the run-outs explain more than scatter allows."""
        return self.chance < SIGNIFICANCE

    def widened(self, uncertainty: Array) -> Array:
        """Half intervals (p,) about the values without run-out that include those with it.

        Also where it is not likely: one that the test does not see moves values too.  Values that
        are known much worse with a free run-out keep their intervals, see `is_hidden`.
        """
        with_runout = np.maximum(uncertainty, np.abs(self.shift) + self.uncertainty)
        is_told = self.uncertainty <= HIDDEN * uncertainty
        return np.where(self.is_likely | is_told, with_runout, uncertainty)

    def is_hidden(self, uncertainty: Array) -> NDArray[np.bool_]:
        """Values (p,) that a run-out moves out of their interval and the residuals do not show."""
        moved = (self.pull > uncertainty) & np.isfinite(uncertainty)
        return moved & (self.uncertainty > HIDDEN * uncertainty)


def find_runout(
    residuals: Array,
    jacobian: Array,
    measured: MeasuredAmplitudes,
    turning: Mapping[str, Turning],
) -> Runout | None:
    """Fit a run-out to every column from which none was subtracted; None where there is none left.

    Args:
        residuals: (n,) at the minimum, as of `search.search`; priors follow.
        jacobian: (n, p) of parameters over their starts.
        turning: by column, see `Model.turning`.
    """
    names = [name for name in measured.sizes if name not in measured.without_runout]
    if not names:
        return None
    units = {name: float(np.median(turning[name].amplitude)) for name in names}
    count, own = jacobian.shape[1], len(measured.logarithms)

    def added(vectors: Array) -> Array:
        pairs = vectors.reshape(len(names), 2) @ (1.0, 1j)
        moved = dict(zip(names, pairs, strict=True))
        values = {n: moved[n] * units[n] if n in moved else 0.0 for n in measured.sizes}
        return _change(measured, turning, values)

    def left(unknown: Array) -> Array:
        found = residuals + jacobian @ unknown[:count]
        found[:own] += added(unknown[count:])
        return found

    slopes = np.zeros((len(residuals), 2 * len(names)))
    steps = _STEP * np.eye(2 * len(names))
    slopes[:own] = np.array([added(ahead) / _STEP for ahead in steps]).T
    pull = _PART * _largest_shift(jacobian, slopes)
    freedom = len(residuals) - count - slopes.shape[1]
    unknown = np.full(count, math.inf)
    if freedom < 1 or math.sqrt(np.mean(residuals**2)) < _EXACT:
        return Runout({}, math.nan, np.zeros(count), unknown, pull, 0.0)
    solution = least_squares(left, np.zeros(count + slopes.shape[1]), x_scale="jac")
    before, after = float(residuals @ residuals), 2.0 * solution.cost
    ratio = (before - after) / (2 * len(names)) / max(after / freedom, 1e-300)
    uncertainty, _, _ = known(solution.jac, solution.fun)
    sizes = np.hypot(*solution.x[count:].reshape(-1, 2).T) * list(units.values())
    return Runout(
        dict(zip(names, sizes.tolist(), strict=True)),
        float(fisher.sf(ratio, 2 * len(names), freedom)),
        solution.x[:count],
        uncertainty[:count],
        pull,
        1.0 - after / before,
    )


def _change(
    measured: MeasuredAmplitudes, turning: Mapping[str, Turning], vectors: Mapping[str, complex]
) -> Array:
    """What vectors [m] by column add to the logarithms and phases of all that was measured."""
    moved = {
        name: turning[name]._replace(forward=turning[name].forward + vectors[name])
        for name in measured.sizes
    }
    grown = {n: np.log(one.amplitude / turning[n].amplitude) for n, one in moved.items()}
    turned = {
        name: (moved[name].forward * turning[name].forward.conj())[0]
        for name in measured.vibrations
    }
    return measured.joined(grown, turned)


def _largest_shift(jacobian: Array, slopes: Array) -> Array:
    """(p,) by how much values move at most under any unit vectors of slopes (n, 2 c)."""
    return np.linalg.norm(np.linalg.pinv(jacobian) @ slopes, axis=1)
