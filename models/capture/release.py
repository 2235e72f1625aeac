"""Speed of the rotor at which weights that are left behind are let go.

The peak (w_p, L_p) of the brake belongs to one speed Om of the rotor.  Gyroscopic terms and
internal damping move it with Om; weights are let go where Om passes w_p(Om) + L_p(Om), which for a
tilting mode that rises with the speed may never be.

The peak is followed from speed to speed.  Where some weights turn with the rotor (k < N) and its
natural frequency is near the rotor's speed, modes mix and the peak of one becomes that of another:
no release speed is stated there.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Complex, Indices
from .branch import Branches, near_poles
from .groups import Lag
from .peaks import find_peaks, first_peaks
from .receptance import Poles, Receptance
from .roots import Roots

Truths = NDArray[np.bool_]
_FARTHEST = 10.0  # operating speeds up to which a release is looked for
_BRACKETING = 30  # steps at most
_STEP_OF_ALL, _STEP_OF_PART = 0.5, 0.25  # of a speed: peaks are followed from one to the next
_FLATTEST, _OVERSHOT, _BEYOND = -0.2, 1.02, 2e-4  # slope of an excess; a step passes its root
_SMALLEST_PART = 0.01  # of such a step, where a peak is lost
_SAME_SPEED = 1e-5  # relative
_PART_NEAREST = 0.65  # of the rotor's speed: above it modes mix, and k < N cannot be followed
_PART_FARTHEST = 2.0  # times the rotor's speed up to which k < N of several groups are followed
_FAR_BEYOND = 2.0  # times this: a step goes there at once
_NEAR = 0.5  # half widths about its former place within which a peak is looked for first
_AROUND = np.array([-2.0, -1.2, -0.7, -0.4, -0.2, 0.0, 0.2, 0.4, 0.7, 1.2, 2.0])  # half widths


def release_speeds(branches: Branches, receptance: Receptance, lag: Lag, rows: Array) -> Array:
    """(r,) of some branches [rad/s]; infinite: not up to `_FARTHEST` times the rotor's speed.

    Returns:
        NaN where the peak cannot be followed to the speed at which they are let go, or where that
        speed lies beyond a table of the bearings.
    """
    released = (branches.peak + branches.lag)[rows]
    all_left = branches.numbers.sum(axis=1)[rows] == sum(one.count for one in lag.groups)
    near = branches.own.frequency[rows] > _PART_NEAREST * branches.speed
    moves = ~all_left | receptance.follows_speed  # weights that turn with the rotor swing with it
    released[moves & near & ~all_left] = math.nan
    at = np.flatnonzero(moves & (all_left | ~near))
    if len(at):
        limit = np.full(len(at), _FARTHEST * branches.speed)
        if len(lag.groups) > 1:
            limit[~all_left[at]] = _PART_FARTHEST * branches.speed
        largest = np.where(all_left[at], _STEP_OF_ALL, _STEP_OF_PART)
        far = ~all_left[at] & (released[at] > _FAR_BEYOND * limit)
        largest[far] = np.maximum(largest, limit / branches.speed - 1.0)[far]
        peaks = _MovingPeaks(branches, receptance, lag, rows[at])
        released[at] = _followed(peaks, limit, largest)
        released[at[~all_left[at] & (released[at] > limit)]] = math.nan
    low, high = receptance.coefficients.lowest, receptance.coefficients.highest
    if high < math.inf:  # bearings are not known beyond their tables
        released[~((released >= low) & (released <= high))] = math.nan
    return released


def _followed(peaks: _MovingPeaks, limit: Array, largest: Array) -> Array:
    """Release speeds up to limits (r,); `largest` steps over a speed."""
    brackets, roots = _Brackets(peaks, limit, largest), Roots(len(limit))
    searched, known = brackets.open(), roots.open()
    for _ in range(2 * _BRACKETING):
        rows = np.concatenate([searched, known])
        if not (count := len(rows)):
            break
        first = len(searched)
        x = np.empty(count)
        x[:first], x[first:] = brackets.ahead(searched), roots.guess(known)
        values = peaks(x, rows)
        if len(known):
            roots.take(known, x[first:], values[first:])
        if first:
            brackets.take(searched, x[:first], values[:first])
            closed = searched[brackets.closed(searched)]
            roots.begin(closed, brackets.ends[:, closed])
            searched = brackets.open()
        known = roots.open()
    return np.where(brackets.never(), math.inf, roots.found)


class _Brackets:
    """Two speeds and their excesses, between which the sign changes.

    Attributes:
        ends: (4, r) a speed, the excess there, the last speed, and the excess there.
    """

    def __init__(self, peaks: _MovingPeaks, limit: Array, largest: Array) -> None:
        self._peaks, self._limit, self._largest = peaks, limit, largest
        now = np.full(len(limit), peaks.speed)
        self.ends = np.stack([now, peaks.excess, now, peaks.excess])
        self._sign, self._part = np.sign(peaks.excess), np.ones(len(limit))

    def open(self) -> Indices:
        """Rows whose sign has not changed yet."""
        _, _, other, there = self.ends
        same = (there * self._sign > 0.0) & (other < self._limit) & (self._part > _SMALLEST_PART)
        return np.flatnonzero(same)

    def closed(self, rows: Indices) -> Truths:
        """Which of some rows have a sign that has changed."""
        return np.asarray(self.ends[1, rows] * self.ends[3, rows] <= 0.0)

    def never(self) -> Truths:
        """Rows whose excess is positive up to the limit."""
        _, excess, other, there = self.ends
        return np.asarray((there > 0.0) & (excess > 0.0) & (other >= self._limit))

    def ahead(self, rows: Indices) -> Array:
        """The next speeds of some rows."""
        last, excess, now, there = self.ends[:, rows]
        most = self._largest[rows] * now
        with np.errstate(divide="ignore", invalid="ignore"):
            slope = np.where(now == last, -1.0, (there - excess) / (now - last))
        ahead = -_OVERSHOT * there / np.minimum(slope, _FLATTEST)
        step = np.clip(ahead + self._sign[rows] * _BEYOND * now, -most, most)
        lowest = 0.5 * (now + self._peaks.place[rows])  # the excess is positive at the peak itself
        return np.maximum(now + step * self._part[rows], lowest)

    def take(self, rows: Indices, speeds: Array, values: Array) -> None:
        """Excesses there, NaN where the peak is lost."""
        lost = np.isnan(values)
        part = self._part[rows]
        self._part[rows] = np.where(lost, 0.25 * part, np.minimum(1.0, 2.0 * part))
        kept = rows[~lost]
        self.ends[:2, kept] = self.ends[2:, kept]
        self.ends[2:, kept] = speeds[~lost], values[~lost]


class _MovingPeaks:
    """By how much w_p + L_p exceeds speeds of the rotor, one for each row."""

    def __init__(self, branches: Branches, receptance: Receptance, lag: Lag, rows: Array) -> None:
        self._receptance, self._lag = receptance, lag
        pole, self._numbers = branches.pole[rows], branches.numbers[rows]
        self._poles = branches.poles.select(pole)
        self.place, self.speed = branches.peak[rows], branches.speed
        self.excess = self.place + branches.lag[rows] - branches.speed
        self._rate = -self._poles.decay + 1j * self._poles.frequency
        own = branches.own.select(rows)
        self._offset = (self.place - own.frequency) / own.decay
        self._lowest = branches.lowest[rows] / own.frequency
        self._phases = branches.phases[rows, branches.top[rows]]
        self._seen = np.full(len(rows), branches.speed)
        self._slope = np.zeros(len(rows), complex)

    def __call__(self, speeds: Array, rows: Indices) -> Array:
        """Of some rows, at a speed each; NaN where the peak is lost."""
        numbers = self._numbers[rows]
        follows = self._receptance.follows_speed
        rate = self._follow(speeds, rows) if follows else self._rate[rows]
        poles = self._poles.select(rows)._replace(
            frequency=rate.imag.astype(float), decay=-rate.real.astype(float)
        )
        own = near_poles(self._receptance, self._lag, poles, speeds, numbers)
        peak, held, lost = self._peaks(own, speeds, rows)
        there = ~np.isnan(peak) & (own.decay > 0.0)
        self.place[rows[there]] = peak[there]
        self._offset[rows[there]] = ((peak - own.frequency) / own.decay)[there]
        excess = np.where(there, peak + held - speeds, np.where(lost, np.nan, -speeds))
        if follows:
            self._keep(speeds[~lost], rate[~lost], rows[~lost])
        return np.where(own.decay <= 0.0, speeds, excess)  # not let go before it is unstable

    def _peaks(self, own: Poles, speeds: Array, rows: Indices) -> tuple[Array, Array, Truths]:
        """Place and height of peaks, NaN where there is none; and which are lost."""
        peak, held = np.full((2, len(rows)), np.nan)
        if len(self._lag.groups) > 1:
            peak, held = self._first(own, self._offset[rows], _NEAR, speeds, rows)
        lost = np.isnan(peak) & (own.decay > 0.0)
        at = np.flatnonzero(np.isnan(peak))
        if len(at):
            peak[at], held[at], lost[at] = self._far(own.select(at), speeds[at], rows[at])
        return peak, held, lost

    def _far(self, own: Poles, speeds: Array, rows: Indices) -> tuple[Array, Array, Truths]:
        """The same in a wider range about the places where they are expected."""
        numbers, phases = self._numbers[rows], self._phases[rows]
        offsets = self._offset[rows, None] + _AROUND
        w = own.frequency[:, None] + own.decay[:, None] * offsets
        lags, _ = self._lag.at(self._receptance, w, speeds, numbers, phases)
        peak, held, top = find_peaks(w, lags, np.abs(_AROUND))
        lost = np.isnan(peak) & (own.decay > 0.0) & ~np.isnan(lags).any(axis=1)
        if len(self._lag.groups) > 1 and len(fine := np.flatnonzero(~np.isnan(peak))):
            centre = offsets[fine, top[fine]]
            reach = np.maximum(*np.abs(_AROUND[top[fine] + [[1], [-1]]] - _AROUND[top[fine]]))
            found = self._first(own.select(fine), centre, reach, speeds[fine], rows[fine])
            known = ~np.isnan(found[0])
            peak[fine[known]], held[fine[known]] = (x[known] for x in found)
        return peak, held, lost

    def _first(
        self, own: Poles, offset: Array, reach: float | Array, speeds: Array, rows: Indices
    ) -> tuple[Array, Array]:
        """`first_peaks` within so many half widths about an offset from the natural frequency."""
        centre, half = own.frequency + own.decay * offset, own.decay * reach
        around = centre - half, centre + half
        lowest = self._lowest[rows] * own.frequency
        args = around, lowest, speeds, self._numbers[rows], self._phases[rows]
        return first_peaks(self._receptance, self._lag, own, *args)

    def _follow(self, speeds: Array, rows: Indices) -> Complex:
        """The eigenvalues nearest to those expected from two speeds before."""
        expected = self._rate[rows] + (speeds - self._seen[rows]) * self._slope[rows]
        rates = self._receptance.rates(speeds)
        nearest = np.abs(rates - expected[:, None]).argmin(axis=1)
        return np.asarray(rates[range(len(rates)), nearest])

    def _keep(self, speeds: Array, rates: Complex, rows: Indices) -> None:
        """Go on from here."""
        moved = speeds - self._seen[rows]
        far = np.abs(moved) > _SAME_SPEED * speeds
        slope = (rates - self._rate[rows]) / np.where(far, moved, 1.0)
        self._slope[rows[far]] = slope[far]
        self._rate[rows], self._seen[rows] = rates, speeds
