"""Drag from which on no weights can be left behind at a speed of the rotor."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ..arrays import Array
from .branch import LAGS, Branches, at_drags, ratio_below_speed
from .groups import Lag
from .receptance import Receptance

_STEPS = 12  # at most
_REACHED = 1e-3  # relative
_SMALL = 0.4  # of the largest limit: rows below it are left out at the next drag
_NOTHING = 1e-3  # limit over the drag that stands for none
_JUMP, _AT_JUMP = 10.0, 0.01  # slope of the logarithms that is a jump, and how near it is found
_FAR_BELOW = 0.8  # of the limit of k = N, which is exact: k < N of one group do not decide


def drag_ratio(branches: Branches, row: int) -> float:
    """Limit of one row over the present drag; of k < N with the others at their present drag."""
    peak, held = float(branches.peak[row]), float(branches.lag[row])
    left = branches.speed - peak
    near = left < LAGS * branches.speed  # the peak is near the rotor's speed, or above it
    return ratio_below_speed(branches, row) if near else held / left


def drag_limit(branches: Branches, receptance: Receptance, lag: Lag) -> float:
    """Limit over the present drag, of all drags in their proportion; 0: no natural frequency.

    The limit of k = N is exact and the least that is possible.  The drag of weights that turn with
    the rotor acts on its motion: at another drag the limit of k < N is another one.  The drag is
    looked for at which it is the drag itself, from the limit of k = N upwards.
    """
    ratios = _ratios(branches)
    count = sum(one.count for one in lag.groups)
    all_left = branches.numbers.sum(axis=1) == count
    whole, part = (float(ratios[which].max(initial=0.0)) for which in (all_left, ~all_left))
    if len(lag.groups) == 1 and part <= _FAR_BELOW * whole:
        return whole

    if not (whole or part):
        return 0.0
    rows = np.arange(len(ratios))

    def excess(log_factor: float) -> float:
        """Logarithm of the limit at a drag over this drag."""
        nonlocal rows
        there = Lag(lag.groups, math.exp(log_factor) * lag.drags)
        found = _ratios(at_drags(branches, receptance, there, rows))
        largest = float(found.max(initial=0.0))
        if _SMALL < largest < 1.0 / _SMALL:  # near the limit, others do not become it
            rows = rows[found > _SMALL * largest]
        return math.log(max(largest, _NOTHING))

    least = math.log(whole) if whole else -math.inf
    return math.exp(_root(excess, math.log(max(whole, part)), least))


def _root(excess: Callable[[float], float], at_zero: float, least: float) -> float:
    """Where a falling function, which may jump, passes 0, not below `least`.

    x + excess(x) is the next guess until two points enclose the root.

    Args:
        at_zero: its value at 0.
    """
    low, high, at_low, at_high, before = -math.inf, math.inf, 0.0, 0.0, 0.0
    x, at = 0.0, at_zero
    for _ in range(_STEPS):
        if abs(at) <= _REACHED or (at < 0.0 and x <= least):
            return x
        again = at * before > 0.0  # the other end stays: half its value (Illinois)
        if at > 0.0:
            low, at_low, at_high = x, at, at_high * (0.5 if again else 1.0)
        else:
            high, at_high, at_low = x, at, at_low * (0.5 if again else 1.0)
        before, width = at, high - low
        jumps = at_low - at_high > _JUMP * max(width, _AT_JUMP)
        if width <= (_AT_JUMP if jumps else _REACHED):
            return high
        if math.isinf(width):
            x = max(least, x + at)
        else:
            x = low + width * (0.5 if jumps else at_low / (at_low - at_high))
        at = excess(x)
    return x if math.isinf(high) else high


def _ratios(branches: Branches) -> Array:
    """Limits (b,) over the present drag; 0: none."""
    ratios = np.zeros(len(branches.peak))
    for row in np.flatnonzero(~np.isnan(branches.peak)).tolist():
        ratio = drag_ratio(branches, row)
        ratios[row] = ratio if math.isfinite(ratio) else 0.0
    return ratios
