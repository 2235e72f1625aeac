"""The brake of weights near each natural frequency of the rotor, while it turns at one speed.

Below a natural frequency the lag that the vibration can hold rises with the speed w of the weights,
up to a peak (w_p, L_p); motions on this side are stable, those beyond it are not: there the brake
falls, and bunched weights repel each other.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Indices
from .groups import Lag, ordered_numbers
from .peaks import find_peaks, first_peaks
from .receptance import Poles, Receptance

_ABOVE = np.array([0.0, 0.12, 0.3, 0.6, 1.0, 1.6, 2.4, 3.4])  # half widths, beyond a pole
_NEAR_BELOW = np.array([0.12, 0.3, 0.6, 1.0, 1.6, 2.4])
_POINTS_BELOW = 16
_FAR_BELOW = np.linspace(0.0, 1.0, _POINTS_BELOW)
_SCREEN = np.array([-1.0, -0.3, 0.0, 0.3, 1.0])  # the first look
_LOWEST = 0.03  # of a natural frequency: how far down motions are looked for
_NARROWEST = 1e-7  # half width over frequency, of undamped rotors too
_SMALLEST_LAG = 1e-3  # of a peak's speed: weights that lag less are let go at once
_POLE_STEPS = 2
_FARTHEST_POLE = 1.5  # of the rotor's speed: weights lag below a natural frequency above it too
LAGS = 0.02  # of the rotor's speed: weights that lag by more are left behind
WITH = 0.004  # of it: weights that lag by less turn with the rotor
_FARTHEST_PEAK = 3.0  # half widths between a pole and its peak
# limit of the drag over the drag that can be 1; near the rotor's speed phases turn over so quickly
# that a fine grid finds several times that of a coarse one
_WORTH_A_GRID, _WORTH_REFINING = 0.25, 0.15
_FEW = 40  # rows that are not worth a first look
NEARLY = 0.8  # the same, at a drag beside which it can be 1
_NOT_HELD = 0.5  # at most, where no motion belongs to it
_SAME_PEAK = 0.05  # half widths: peaks so near are one


@dataclass(frozen=True, eq=False)
class Branches:
    """Lag over speed of the weights near every natural frequency.

    b rows: a natural frequency and a combination of weights each.

    Attributes:
        speed: of the rotor [rad/s].
        poles: natural frequencies with all weights fixed to the rotor.
        own: (b,) that of a row, whose other weights turn with the rotor.
        pole: (b,) index of the natural frequency.
        lowest: (b,) half way to the next lower one [rad/s].
        numbers: (b, c) of weights left behind, by group.
        peak, lag: (b,) speed of the weights at the peak, and how far they can lag there [rad/s];
            NaN where there is none.
        frequency, lags: (b, j) points along the brake, ascending [rad/s].
        phases: (b, j, c) of the groups there [rad].
        top: (b,) index of the point nearest to the peak.
    """

    speed: float
    poles: Poles
    own: Poles
    pole: Indices
    lowest: Array
    numbers: Array
    peak: Array
    lag: Array
    frequency: Array
    lags: Array
    phases: Array
    top: Indices


def find_branches(receptance: Receptance, lag: Lag, speed: float) -> Branches:
    """Branches of natural frequencies below the rotor's speed and near it, for k = 1 to N."""
    poles = receptance.poles(speed)
    poles = poles.select(poles.frequency < _FARTHEST_POLE * speed)
    reaches = np.abs(poles.shapes[:, lag.planes])
    numbers = [ordered_numbers(lag.groups, lag.drags, reach) for reach in reaches]
    ways = 1 if len(lag.groups) == 1 else 2
    every = np.array([n[..., way] for n in numbers for way in range(ways)])
    every = every.reshape(-1, len(lag.groups))
    many = ways * sum(group.count for group in lag.groups)
    pole = np.repeat(np.arange(len(numbers)), many)
    # both ways often leave the same weights behind
    _, at = np.unique(np.hstack([pole[:, None], every]), axis=0, return_index=True)
    return _branches(receptance, lag, speed, poles, pole[at], every[at])


def ratios_at_drags(
    branches: Branches, receptance: Receptance, lag: Lag, rows: Indices, factors: Array
) -> Array:
    """L(d)/d of some of the branches (b,) whose drags are multiplied by one factor (b,) each.

    0 where it is far below 1.  From `NEARLY` on only where a motion belongs to it.
    """
    # below a natural frequency above the rotor's speed weights can be held far from its peak
    above = branches.poles.frequency[branches.pole[rows]] > branches.speed
    everywhere = np.full(len(rows), len(rows) <= _FEW) | above
    found = np.zeros(len(rows))
    for which in (True, False):
        part = np.flatnonzero(everywhere == which)
        if len(part):
            some = rows[part], factors[part]
            found[part] = _ratios(branches, receptance, lag, *some, everywhere=which)
    return found


def _ratios(
    branches: Branches,
    receptance: Receptance,
    lag: Lag,
    rows: Indices,
    factors: Array,
    *,
    everywhere: bool,
) -> Array:
    """The same along the whole grid, or where a first look finds it worth while."""
    poles, pole, numbers = branches.poles, branches.pole[rows], branches.numbers[rows]
    speed = branches.speed
    own = near_poles(receptance, lag, poles.select(pole), speed, numbers, factors)
    at = np.arange(len(rows))
    if not everywhere:
        kept = _worth_a_grid(receptance, lag, speed, poles, pole, numbers, own, factors)
        at = np.flatnonzero(kept)

    def along(first: int) -> Branches:
        near = poles, pole[at], numbers[at], own.select(at), factors[at]
        return _coarse(receptance, lag, speed, *near, first)

    found = np.zeros(len(rows))
    near = along(0 if everywhere else _POINTS_BELOW - 1)  # no peak is as far below
    if len(lag.groups) > 1:
        worth = np.flatnonzero(drag_ratios(near) > _WORTH_REFINING)
        _refine(near, receptance, lag, worth, factors[at[worth]])
    found[at] = ratios = drag_ratios(near)
    if len(high := np.flatnonzero(ratios > NEARLY)):
        if not everywhere:
            at = at[high]
            near = replace(along(0), peak=near.peak[high], lag=near.lag[high])
            ratios = drag_ratios(near)
        found[at] = np.where((ratios <= NEARLY) | _can_be_held(near), ratios, _NOT_HELD)
    return found


def _worth_a_grid(
    receptance: Receptance,
    lag: Lag,
    speed: float,
    poles: Poles,
    pole: Indices,
    numbers: Array,
    own: Poles,
    factors: Array,
) -> NDArray[np.bool_]:
    """Whether L(d)/d is not far below 1 (b,) at a few points, or there is no motion at some."""
    points = own.frequency[:, None] + own.decay[:, None] * _SCREEN
    points = np.minimum(points, (1.0 - LAGS) * speed)
    start = _mode_angles(poles, lag, pole)
    lags, _ = lag.at(receptance, points, speed, numbers, start, factors)
    low = (lags <= _WORTH_A_GRID * (speed - points)).all(axis=1)
    return np.asarray(~low & (own.decay > 0.0))


def _branches(
    receptance: Receptance, lag: Lag, speed: float, poles: Poles, pole: Indices, numbers: Array
) -> Branches:
    """Those of numbers (b, c) of weights near poles (b,), by rising pole."""
    own = near_poles(receptance, lag, poles.select(pole), speed, numbers)
    found = _coarse(receptance, lag, speed, poles, pole, numbers, own)
    rows = np.flatnonzero(~np.isnan(found.peak))
    if len(rows) and len(lag.groups) > 1:
        _refine(found, receptance, lag, rows)
    _drop_twins(found)
    return found


def _coarse(
    receptance: Receptance,
    lag: Lag,
    speed: float,
    poles: Poles,
    pole: Indices,
    numbers: Array,
    own: Poles,
    factors: float | Array = 1.0,
    first: int = 0,
) -> Branches:
    """The same along a grid, from a point of it on, with peaks as high as between its points."""
    frequency = _grid(own)[:, first:]
    _move_to(frequency, (1.0 - LAGS) * speed)
    start = _mode_angles(poles, lag, pole)
    lags, phases = lag.at(receptance, frequency, speed, numbers, start, factors)
    peak, held, top = _peaks(frequency, lags, own)
    lower = np.append(0.0, poles.frequency)[pole]
    lowest = np.where(pole > 0, 0.5 * (lower + poles.frequency[pole]), 0.0)
    return Branches(
        speed, poles, own, pole, lowest, numbers, peak, held, frequency, lags, phases, top
    )


def _mode_angles(poles: Poles, lag: Lag, pole: Indices) -> Array:
    """Phases (b, c) of the groups' planes in some modes [rad]."""
    return np.angle(poles.shapes[:, lag.planes]).astype(float)[pole]


def near_poles(
    receptance: Receptance,
    lag: Lag,
    poles: Poles,
    speed: float | Array,
    numbers: Array,
    factors: float | Array = 1.0,
) -> Poles:
    """Natural frequencies (b,) while numbers (b, c) of weights are left behind."""
    found = poles
    for _ in range(_POLE_STEPS):
        forward = lag.others(found.frequency[:, None], speed, numbers, 1, factors)[..., 0]
        found = receptance.moved(poles, forward)
    return found


def _refine(
    branches: Branches,
    receptance: Receptance,
    lag: Lag,
    rows: Indices,
    factors: float | Array = 1.0,
) -> None:
    """Peaks of several groups, which can turn over between two points."""
    top = branches.top[rows]
    around = branches.frequency[rows, top - 1], branches.frequency[rows, top + 1]
    numbers, phases = branches.numbers[rows], branches.phases[rows, top]
    near = branches.own.select(rows), around, branches.lowest[rows]
    found = first_peaks(receptance, lag, *near, branches.speed, numbers, phases, factors)
    known = ~np.isnan(found[0])
    branches.peak[rows[known]], branches.lag[rows[known]] = (x[known] for x in found)


def _grid(poles: Poles) -> Array:
    """Points (m, j) about each pole, ascending [rad/s]."""
    centre = poles.frequency[:, None]
    width = np.maximum(poles.decay, _NARROWEST * poles.frequency)[:, None]
    farthest = (1.0 - _LOWEST) * centre / width
    start = np.minimum(4.0, 0.5 * farthest)
    far = start * (farthest / start) ** _FAR_BELOW
    near = _NEAR_BELOW * np.minimum(1.0, start / 4.0)
    below = np.hstack([near, far])[:, ::-1]
    return np.hstack([centre - width * below, centre + width * _ABOVE])


def _move_to(frequency: Array, at: float) -> None:
    """The nearest points of each row to a frequency within it."""
    rows = np.flatnonzero((frequency[:, 0] < at) & (frequency[:, -1] > at))
    frequency[rows, np.abs(frequency[rows] - at).argmin(axis=1)] = at


def _peaks(frequency: Array, lags: Array, poles: Poles) -> tuple[Array, Array, Indices]:
    """Local maximum of each row that is nearest to its pole, by the inverse of a resonance."""
    width = np.maximum(poles.decay, _NARROWEST * poles.frequency)
    away = np.abs(frequency - poles.frequency[:, None]) / width[:, None]
    peak, held, top = find_peaks(frequency, lags, np.where(away > _FARTHEST_PEAK, np.inf, away))
    small = ~(held > _SMALLEST_LAG * peak) | ~(poles.decay > 0.0)
    return np.where(small, np.nan, peak), np.where(small, np.nan, held), top


def _drop_twins(branches: Branches) -> None:
    """One peak that several poles share is that of the first of them."""
    same = (branches.numbers[:, None] == branches.numbers).all(axis=2)
    same &= branches.pole < branches.pole[:, None]
    for row in np.flatnonzero(same.any(axis=1)).tolist():
        apart = np.abs(branches.peak[same[row]] - branches.peak[row])
        if (apart <= _SAME_PEAK * branches.own.decay[row]).any():
            branches.peak[row] = branches.lag[row] = np.nan


def drag_ratios(branches: Branches) -> Array:
    """Drag over the present one (b,) below which weights are left behind; 0: none are.

    Of k < N with the others at their present drag.
    """
    speed = branches.speed
    with np.errstate(invalid="ignore"):
        ratios = branches.lag / (speed - branches.peak)
        # the peak is near the rotor's speed, or above it
        near = np.flatnonzero(speed - branches.peak < LAGS * speed)
    if len(near):
        ratios[near] = _below_speed(branches, near)
    return np.where(np.isfinite(ratios), np.maximum(ratios, 0.0), 0.0)


def _below_speed(branches: Branches, rows: Indices) -> Array:
    """Largest lag over Om - w (r,) of brakes that rise up to the rotor's speed."""
    w, lags, speed = branches.frequency[rows], branches.lags[rows], branches.speed
    below = w <= (1.0 - LAGS) * speed
    with np.errstate(divide="ignore", invalid="ignore"):
        ratios = np.where(below & (lags > 0.0), lags / (speed - w), 0.0).max(axis=1)
    there = _nearest_lags(branches, rows) / (LAGS * speed)
    return np.where(below[:, 0] & (there > ratios), there, ratios)


def _nearest_lags(branches: Branches, rows: Indices) -> Array:
    """Lags (r,) at the speed from which on weights turn with the rotor."""
    w, at = branches.frequency[rows], (1.0 - LAGS) * branches.speed
    return branches.lags[rows, np.clip((w < at).sum(axis=1), 0, w.shape[1] - 1)]


def _can_be_held(branches: Branches) -> NDArray[np.bool_]:
    """Whether there is a motion (b,) on the rising side of the brake, as `follow` finds it."""
    w, lags, speed, every = branches.frequency, branches.lags, branches.speed, len(branches.peak)
    nearest = (1.0 - LAGS) * speed
    with np.errstate(invalid="ignore"):
        near = ~(branches.peak <= nearest)
        high = np.where(near, nearest, branches.peak)
        at_high = np.where(near, _nearest_lags(branches, np.arange(every)), branches.lag)
        total = w + lags
        falls = np.zeros(w.shape, bool)
        falls[:, 1:] = total[:, :-1] > total[:, 1:]
        ends = (np.isnan(lags) | (total <= speed) | falls) & (w < high[:, None])
        last = w.shape[1] - 1 - ends[:, ::-1].argmax(axis=1)
        crosses = total[np.arange(every), last] <= speed
        return np.asarray(
            crosses & (high + at_high > speed) & (branches.peak + branches.lag > speed)
        )
