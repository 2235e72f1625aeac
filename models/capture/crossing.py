"""Where weights turn on the rising side of a brake, while the rotor turns at its speed."""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array
from .branch import LAGS, Branches
from .groups import Lag
from .receptance import Receptance

_LONE_STEPS = 40  # of a fixed-point iteration, whose errors fall by the slope of the brake
_REFINEMENTS, _PLACES = 2, np.linspace(0.0, 1.0, 65)  # each time what lies between two is kept


def follow(
    branches: Branches, receptance: Receptance, lag: Lag, rows: Array
) -> tuple[Array, Array]:
    """Where weights turn below the peak while the rotor turns at its speed.

    Args:
        rows: indices (r,) of branches.

    Returns:
        Their speed (r,), NaN where they cannot be left behind, and the phases (r, c).
    """
    phases = branches.phases[rows, branches.top[rows]]
    frequency = np.full(len(rows), np.nan)
    low, high = np.zeros((2, len(rows)))
    found = []
    for k, row in enumerate(rows):
        if (started := _bracket(branches, int(row))) is not None:
            low[k], high[k], phases[k] = started
            found.append(k)
    if found:
        at = np.array(found)
        numbers = branches.numbers[rows[at]]
        crossing = _Crossing(receptance, lag, branches.speed, numbers)
        frequency[at], phases[at] = crossing.between(low[at], high[at], phases[at])
    return frequency, phases


def _bracket(branches: Branches, row: int) -> tuple[float, float, Array] | None:
    """Points of the rising side between which w + lag passes the rotor's speed."""
    peak, held, speed = branches.peak[row], branches.lag[row], branches.speed
    if not speed < peak + held:
        return None
    w, lags = branches.frequency[row], branches.lags[row]
    high = float(min(peak, (1.0 - LAGS) * speed))
    at_high = _between(w, lags, high) if high < peak else held
    if not high + at_high > speed:
        return None
    for j in range(int(np.searchsorted(w, high)) - 1, -1, -1):
        if np.isnan(lags[j]):
            return None
        if w[j] + lags[j] <= speed:
            return float(w[j]), high, branches.phases[row, j].copy()
        if j and w[j - 1] + lags[j - 1] > w[j] + lags[j]:
            return None  # a trough: the side of a lower natural frequency begins
        high = float(w[j])
    return None


def _between(w: Array, lags: Array, at: float) -> float:
    """Lag at a speed on the rising side; NaN where there is no motion."""
    with np.errstate(divide="ignore", invalid="ignore"):
        found = float(np.exp(np.interp(at, w, np.log(lags))))
    return found if at >= w[0] else math.nan


def largest_slip(branches: Branches) -> float:
    """Lag [rad/s] that natural frequencies above the rotor's speed hold there, peak or not."""
    at = (1.0 - LAGS) * branches.speed
    rows = np.flatnonzero(branches.own.frequency > at).tolist()
    lags = (_between(branches.frequency[row], branches.lags[row], at) for row in rows)
    return max((lag for lag in lags if lag > 0.0), default=0.0)


def lone_lag(branches: Branches, receptance: Receptance, lag: Lag) -> float:
    """Lag [rad/s] at which one weight is left behind beyond all natural frequencies; 0: at none.

    There the brake of strongly damped supports rises with the speed, m^2 c w/M^2 of a planar rotor,
    so that the motion is stable.  Two weights part until nothing brakes them.
    """
    at = (1.0 - LAGS) * branches.speed
    single = branches.numbers.sum(axis=1) == 1
    single &= branches.own.frequency <= at
    if sum(one.count for one in lag.groups) == 2 or not single.any():
        return 0.0
    numbers = np.unique(branches.numbers[single], axis=0)
    w, lowest = np.full((len(numbers), 1), at), branches.own.frequency[single].max()
    for _ in range(_LONE_STEPS):  # the brake changes slowly with the speed there
        found = lag.at(receptance, w, branches.speed, numbers, np.zeros(numbers.shape))[0]
        found = np.nan_to_num(found)
        w = np.clip(branches.speed - found, lowest, at)
    held = (found > LAGS * branches.speed) & (w > lowest)
    return float(np.where(held, found, 0.0).max())


class _Crossing:
    """Roots of w + lag = Om of several rows, by bisection with several points at once."""

    def __init__(self, receptance: Receptance, lag: Lag, speed: float, numbers: Array) -> None:
        self._receptance, self._lag, self._speed = receptance, lag, speed
        self._numbers = numbers

    def between(self, low: Array, high: Array, phases: Array) -> tuple[Array, Array]:
        """Roots (r,) between points (r,), and the phases (r, c) there."""
        rows = np.arange(len(low))
        left = np.zeros((2, len(low)))
        for _ in range(_REFINEMENTS):
            w = low[:, None] + (high - low)[:, None] * _PLACES
            lags, turned = self._lag.at(self._receptance, w, self._speed, self._numbers, phases)
            excess = w + lags - self._speed
            beyond = ~(excess[:, 1:] <= 0.0)
            at = np.where(beyond.any(axis=1), beyond.argmax(axis=1), len(_PLACES) - 2)
            low, high = w[rows, at], w[rows, at + 1]
            left = np.stack([excess[rows, at], excess[rows, at + 1]])
            there = turned[rows, at]
            phases = np.where(np.isnan(there), phases, there)
        with np.errstate(divide="ignore", invalid="ignore"):
            part = -left[0] / (left[1] - left[0])
        part = np.where((part >= 0.0) & (part <= 1.0), part, 0.5)
        return low + part * (high - low), phases
