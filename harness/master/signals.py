"""Signals between units: complex xi + i eta, a cubic over each communication step.

A cubic is (value, first, second, third derivative) at the start of the step.  The exchange order
says how much of it is used: 0 held, 1 linear, 3 cubic Hermite from values and exact slopes of both
ends.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

Cubic = tuple[complex, complex, complex, complex]
Knot = tuple[complex, complex]  # value and slope at one point

ZERO: Knot = (0j, 0j)
REST: Cubic = (0j, 0j, 0j, 0j)


def begun(knot: Knot) -> Cubic:
    """A signal of which the start alone is known."""
    return (*knot, 0j, 0j)


def hermite(start: Knot, end: Knot, step: float) -> Cubic:
    """The cubic through both ends of a step [s]; error step^4/384 f''''."""
    (f0, d0), (f1, d1) = start, end
    per_step = 1.0 / step
    rise = (f1 - f0) * per_step
    return (
        f0,
        d0,
        (6.0 * rise - 4.0 * d0 - 2.0 * d1) * per_step,
        (6.0 * (d0 + d1) - 12.0 * rise) * (per_step * per_step),
    )


def interpolated(start: Knot, end: Knot, step: float, order: int) -> Cubic:
    """Signal over a step both of whose ends are known, of exchange order 0 (end value), 1 or 3."""
    if order == 3:
        return hermite(start, end, step)
    if order == 1:
        return (start[0], (end[0] - start[0]) / step, 0j, 0j)
    return (end[0], 0j, 0j, 0j)


def extrapolated(start: Knot, past: Cubic, past_step: float, order: int) -> Cubic:
    """Signal over a step of which only the start is known, and the cubic of the step before it."""
    if order == 3:
        return (*start, past[2] + past_step * past[3], past[3])
    return (start[0], start[1] if order else 0j, 0j, 0j)


def end_of(cubic: Cubic, step: float) -> Knot:
    """Value and slope of a cubic at the end of its step."""
    f, d, d2, d3 = cubic
    half, third = 0.5 * step, step / 3.0
    return f + step * (d + half * (d2 + third * d3)), d + step * (d2 + half * d3)


@dataclass(slots=True)
class SignalState:
    """One coupling signal: value and slope now, and its cubic over the step before.

    Attributes:
        last: the cubic of the step before; its length is `last_step` [s].
        prediction_error: how far the last step ended from where the cubic before it led, where both
            were of the same length.
        largest: modulus of the largest value so far.
    """

    now: Knot = ZERO
    last: Cubic = REST
    last_step: float = 0.0
    prediction_error: float = 0.0
    largest: float = 0.0

    def move(self, cubic: Cubic, end: Knot, step: float) -> None:
        """Accept the signal of a finished step."""
        self.prediction_error = 0.0
        if self.last_step == step:
            self.prediction_error = abs(end[0] - end_of(self.last, 2.0 * step)[0])
        self.largest = max(self.largest, abs(end[0]))
        self.now, self.last, self.last_step = end, cubic, step


def predicted(signals: Sequence[SignalState], order: int) -> list[Cubic]:
    """What the signals would do over the next step, by exchange order."""
    return [extrapolated(s.now, s.last, s.last_step, order) for s in signals]


def interpolations(
    signals: Sequence[SignalState], ends: Sequence[Knot], step: float, order: int = 3
) -> list[Cubic]:
    """Signals from where they are to where a step [s] ended, with these ends."""
    return [interpolated(s.now, end, step, order) for s, end in zip(signals, ends, strict=True)]
