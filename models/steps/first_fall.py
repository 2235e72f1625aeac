"""First fall of a polynomial below 0, found to rounding, none missed."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ..contact.roots import crossing

_TOUCH = 1e-13  # a polynomial that is negative on less only touches 0
_TO_ROUNDING = 1e-15  # of an interval; brackets cannot be much shorter


def first_fall(coefficients: NDArray, until: float, rounding: Sequence[float] = ()) -> float:
    """First s in 0..until at which a polynomial, not negative at first, falls below 0.

    What has just become 0 (a slider that sticks now or lets go now) is judged by its first term
    that is not 0.  Infinite when it does not fall.

    Args:
        coefficients: of powers of s, on a stretch of length 1.
        rounding: sizes up to which the first coefficients count as 0.
    """
    sizes = np.abs(coefficients)
    floors = np.zeros(len(sizes))
    floors[: len(rounding)] = rounding
    (counted,) = np.nonzero(sizes > floors)
    first = counted[0] if len(counted) else 0
    rest = coefficients[first:]
    if not len(counted) or rest[0] > sizes[first + 1 :].sum():
        return math.inf
    return 0.0 if rest[0] < 0.0 else _fall_within(rest, 0.0, until)


def _fall_within(polynomial: NDArray, begin: float, end: float) -> float:
    """As `first_fall` in an interval, halved until the polynomial or its slope has one sign."""
    width = end - begin
    here = _shifted(polynomial, begin)
    sizes = np.abs(here) * width ** np.arange(len(here))
    if here[0] > sizes[1:].sum():
        return math.inf
    monotone = sizes[1] > (np.arange(2, len(sizes)) * sizes[2:]).sum() if len(sizes) > 1 else True
    if monotone or width < _TOUCH:
        if _value(here, width) >= 0.0:
            return math.inf
        return begin + crossing(_value, here, max(here[0], 0.0), width, _TO_ROUNDING * width)
    middle = 0.5 * (begin + end)
    fall = _fall_within(polynomial, begin, middle)
    return fall if fall < math.inf else _fall_within(polynomial, middle, end)


def _value(polynomial: NDArray, s: float) -> float:
    total = 0.0
    for coefficient in polynomial[::-1]:
        total = total * s + coefficient
    return float(total)


def _shifted(polynomial: NDArray, s: float) -> NDArray:
    """Coefficients about s: Horner's scheme, repeated."""
    shifted = polynomial.copy()
    if s:
        for first in range(len(shifted) - 1):
            for k in range(len(shifted) - 2, first - 1, -1):
                shifted[k] += s * shifted[k + 1]
    return shifted
