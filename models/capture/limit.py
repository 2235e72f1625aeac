"""Drag from which on no weights can be left behind at a speed of the rotor."""

from __future__ import annotations

import math

import numpy as np

from .branch import LAGS, Branches, find_branches, ratio_below_speed
from .groups import Lag
from .receptance import Receptance

_STEPS = 6  # at most
_REACHED = 1e-3  # relative
_FAR_BELOW = 0.7  # of the limit of k = N, which is exact: k < N do not decide


def drag_ratio(branches: Branches, row: int) -> float:
    """Limit of one row over the present drag; of k < N with the others at their present drag."""
    peak, held = float(branches.peak[row]), float(branches.lag[row])
    left = branches.speed - peak
    near = left < LAGS * branches.speed  # the peak is near the rotor's speed, or above it
    return ratio_below_speed(branches, row) if near else held / left


def drag_limit(branches: Branches, receptance: Receptance, lag: Lag) -> float:
    """Limit over the present drag, of all drags in their proportion; 0: no natural frequency.

    The drag of weights that turn with the rotor acts on its motion: at another drag the limit of
    k < N is another one.  It is found step by step.
    """
    factor, all_weights = 1.0, sum(one.count for one in lag.groups)
    for _ in range(_STEPS):
        whole, part = 0.0, 0.0
        for row in np.flatnonzero(~np.isnan(branches.peak)).tolist():
            ratio = drag_ratio(branches, row)
            if not math.isfinite(ratio):
                continue
            if branches.numbers[row].sum() == all_weights:
                whole = max(whole, ratio)
            else:
                part = max(part, ratio)
        largest = max(whole, part)
        factor *= largest
        if part <= _FAR_BELOW * whole or abs(largest - 1.0) <= _REACHED:
            break
        there = Lag(lag.groups, factor * lag.drags, lag.plane_count)
        branches = find_branches(receptance, there, branches.speed)
    return factor
