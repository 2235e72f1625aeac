"""Names of steady motions, and the rules by which a run is given one.

A run is looked at in `WINDOWS` windows at its end, each of several revolutions.  Of every window it
has the largest distance of a station from the middle and, of every weight, how much it lags behind
the rotor on average.

balanced: all weights turn with the rotor, which vibrates less than `BALANCED` of what it does
    without balancers, and no more than before.  A rotor without unbalance is compared with what its
    weights alone make it vibrate by, all on one side.
left behind: some weights turn at a steady speed below the rotor's, the same for all of them or
    beside several natural frequencies.  The others turn with the rotor or slip by less than 2 % of
    its speed, as where no unbalance holds them.  Where the vibration beats, through all windows,
    and of a run five times as long: weights that slip now and then do not do so in each window.
synchronous, not balanced: all weights rest in the rotor, and it vibrates on.
two frequencies: the weights turn with the rotor and swing steadily, or slip by less than 2 % of
    its speed.
irregular: none of these, and still so in a run twenty times as long.
undecided: vibration or lag still drift there.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from ...models.arrays import Array
from ...models.capture import Capture
from ...models.capture.branch import LAGS, WITH

WINDOWS, LATE = 8, 4  # windows, and how many of the last ones decide
BALANCED = 0.05  # of the vibration without balancers
GROWS = 1.5  # times the vibration of the first late window: it is not settled
STEADY_LAG, STEADY_VIBRATION = 0.02, 0.06  # relative changes over the late windows
ALIKE = 0.02  # relative: lags of weights that are left behind together
CALM = 0.02  # the same of a vibration that no longer look will find to change
BEATS = 0.15  # relative: by so much the vibration of a steady motion differs between windows
LARGEST_SWING = 2.0  # rad, peak to peak, of a weight that is left behind steadily
RESTS = 0.02  # rad by which a weight at rest in the rotor moves in a window
BESIDE = 1.25  # times a natural frequency: weights that turn faster are not beside it
DRIFT = 0.01  # relative: by so much a value that moves one way through all windows changes


class Kind(IntEnum):
    """What a run comes to."""

    FAILED = -1
    UNDECIDED = 0
    BALANCED = 1
    SYNCHRONOUS = 2
    BEHIND = 3
    TWO_FREQUENCIES = 4
    IRREGULAR = 5
    SLOW_ROTOR = 6


@dataclass(frozen=True, eq=False)
class Seen:
    """Runs (r) in windows (j), with weights (k).

    Attributes:
        speed: (r, j) mean of the rotor [rad/s].
        vibration: (r, j) largest distance of a station from the middle [m].
        lag: (r, j, k) mean speed of the rotor less that of the weight [rad/s].
        swing: (r, j, k) by how much a weight's angle in the rotor deviates from steady turning,
            peak to peak [rad].
        seconds: of a window.
    """

    speed: Array
    vibration: Array
    lag: Array
    swing: Array
    seconds: float


@dataclass(frozen=True, eq=False)
class Found:
    """(r,) of every run.

    Attributes:
        kind: of `Kind`.
        weights: how many are left behind.
        frequency: at which they turn [rad/s]; NaN: none, or beside several natural frequencies.
        vibration: in the last windows [m].
        decided: whether a longer look would find the same.
        calm: whether the vibration changes little between the last windows.
    """

    kind: Array
    weights: Array
    frequency: Array
    vibration: Array
    decided: NDArray[np.bool_]
    calm: NDArray[np.bool_]

    def replace(self, rows: NDArray[np.intp], other: Found) -> None:
        """Take over what another look has found of some runs."""
        for one in fields(self):
            getattr(self, one.name)[rows] = getattr(other, one.name)


def classify(seen: Seen, alone: float, speed: float) -> Found:
    """The steady motion of every run.

    Args:
        alone: vibration without balancers, or what stands for it [m].
        speed: that the rotor is to have [rad/s].
    """
    count = len(seen.vibration)
    kind = np.full(count, Kind.UNDECIDED)
    weights, frequency = np.zeros(count), np.full(count, np.nan)
    late = seen.vibration[:, -LATE:].max(axis=1)
    for r in range(count):
        kind[r], weights[r], frequency[r] = _one(seen, r, alone, speed)
    calm = np.ptp(seen.vibration[:, -LATE:], axis=1) <= CALM * late
    decided = np.isin(kind, (Kind.BALANCED, Kind.FAILED)) | ((kind == Kind.BEHIND) & calm)
    return Found(kind.astype(float), weights, frequency, late, decided, calm)


def _one(seen: Seen, r: int, alone: float, speed: float) -> tuple[Kind, int, float]:
    v, turning = seen.vibration[r], seen.speed[r, -LATE:]
    if not np.isfinite(v).all():
        return Kind.FAILED, 0, np.nan
    om = float(turning.mean())
    if om < 0.9 * speed:
        return Kind.SLOW_ROTOR, 0, om
    lag = seen.lag[r, -LATE:]
    mean = lag.mean(axis=0)
    behind, along = mean > LAGS * om, np.abs(mean) <= WITH * om
    moves = _drifts(v)
    beats_little = np.ptp(v[-LATE:]) <= BEATS * v[-LATE:].mean()
    if not (behind.any() or along.all() or moves) and (np.abs(mean) <= LAGS * om).all():
        return Kind.TWO_FREQUENCIES if beats_little else Kind.IRREGULAR, 0, np.nan
    others = np.abs(mean) <= LAGS * om if behind.any() else along
    if not (behind | others).all():
        return Kind.UNDECIDED if moves else Kind.IRREGULAR, 0, np.nan
    if not behind.any():
        return _turning_with_the_rotor(v, seen.swing[r], alone, moves), 0, np.nan
    swing, window = seen.swing[r][:, behind], seen.seconds
    calm = np.ptp(v[-LATE:]) <= CALM * v[-LATE:].max()
    first = -LATE if calm else 0
    steady = _turn_steadily(seen.lag[r, first:][:, behind], swing[first:], window)
    if steady and not moves and np.ptp(v[first:]) <= BEATS * v[first:].mean():
        late = lag[:, behind].mean(axis=0)
        alike = np.ptp(late) <= ALIKE * late.mean()
        return Kind.BEHIND, int(behind.sum()), om - float(late.mean()) if alike else np.nan
    each = seen.lag[r][:, behind]
    drifts = any(_drifts(column) for column in each.T)
    return Kind.UNDECIDED if drifts or moves else Kind.IRREGULAR, 0, np.nan


def _turn_steadily(lag: Array, swing: Array, seconds: float) -> bool:
    """Whether weights lag (j, k) by as much in every window, but for a steady swing (j, k)."""
    beats = 2.0 * np.minimum(swing.max(axis=0), LARGEST_SWING) / seconds  # cut anywhere
    return bool((np.ptp(lag, axis=0) <= STEADY_LAG * lag.mean(axis=0) + beats).all())


def _turning_with_the_rotor(v: Array, swing: Array, alone: float, moves: bool) -> Kind:
    late = v[-LATE:]
    if late.max() < BALANCED * alone and late[-1] <= max(GROWS * late[0], 0.2 * BALANCED * alone):
        return Kind.BALANCED
    if moves:
        return Kind.UNDECIDED
    if np.ptp(late) <= STEADY_VIBRATION * late.mean():
        return Kind.SYNCHRONOUS if swing[-LATE:].max() <= RESTS else Kind.TWO_FREQUENCIES
    return Kind.IRREGULAR


def _drifts(values: Array) -> bool:
    """Whether values rise, or fall, through all windows."""
    steps = np.diff(values)
    one_way = bool((steps > 0.0).all() or (steps < 0.0).all())
    return one_way and bool(abs(values[-1] - values[0]) > DRIFT * np.abs(values).mean())


@dataclass(frozen=True)
class Motion:
    """A steady motion by name.

    Attributes:
        kind: of `Kind`.
        weights, total: left behind, of so many; 0 where none is, and where N is not known.
        natural: natural frequency beside which they turn [rad/s]; NaN: none.
        several: whether they turn beside several natural frequencies.
    """

    kind: Kind
    weights: int = 0
    total: int = 0
    natural: float = float("nan")
    several: bool = False

    @property
    def name(self) -> str:
        """In words, without its frequency."""
        if self.kind is not Kind.BEHIND:
            return _NAMES[self.kind]
        of = f" of {self.total}" if self.total else ""
        beside = " beside several natural frequencies" if self.several else ""
        if not np.isnan(self.natural):
            beside = f" beside {self.natural:.4g} rad/s"
        return f"left behind: {self.weights}{of}{beside}"


_NAMES = {
    Kind.FAILED: "failed",
    Kind.UNDECIDED: "undecided",
    Kind.BALANCED: "balanced",
    Kind.SYNCHRONOUS: "synchronous, not balanced",
    Kind.TWO_FREQUENCIES: "two frequencies",
    Kind.IRREGULAR: "irregular",
    Kind.SLOW_ROTOR: "rotor below its speed",
}


def motion_of(kind: float, weights: float, frequency: float, closed: Capture | None) -> Motion:
    """The motion of a run; `closed`: what the closed form says at its speed."""
    if Kind(int(kind)) is not Kind.BEHIND:
        return Motion(Kind(int(kind)))
    alike, total = bool(frequency > 0.0), closed.count if closed else 0
    natural = [one.frequency for one in closed.natural] if closed and alike else []
    natural = [one for one in natural if frequency <= BESIDE * one]  # none brakes far beyond it
    nearest = min(natural, key=lambda n: abs(n - frequency), default=float("nan"))
    return Motion(Kind.BEHIND, int(weights), total, nearest, not alike)
