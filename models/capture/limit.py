"""Drag from which on no weights can be left behind at a speed of the rotor.

The limit of k = N is exact, and the least that is possible.  The drag of weights that turn with the
rotor acts on its motion, as internal damping does: at another drag the limit of k < N is another
one.  Between L(d)/d = 1 and a second such place, where the others feed the motion most, nothing
may be left behind: a window.  The limit is the largest drag d with L(d) >= d.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Indices
from .branch import NEARLY, Branches, drag_ratios, near_poles, ratios_at_drags
from .groups import Lag
from .receptance import Receptance

_LADDER = np.concatenate([np.linspace(0.0, 0.8, 17), np.linspace(0.9, 2.0, 12)])  # log of drags
_LADDERS = 4  # at most, each from the end of the one before
_HOPELESS = 0.3  # L(d)/d, by the damping of the natural frequency at d, that is never 1
_FINER = np.linspace(0.0, 1.0, 9)  # between two drags
_STEEPEST, _AT_JUMP = 10.0, 2e-3  # slope of the logarithms that is a jump, and how near it is found
_FAR_BELOW = 0.8  # of the limit of k = N, which is exact: k < N of one group do not decide


def drag_limit(branches: Branches, receptance: Receptance, lag: Lag) -> float:
    """Limit over the present drag, of all drags in their proportion; 0: no natural frequency."""
    ratios = drag_ratios(branches)
    count = sum(one.count for one in lag.groups)
    all_left = branches.numbers.sum(axis=1) == count
    whole, part = (float(ratios[which].max(initial=0.0)) for which in (all_left, ~all_left))
    if (len(lag.groups) == 1 and part <= _FAR_BELOW * whole) or not (whole or part):
        return whole
    search = _Search(branches, receptance, lag, np.flatnonzero(~all_left), ratios)
    limit = search.above(whole or min(part, 1.0), whole)
    # the present drag may lie in a window that is narrower than the steps of the search
    return limit if limit >= 1.0 or part < 1.0 else search.above(1.0, 1.0)


class _Search:
    """The largest drag at which k < N weights can be left behind, by several drags at once."""

    def __init__(
        self, branches: Branches, receptance: Receptance, lag: Lag, rows: Indices, ratios: Array
    ) -> None:
        self._branches, self._receptance, self._lag = branches, receptance, lag
        self._rows, self._now = rows, ratios[rows]

    def above(self, lowest: float, whole: float) -> float:
        """It, or `whole`, that of k = N, where there is none above the lowest drag."""
        drags = lowest * np.exp(_LADDER)
        for _ in range(_LADDERS):
            found = self._along(drags)
            high = np.flatnonzero(found.max(axis=1) >= 1.0)
            if not len(high):
                return whole
            k = int(high[-1])
            if k + 1 < len(drags):
                return self._between(drags[k], drags[k + 1], found[k : k + 2])
            drags = drags * (drags[-1] / drags[0])
        return float(drags[0])

    def _along(self, drags: Array) -> Array:
        """L(d)/d (d, rows) at every second drag, and between two of which one is nearly 1.

        Below the largest drag at which one is 1 the others do not matter: they stay 0.
        """
        every = np.arange(len(self._rows))
        found = np.zeros((len(drags), len(every)))
        found[::2] = self._ratios(drags[::2], every)
        largest = found[::2].max(axis=1)
        between = 1 + 2 * np.flatnonzero(np.maximum(largest[:-1], largest[1:]) > NEARLY)
        between = between[between > 2 * np.flatnonzero(largest >= 1.0)[-1:].sum()]
        if len(between):
            found[between] = self._ratios(drags[between], every)
        return found

    def _between(self, low: float, high: float, ends: Array) -> float:
        """Where the largest L(d)/d, (2, rows) at the ends, falls to 1, or the end of a jump."""
        while True:
            rows = np.flatnonzero(ends.max(axis=0) > NEARLY)
            drags = low * (high / low) ** _FINER
            each = np.zeros((len(drags), ends.shape[1]))
            each[0], each[-1] = ends
            each[1:-1, rows] = self._ratios(drags[1:-1], rows)
            with np.errstate(divide="ignore"):
                found = np.log(each.max(axis=1))
            k = min(int(np.flatnonzero(found[:-1] >= 0.0)[-1:].sum()), len(drags) - 2)
            low, high, ends = drags[k], drags[k + 1], each[k : k + 2]
            width, fall = math.log(high / low), found[k] - found[k + 1]
            if fall < _STEEPEST * width:
                return float(low * math.exp(width * found[k] / fall)) if found[k] > 0.0 else low
            if width < _AT_JUMP:
                return float(high)

    def _ratios(self, drags: Array, rows: Indices) -> Array:
        """L(d)/d (d, r) at factors of the drags, of some rows; 0 where it is certainly below 1."""
        found = np.zeros((len(drags), len(rows)))
        which, at = np.nonzero(self._can_be_high(drags, rows))
        if len(at):
            found[which, at] = ratios_at_drags(
                self._branches, self._receptance, self._lag, self._rows[rows[at]], drags[which]
            )
        return found

    def _can_be_high(self, drags: Array, which: Indices) -> NDArray[np.bool_]:
        """Whether L(d)/d can be 1, (d, r) of some rows: where the damping at d does not exclude it.

        L(d) is in proportion to one over the damping while the peak stays where it is.  It nearly
        does below `turned_over`.  Above, weights that turn with the rotor pull one way at much drag
        and the other way at little.  L(d)/d can then be tenfold: nothing is excluded there.
        """
        rows, branches = self._rows[which], self._branches
        poles = branches.poles.select(np.tile(branches.pole[rows], len(drags)))
        numbers = np.tile(branches.numbers[rows], (len(drags), 1))
        factors = np.repeat(drags, len(rows))
        there = near_poles(
            self._receptance, self._lag, poles, branches.speed, numbers, factors
        ).decay.reshape(len(drags), -1)
        with np.errstate(divide="ignore", invalid="ignore"):
            high = self._now[which] * branches.own.decay[rows] > _HOPELESS * there * drags[:, None]
            pole, own = branches.poles.frequency[branches.pole], branches.own.frequency
            far = np.maximum(np.maximum(pole, own), branches.peak)[rows]
            unknown = ~(far < self._lag.turned_over * branches.speed)
        return np.asarray((there > 0.0) & (high | unknown))
