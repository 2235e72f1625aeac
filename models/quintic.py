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
    # by how much the parabola of the start misses the end, all in the unit of the value
    value = f1 - f0 - step * (d0 + 0.5 * step * c0)
    slope = step * (d1 - d0 - step * c0)
    second = step * step * (c1 - c0)
    cube = step * step * step
    return (
        (60.0 * value - 24.0 * slope + 3.0 * second) / cube,
        (-360.0 * value + 168.0 * slope - 24.0 * second) / (cube * step),
        (720.0 * value - 360.0 * slope + 60.0 * second) / (cube * step * step),
    )


def at(quintic: Sequence[Number], time: float) -> tuple[Number, Number, Number]:
    """Value, slope and second derivative of a quintic `time` after its start."""
    f0, f1, f2, f3, f4, f5 = quintic
    half, third, fourth, fifth = time / 2.0, time / 3.0, time / 4.0, time / 5.0
    return (
        f0 + time * (f1 + half * (f2 + third * (f3 + fourth * (f4 + fifth * f5)))),
        f1 + time * (f2 + half * (f3 + third * (f4 + fourth * f5))),
        f2 + time * (f3 + half * (f4 + third * f5)),
    )
