"""Speed of the rotor at which weights that are left behind are let go.

The peak (w_p, L_p) of the brake belongs to one speed Om of the rotor.  Gyroscopic terms and
internal damping move it with Om; weights are let go where Om passes w_p(Om) + L_p(Om), which for a
tilting mode that rises with the speed may never be.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array
from .branch import Branches, find_peaks, near_poles
from .groups import Lag
from .receptance import Receptance

_FARTHEST = 10.0  # operating speeds up to which a release is looked for
_BRACKETING, _CLOSING = 40, 20  # steps at most
_LARGEST_STEP = 0.25  # of a speed: natural frequencies are followed from one to the next
_RELEASED = 1e-5  # relative
_AROUND = np.array([-2.0, -1.2, -0.7, -0.4, -0.2, 0.0, 0.2, 0.4, 0.7, 1.2, 2.0])  # half widths


def release_speeds(branches: Branches, receptance: Receptance, lag: Lag, rows: Array) -> Array:
    """(r,) of some branches [rad/s]; infinite: not up to `_FARTHEST` times the rotor's speed."""
    found = (branches.peak + branches.lag)[rows]
    all_left = branches.numbers[rows].sum(axis=1) == sum(one.count for one in lag.groups)
    fixed = all_left & (not receptance.follows_speed)
    if fixed.any():  # of weights that turn with the rotor, the swing follows its speed
        found[~fixed] = release_speeds(branches, receptance, lag, rows[~fixed])
        return found
    if not len(rows):
        return found
    peaks = _MovingPeaks(branches, receptance, lag, rows)
    speed = np.full(len(rows), branches.speed)
    excess = found - speed
    other, there, sign = speed.copy(), excess.copy(), np.sign(excess)
    for _ in range(_BRACKETING):
        same = (np.sign(there) == sign) & (other < _FARTHEST * branches.speed)
        if not same.any():
            break
        largest = _LARGEST_STEP * other
        step = np.clip(1.2 * there + sign * 0.01 * other, -largest, largest)
        lowest = 0.5 * (other + peaks.place)  # the excess is positive at the peak itself
        ahead = np.where(same, np.maximum(other + step, lowest), other)
        speed, excess = np.where(same, other, speed), np.where(same, there, excess)
        other, there = ahead, np.where(same, peaks(ahead), there)
    unending = (np.sign(there) == sign) & (sign > 0.0)
    root = _close(peaks, speed, excess, other, there)
    lost = (np.sign(there) == sign) & (sign < 0.0)  # not followed down to where it is let go
    return np.where(unending, math.inf, np.where(lost, math.nan, root))


class _MovingPeaks:
    """By how much w_p + L_p exceeds speeds of the rotor, one for each row."""

    def __init__(self, branches: Branches, receptance: Receptance, lag: Lag, rows: Array) -> None:
        self._receptance, self._lag = receptance, lag
        pole, self._numbers = branches.pole[rows], branches.numbers[rows]
        self._poles = branches.poles.select(pole)
        self.place = branches.peak[rows]
        self._rate = -self._poles.decay + 1j * self._poles.frequency
        own = branches.own.select(rows)
        self._offset = (self.place - own.frequency) / own.decay
        self._phases = branches.phases[rows, branches.top[rows]]

    def __call__(self, speeds: Array) -> Array:
        if self._receptance.follows_speed:
            rates = self._receptance.rates(speeds)
            nearest = np.abs(rates - self._rate[:, None]).argmin(axis=1)
            self._rate = rates[range(len(rates)), nearest]
        poles = self._poles._replace(
            frequency=self._rate.imag.astype(float), decay=-self._rate.real.astype(float)
        )
        own = near_poles(self._receptance, self._lag, poles, speeds, self._numbers)
        frequency, decay = own.frequency, own.decay
        many, points = len(speeds), len(_AROUND)
        w = frequency[:, None] + decay[:, None] * (self._offset[:, None] + _AROUND)
        args = [np.repeat(a, points, axis=0) for a in (self._numbers, self._phases)]
        at = (w.reshape(-1), np.repeat(speeds, points))
        lags, _ = self._lag.at(self._receptance, *at, *args)
        peak, held, _ = find_peaks(w, lags.reshape(many, points), np.abs(_AROUND) + 0.0 * w)
        ended = np.isnan(peak) | (decay <= 0.0)
        self.place = np.where(ended, self.place, peak)
        self._offset = np.where(ended, self._offset, (self.place - frequency) / decay)
        excess = np.where(ended, -speeds, peak + held - speeds)
        return np.where(decay <= 0.0, speeds, excess)  # not let go before the rotor is unstable


def _close(peaks: _MovingPeaks, a: Array, at_a: Array, b: Array, at_b: Array) -> Array:
    """Roots between brackets, by the Illinois method, or bisection where a motion ends."""
    root = b
    for _ in range(_CLOSING):
        with np.errstate(divide="ignore", invalid="ignore"):
            root = b - at_b * (b - a) / (at_b - at_a)
        jumps = (at_a <= -a) | (at_b <= -b) | ~np.isfinite(root)  # the motion ends within
        root = np.where(jumps, 0.5 * (a + b), root)
        found = peaks(root)
        crossed = found * at_b < 0.0
        a, at_a = np.where(crossed, b, a), np.where(crossed, at_b, 0.5 * at_a)
        b, at_b = root, found
        if (np.abs(at_b) <= _RELEASED * root).all() or (np.abs(b - a) <= _RELEASED * root).all():
            break
    return root
