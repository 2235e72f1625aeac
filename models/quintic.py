"""Quintics over a step, told by value and derivatives 1 to 5 at its start; real or complex."""

from __future__ import annotations

from collections.abc import Sequence

from .cubic import Number


def hermite(
    start: Sequence[Number], end: Sequence[Number], step: float
) -> tuple[Number, Number, Number]:
    """Derivatives 3 to 5 at the start of the quintic through two ends.

    Of a smooth f the quintic errs by at most step^6/46080 f^(6).

    Args:
        start, end: value and derivatives of order 1 and 2 there.
    """
    f0, d0, c0 = start
    f1, d1, c1 = end
    per_step = 1.0 / step
    # by how much value, slope and second derivative of the end miss the parabola of the start
    value = 60.0 * (((f1 - f0) * per_step - d0) * per_step - 0.5 * c0)
    slope = 24.0 * ((d1 - d0) * per_step - c0)
    second = 3.0 * (c1 - c0)
    square = per_step * per_step
    return (
        (value - slope + second) * per_step,
        (7.0 * slope - 6.0 * value - 8.0 * second) * square,
        (12.0 * value - 15.0 * slope + 20.0 * second) * (square * per_step),
    )


def at(quintic: Sequence[Number], time: float) -> tuple[Number, Number, Number]:
    """Value, slope and second derivative of a quintic `time` after its start."""
    f0, f1, f2, f3, f4, f5 = quintic
    half, third, fourth, fifth = 0.5 * time, time / 3.0, 0.25 * time, 0.2 * time
    return (
        f0 + time * (f1 + half * (f2 + third * (f3 + fourth * (f4 + fifth * f5)))),
        f1 + time * (f2 + half * (f3 + third * (f4 + fourth * f5))),
        f2 + time * (f3 + half * (f4 + third * f5)),
    )
