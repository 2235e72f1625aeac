"""Cubic signals as complex numbers, and their change between fixed and rotating axes."""

from __future__ import annotations

from collections.abc import Sequence


def orders(signal: Sequence[float]) -> tuple[complex, complex, complex, complex]:
    """Value and derivatives 1 to 3 from the eight inputs of one vector signal."""
    x0, y0, x1, y1, x2, y2, x3, y3 = signal
    return complex(x0, y0), complex(x1, y1), complex(x2, y2), complex(x3, y3)


def at(cubic: Sequence[complex], t: float) -> tuple[complex, complex]:
    """Value and slope of a cubic at time t [s] into the step."""
    s0, s1, s2, s3 = cubic
    return s0 + t * (s1 + t * (s2 / 2.0 + t * s3 / 6.0)), s1 + t * (s2 + t * s3 / 2.0)


def hermite(
    start: complex, start_slope: complex, end: complex, end_slope: complex, step: float
) -> tuple[complex, complex, complex, complex]:
    """Value and derivatives 1 to 3 at the start of the cubic with these ends."""
    rise = (end - start) / step
    second = (6.0 * rise - 4.0 * start_slope - 2.0 * end_slope) / step
    third = (6.0 * (start_slope + end_slope) - 12.0 * rise) / (step * step)
    return start, start_slope, second, third
