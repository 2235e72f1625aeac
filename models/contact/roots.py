"""Where a function that was positive becomes negative, and where a cubic is least."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TypeVar

from ..cubic import at, hermite

_HALVINGS = 40  # down to rounding of the bracket

Context = TypeVar("Context")


def crossing(
    value: Callable[[Context, float], float],
    context: Context,
    begin: float,
    upper: float,
    width: float,
) -> float:
    """Time at which a function, `begin` >= 0 at 0 and negative at `upper`, becomes negative.

    Chandrupatla 1997 to a bracket of `width`; returns its end at which the value is negative.

    Args:
        value: of `context` and the time.
    """
    x1, f1, x2, f2 = upper, value(context, upper), 0.0, begin
    if begin <= 0.0:  # it has just started at 0: go back to where it is positive still
        for _ in range(_HALVINGS):
            x2 = 0.5 * x1
            f2 = value(context, x2)
            if f2 > 0.0:
                break
            x1, f1 = x2, f2
        else:
            return x1
    share = 0.5
    while abs(x2 - x1) > width:
        x = x1 + share * (x2 - x1)
        f = value(context, x)
        if (f < 0.0) == (f1 < 0.0):
            x3, f3 = x1, f1
        else:
            x3, f3, x2, f2 = x2, f2, x1, f1
        x1, f1 = x, f
        edge = 0.5 * width / max(abs(x2 - x1), width)
        share = _share(x1, f1, x2, f2, x3, f3, edge)
    return x1 if f1 < 0.0 else x2


def _share(x1: float, f1: float, x2: float, f2: float, x3: float, f3: float, edge: float) -> float:
    """Where in the bracket x1..x2 to look next: inverse quadratic if that is safe, else half."""
    share = 0.5
    if f1 == f3 or f2 == f3:
        return share
    xi, phi = (x1 - x2) / (x3 - x2), (f1 - f2) / (f3 - f2)
    if phi * phi < xi and (1.0 - phi) ** 2 < 1.0 - xi:
        share = f1 / (f2 - f1) * f3 / (f2 - f3)
        share += (x3 - x1) / (x2 - x1) * f1 / (f3 - f1) * f2 / (f3 - f2)
    return min(max(share, edge), 1.0 - edge)


def lowest(f0: float, s0: float, f1: float, s1: float, step: float) -> float:
    """Time of the least value of a cubic that falls first and rises last; 0: it stays positive."""
    second, third = hermite(f0, s0, f1, s1, step)
    root = math.sqrt(max(0.0, second * second - 2.0 * s0 * third))
    time = -2.0 * s0 / (second + root) if second + root > 0.0 else 0.0
    least, _ = at((f0, s0, second, third), time)
    doubt = 0.1 * step * (abs(s0) + abs(s1))  # the cubic is no better than this
    return time if 0.0 < time < step and least < doubt else 0.0
