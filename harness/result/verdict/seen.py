"""What a run shows at the end of a plateau: vibration by frequency, and what the weights do."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from ....models.arrays import Array, Complex
from ....models.harmonic_balance import largest_displacement
from .record import Mask, Record

MOST_REVOLUTIONS = 10.0  # of the window that synchronous vibration is read from
LONGEST = 40.0  # revolutions of the window in which other frequencies are told apart
FEWEST_REVOLUTIONS = 2.0  # since the last change: in fewer nothing can be told from its transient
FEWEST_POINTS = 60  # of the window; a rotor at rest is recorded in long steps
APART = 1.5  # turns in the window by which two frequencies must differ to be told apart
BEAT = 0.02  # turns in the window by which two frequencies differ so that they beat
LATEST, FEW_POINTS = 4.0, 6  # revolutions, or points, that tell where weights are
TURNING = 1.0  # turns in the rotor within the window: a weight that makes them does not rest
STUCK = 1e-6  # rad that weights which stick may have turned by in the last revolution


@dataclass(frozen=True, eq=False)
class Vibration:
    """Vibration over a window, by a fit of its frequencies.

    Attributes:
        synchronous: at the rotor's frequency (2, n): x = Re(found e^{i beta}) [m].
        mean: of x and y of all stations (2, n) [m].
        others: amplitude of the largest station [m] by frequency [rad/s].
        rest: largest distance of a station from mean and synchronous part [m].
        largest: largest distance of a station from the middle in the window [m].
        known: whether there were points enough for a fit.
        changes: by frequency [rad/s], its amplitude over that in the window before, where both
            windows tell the frequency apart.
    """

    synchronous: Complex
    mean: Array
    others: Mapping[float, float]
    rest: float
    largest: float
    known: bool
    changes: Mapping[float, float] = field(default_factory=dict)

    @property
    def size(self) -> float:
        """Synchronous vibration: largest half axis of the stations' ellipses [m]."""
        return float(largest_displacement(self.synchronous[None]).max())

    @property
    def largest_other(self) -> tuple[float, float]:
        """Frequency [rad/s] and amplitude [m] of the largest other part; zeros: there is none."""
        if not self.others:
            return 0.0, 0.0
        frequency = max(self.others, key=lambda each: self.others[each])
        return frequency, self.others[frequency]


@dataclass(frozen=True, eq=False)
class Weights:
    """What the weights do over a window.

    Attributes:
        angles: (K,) at its end by a line through the last points [rad].
        rates: (K,) of these lines, of weights that turn of lines through the window: speeds in
            the rotor [rad/s].
        changes: (K,) by how much the rate of the second half differs from that of the first.
        swing: (K,) largest distance from the line [rad].
        turns: (K,) in the rotor within the window.
    """

    angles: Array
    rates: Array
    changes: Array
    swing: Array
    turns: Array

    @property
    def turning(self) -> Mask:
        """Which weights turn in the rotor instead of resting in it (K,)."""
        return np.abs(self.turns) >= TURNING


def seen(record: Record) -> tuple[Vibration | None, Vibration | None, Weights | None]:
    """Vibration in the last window and the one before, and the weights over both.

    None: the record is too short; the weights' also where they were not recorded.
    """
    if record.revolutions < FEWEST_REVOLUTIONS or len(record.time) < FEW_POINTS:
        return None, None, None
    window = window_of(record)
    late, both = record.since(window), record.since(2.0 * window)
    early = both & ~late
    if min(late.sum(), early.sum()) < FEW_POINTS:
        return None, None, None
    weights = None if record.weights is None else weights_in(record, both)
    frequencies = _frequencies(record, weights)
    now, before = (vibration_in(record, each, frequencies) for each in (late, early))
    longer = record.since(max(window, min(record.revolutions, LONGEST)))
    others = vibration_in(record, longer, frequencies).others
    others = {frequency: min(size, now.rest) for frequency, size in others.items()}
    changes = _changes(record, window, now, before, frequencies)
    return replace(now, others=others, changes=changes), before, weights


def _changes(
    record: Record, window: float, now: Vibration, before: Vibration, frequencies: Array
) -> dict[float, float]:
    """Amplitudes in the last window over those before; of low frequencies in longer windows.

    Without frequencies that beat with another one: their amplitude falls and rises again.
    """
    pairs = [(window, now, before)]
    longer = min(record.revolutions / 2.0, LONGEST)
    if longer > window and len(now.others) < len(frequencies):
        late, both = record.since(longer), record.since(2.0 * longer)
        new, old = (vibration_in(record, each, frequencies) for each in (late, both & ~late))
        pairs.append((longer, new, old))
    found: dict[float, float] = {}
    for revolutions, new, old in pairs:
        turns = np.abs(frequencies[:, None] - frequencies) * revolutions / record.speed
        beats = ((turns > BEAT) & (turns < APART)).any(axis=1)
        for frequency in new.others.keys() - set(frequencies[beats].tolist()):
            if old.others.get(frequency, 0.0) > 0.0:
                found.setdefault(frequency, new.others[frequency] / old.others[frequency])
    return found


def _frequencies(record: Record, weights: Weights | None) -> Array:
    """What the motion may hold besides the rotor's frequency, the likeliest first [rad/s]."""
    found: list[float] = []
    if weights is not None:
        found += np.abs(record.speed + weights.rates[weights.turning]).tolist()
    if record.scene.operation.gravity:
        found.append(2.0 * record.speed)
    return np.array([*found, *record.natural])


def window_of(record: Record) -> float:
    """Revolutions of the window at the end of a record: half of it at most."""
    half = record.revolutions / 2.0
    window = min(half, MOST_REVOLUTIONS)
    while window < half and record.since(window).sum() < FEWEST_POINTS:
        window = min(half, 2.0 * window)
    return window


def weights_in(record: Record, shown: Mask) -> Weights:
    """What the weights do at the points `shown` (T,)."""
    assert record.weights is not None
    time, angles = record.time[shown], record.weights[shown]
    if len(time) < 3:
        zero = np.zeros(angles.shape[1])
        return Weights(record.weights[-1], zero, zero, zero, zero)
    _, rates, line = _line(time, angles)
    late = _latest(record)
    at, late_rates, _ = _line(record.time[late], record.weights[late])
    half = time >= 0.5 * (time[0] + time[-1])
    changes = np.zeros_like(rates)
    if half.sum() > 2 and (~half).sum() > 2:
        changes = _line(time[half], angles[half])[1] - _line(time[~half], angles[~half])[1]
    swing = np.abs(angles - line).max(axis=0)
    turns = rates * (time[-1] - time[0]) / math.tau
    resting = np.abs(turns) < TURNING
    return Weights(at, np.where(resting, late_rates, rates), changes, swing, turns)


def _latest(record: Record) -> Mask:
    """The last points (T,) that tell where weights are and how fast: some whole revolutions, or
    the last few points of weights at rest, whose steps are long."""
    whole = np.floor(min(LATEST, record.revolutions))
    shown = record.since(whole)
    if shown.sum() < FEW_POINTS:
        shown = np.arange(len(record.time)) >= len(record.time) - FEW_POINTS
    return shown


def _line(time: Array, values: Array) -> tuple[Array, Array, Array]:
    """Ends (K,), slopes (K,) and values (T, K) of lines through points, weighed by time."""
    share = np.sqrt(weights_of_points(time))[:, None]
    columns = np.column_stack([np.ones_like(time), time - time[-1]])
    found, *_ = np.linalg.lstsq(share * columns, share * values, rcond=None)
    return found[0], found[1], columns @ found


def weights_of_points(time: Array) -> Array:
    """Share of time of every point."""
    steps = np.diff(time)
    return 0.5 * (np.append(steps, 0.0) + np.append(0.0, steps))


def vibration_in(record: Record, shown: Mask, frequencies: Array) -> Vibration:
    """Vibration at the points `shown` (T,), told apart by frequency.

    A fit weighed by a Hann window of mean, the rotor's frequency and those given that differ from
    these and each other by `APART` turns in the window.

    Args:
        frequencies: that the motion may hold besides [rad/s], the likeliest first.
    """
    time, angle, motion = record.time[shown], record.angle[shown], record.displacement[shown]
    speed, seconds = record.speed, float(time[-1] - time[0])
    chosen: list[float] = []
    for one in frequencies.tolist():
        near = [0.0, speed, *chosen]
        if all(abs(one - other) * seconds >= APART * math.tau for other in near):
            chosen.append(one)
    phases = [angle, *(one * (time - time[-1]) for one in chosen)]
    waves = [wave(phase) for phase in phases for wave in (np.cos, np.sin)]
    columns = np.column_stack([np.ones_like(time), *waves])
    hann = np.sin(math.pi * (time - time[0]) / max(seconds, np.finfo(float).tiny)) ** 2
    share = np.sqrt(weights_of_points(time) * hann)[:, None]
    found, *_ = np.linalg.lstsq(share * columns, share * motion, rcond=1e-9)
    n = motion.shape[1] // 2
    # a cos + b sin = Re((a - i b) e^{i phase})
    complex_parts = (found[1::2] - 1j * found[2::2]).reshape(len(phases), 2, n)
    rest = (motion - columns[:, :3] @ found[:3]).reshape(len(time), 2, n)
    late = record.since(1.0)[shown] if shown.any() else shown
    last = rest[late] if late.any() else rest
    sizes = largest_displacement(complex_parts).max(axis=1)
    return Vibration(
        complex_parts[0],
        found[0].reshape(2, n),
        dict(zip(chosen, sizes[1:].tolist(), strict=True)),
        float(np.hypot(last[:, 0], last[:, 1]).max(initial=0.0)),
        float(np.hypot(motion[:, :n], motion[:, n:]).max()),
        len(time) > 2 * columns.shape[1],
    )
