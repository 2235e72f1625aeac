"""Cubics over a step, given by value and derivatives 1 to 3 at its start; real or complex."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

Number = TypeVar("Number", float, complex)


def hermite(
    start: Number, slope: Number, end: Number, end_slope: Number, step: float
) -> tuple[Number, Number]:
    """Second and third derivative at the start of the cubic with these values and slopes.

    Of a smooth f the cubic errs by at most step^4/384 f''''.
    """
    per_step = 1.0 / step
    rise = (end - start) * per_step
    return (
        (6.0 * rise - 4.0 * slope - 2.0 * end_slope) * per_step,
        (6.0 * (slope + end_slope) - 12.0 * rise) * (per_step * per_step),
    )


def at(cubic: Sequence[Number], time: float) -> tuple[Number, Number]:
    """Value and slope of a cubic `time` after its start."""
    f0, f1, f2, f3 = cubic
    return (
        f0 + time * (f1 + 0.5 * time * (f2 + time / 3.0 * f3)),
        f1 + time * (f2 + 0.5 * time * f3),
    )
