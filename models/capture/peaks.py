"""Peaks of the lag that weights can hold, over their speed.

Where weights of several groups are left behind, the phases between them follow from equal torques.
Near a natural frequency they can turn over: the lag falls within a few hundredths of a half width,
or there is no such motion at all, and rises again beyond.  Weights are let go before that: the
first peak from below counts.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Array, Indices
from .groups import Lag
from .receptance import Poles, Receptance

_POINTS = 31  # between the neighbours of the highest of coarse points
_TURN_OVER = 0.5  # half widths below a natural frequency within which phases turn over
_THREE = np.array([[-1], [0], [1]])
_AT_END = 12  # between the last point of a motion and the next one
_PLACES = {points: np.linspace(0.0, 1.0, points) for points in (_POINTS, _AT_END)}


def find_peaks(frequency: Array, lags: Array, away: Array) -> tuple[Array, Array, Indices]:
    """Local maximum of each row (b, j) with the least `away`: place, height, nearest point.

    Near a resonance 1/lag is a parabola.  Where the motion ends beside the highest point, that
    point is the maximum.

    Args:
        away: (b, j) or (j,).

    Returns:
        NaN where there is none within the row.
    """
    at = np.where(lags > 0.0, lags, 0.0)  # NaN: no motion
    before, middle = at[:, :-2], at[:, 1:-1]
    highest = (middle > before) & (middle >= at[:, 2:]) & (before > 0.0)
    away = np.where(highest, away[..., 1:-1], np.inf)
    top, every = away.argmin(axis=1) + 1, np.arange(len(lags))
    found = highest[every, top - 1] & (away[every, top - 1] < np.inf)
    three = every, top + _THREE
    x = frequency[three]
    with np.errstate(divide="ignore", invalid="ignore"):
        y = 1.0 / at[three]
        left, right = (y[1:] - y[:-1]) / (x[1:] - x[:-1])
        bend = (right - left) / (x[2] - x[0])
        place = 0.5 * (x[0] + x[1]) - 0.5 * left / bend
        height = 1.0 / (y[1] + (place - x[1]) * (left + bend * (place - x[0])))
        smooth = np.isfinite(y[0] + y[2] + place + height)
    place, height = np.where(smooth, place, x[1]), np.where(smooth, height, at[every, top])
    return np.where(found, place, np.nan), np.where(found, height, np.nan), top


def first_peaks(
    receptance: Receptance,
    lag: Lag,
    poles: Poles,
    around: tuple[Array, Array],
    lowest: Array,
    speed: float | Array,
    numbers: Array,
    phases: Array,
    factors: float | Array = 1.0,
) -> tuple[Array, Array]:
    """Place and height (r,) of the first local maximum near natural frequencies; NaN: none.

    Args:
        poles: natural frequencies (r,).
        around: speeds of the weights (r,) between which they have a maximum [rad/s].
        lowest: (r,) where the side of the next lower natural frequency begins [rad/s].
        speed: of the rotor, one or (r,) [rad/s].
        numbers, phases: (r, c) of the weights left behind, and of the groups to begin with.
        factors: of all drags, one or (r,).
    """
    low, high = around
    low = np.minimum(low, np.maximum(poles.frequency - _TURN_OVER * poles.decay, lowest))
    w, lags, turned = _along(receptance, lag, low, high, _POINTS, speed, numbers, phases, factors)
    peak, held, top = find_peaks(w, lags, np.arange(float(_POINTS)))
    ends = np.flatnonzero(~np.isnan(peak) & np.isnan(lags[range(len(w)), top + 1]))
    if len(ends):
        there, scaled = (x if np.ndim(x) == 0 else np.asarray(x)[ends] for x in (speed, factors))
        last = ends, top[ends]
        w, lags, _ = _along(
            receptance, lag, w[last], w[ends, top[ends] + 1], _AT_END, there, numbers[ends],
            turned[last], scaled,
        )  # fmt: skip
        gone = np.logical_or.accumulate(np.isnan(lags), axis=1)
        best = np.where(gone, -np.inf, lags).argmax(axis=1)
        every = np.arange(len(ends))
        peak[ends], held[ends] = w[every, best], lags[every, best]
    return peak, held


def _along(
    receptance: Receptance,
    lag: Lag,
    low: Array,
    high: Array,
    points: int,
    speed: float | Array,
    numbers: Array,
    phases: Array,
    factors: float | Array,
) -> tuple[Array, Array, Array]:
    """Evenly spread speeds (r, points) of the weights, lags there, and phases (r, points, c)."""
    w = low[:, None] + (high - low)[:, None] * _PLACES[points]
    return w, *lag.at(receptance, w, speed, numbers, phases, factors)
