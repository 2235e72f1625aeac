"""Signals between units: complex xi + i eta, a cubic or quintic over each communication step.

A cubic is (value, first, second, third derivative) at the start of the step.  An exchange order
says how much of it is used: 0 held, 1 linear, 3 cubic Hermite from values and exact slopes of both
ends.  With order 5 a signal is a quintic, two derivatives more, from the exact second derivatives
of both ends as well; how many derivatives its ends have tells it from a cubic.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ...models import quintic

Cubic = tuple[complex, ...]  # four numbers, of a quintic six
Knot = tuple[complex, ...]  # value and slope at one point, and of a quintic the second derivative

ZERO: Knot = (0j, 0j)
EXACT = {0: 0, 1: 1, 3: 1, 5: 2}  # by order, derivatives that the units answer with
# how far the cubic of the step before misses the end of a step, over what the step's own cubic errs
# on average: (h + h)^2 h^2/24 over h^4/720; of quintics (h + h)^3 h^3/720 over h^6/100800
MISS_PER_ERROR = {3: 120.0, 5: 1120.0}
REST: Cubic = (0j, 0j, 0j, 0j)


def begun(knot: Knot) -> Cubic:
    """A signal of which the start alone is known."""
    return (*knot, 0j, 0j) if len(knot) == 2 else (*knot, 0j, 0j, 0j)


def flat(knot: Knot) -> Knot:
    """The same value, at rest."""
    return (knot[0], *(0j,) * (len(knot) - 1))


def hermite(start: Knot, end: Knot, step: float) -> Cubic:
    """The cubic, or quintic, through both ends of a step [s]; error step^4/384 f''''."""
    if len(start) == 3:
        return (*start, *quintic.hermite(start, end, step))
    (f0, d0), (f1, d1) = start, end
    per_step = 1.0 / step
    rise = (f1 - f0) * per_step
    return (
        f0,
        d0,
        (6.0 * rise - 4.0 * d0 - 2.0 * d1) * per_step,
        (6.0 * (d0 + d1) - 12.0 * rise) * (per_step * per_step),
    )


def leading_to(end: Knot, step: float) -> Cubic:
    """The quintic that is a parabola and ends a step with this value, slope and second derivative.

    Over a negligible step, of which the derivatives of `hermite` would be rounding.
    """
    value, slope, second = end
    return (value - step * (slope - 0.5 * step * second), slope - step * second, second, 0j, 0j, 0j)


def interpolated(start: Knot, end: Knot, step: float, order: int) -> Cubic:
    """Signal over a step both of whose ends are known, of exchange order 0 (end value), 1, 3, 5."""
    if order >= 3:
        return hermite(start, end, step)
    if order == 1:
        return (start[0], (end[0] - start[0]) / step, 0j, 0j)
    return begun(flat(end))


def extrapolated(start: Knot, past: Cubic, past_step: float, order: int) -> Cubic:
    """Signal over a step of which only the start is known, and the cubic of the step before it."""
    if order == 3:
        return (start[0], start[1], past[2] + past_step * past[3], past[3])
    if order == 5:
        _, _, _, d3, d4, d5 = past
        return (*start, d3 + past_step * (d4 + 0.5 * past_step * d5), d4 + past_step * d5, d5)
    if order == 1:
        return (start[0], start[1], 0j, 0j)
    return begun(flat(start))


def end_of(cubic: Cubic, step: float) -> Knot:
    """Value and slope of a cubic at the end of its step; of a quintic the second derivative too."""
    if len(cubic) == 6:
        return quintic.at(cubic, step)
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
        missed = 0.0
        if self.last_step == step:
            if len(self.last) == 4:
                f, d, d2, d3 = self.last
                led = f + 2.0 * step * (d + step * (d2 + 2.0 / 3.0 * step * d3))
            else:
                led = quintic.at(self.last, 2.0 * step)[0]
            missed = abs(end[0] - led)
        self.arrive(cubic, end, step, missed)

    def arrive(self, cubic: Cubic, end: Knot, step: float, missed: float) -> None:
        """`move`, where it is known by how much the cubic of the step before missed the end."""
        modulus = abs(end[0])
        if modulus > self.largest:
            self.largest = modulus
        self.prediction_error = missed
        self.now, self.last, self.last_step = end, cubic, step


def matrix_of(formula: Callable[..., Sequence[complex]], count: int) -> np.ndarray:
    """The matrix of a formula that is linear in so many numbers, a row for each of these."""
    return np.array([formula(*unit) for unit in np.eye(count).tolist()])


def predicted(signals: Sequence[SignalState], order: int) -> list[Cubic]:
    """What the signals would do over the next step, by exchange order."""
    return [extrapolated(s.now, s.last, s.last_step, order) for s in signals]


def joined(
    signals: Sequence[SignalState], ends: Sequence[Knot], step: float
) -> list[tuple[Cubic, Knot]]:
    """Cubics from where the signals are to where a step [s] ended, with these ends."""
    return [(hermite(s.now, end, step), end) for s, end in zip(signals, ends, strict=True)]
