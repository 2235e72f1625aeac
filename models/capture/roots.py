"""Roots of several functions at once, each between two points, where some functions jump."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array

_STEPS = 30  # at most
_SMOOTH = 5e-5  # relative accuracy of a root
_AT_JUMP = 1e-3  # of a jump, which is found by halving
_STEEP, _NEAR = 10.0, 0.02  # a slope within so small a part of a root that is a jump
Function = Callable[[Array, NDArray[np.intp]], Array]


def find_roots(function: Function, a: Array, at_a: Array, b: Array, at_b: Array) -> Array:
    """Roots (r,) between brackets (r,), by Chandrupatla 1997.

    Args:
        function: values at points, for some rows, with slopes of about 1; -x or less at a point x
            beyond a jump, and NaN
            where it is not known.
        a, b, at_a, at_b: brackets, and the values there, of opposite signs.

    Returns:
        NaN where the function was not known at a point on the way.
    """
    a, at_a, b, at_b = (x.copy() for x in (b, at_b, a, at_a))
    c, at_c = b.copy(), at_b.copy()
    with np.errstate(divide="ignore", invalid="ignore"):
        part = np.where(_jumps(a, at_a, b, at_b), 0.5, at_a / (at_a - at_b))
    root, rows = a.copy(), np.arange(len(a))
    for _ in range(_STEPS):
        if not len(rows):
            break
        x = a[rows] + part[rows] * (b[rows] - a[rows])
        found = function(x, rows)
        same = found * at_a[rows] > 0.0
        for mine, other, older in ((a, b, c), (at_a, at_b, at_c)):
            older[rows] = np.where(same, mine[rows], other[rows])
            other[rows] = np.where(same, other[rows], mine[rows])
        a[rows], at_a[rows] = x, found
        root[rows] = np.where(np.abs(at_a) < np.abs(at_b), a, b)[rows]
        root[rows[np.isnan(found)]] = np.nan
        jumps = _jumps(a, at_a, b, at_b)
        width = np.abs(b - a) / np.abs(root)
        left = np.minimum(np.abs(at_a), np.abs(at_b)) / np.abs(root)
        done = np.where(jumps, width <= _AT_JUMP, np.minimum(width, left) <= _SMOOTH)
        part = np.where(jumps, 0.5, _part(a, b, c, at_a, at_b, at_c))
        rows = rows[~(done | np.isnan(root))[rows]]
    return root


def _jumps(a: Array, at_a: Array, b: Array, at_b: Array) -> NDArray[np.bool_]:
    width = np.abs(b - a)
    steep = np.abs(at_b - at_a) > _STEEP * width
    return (at_a <= -a) | (at_b <= -b) | (steep & (width < _NEAR * np.abs(b)))


def _part(a: Array, b: Array, c: Array, at_a: Array, at_b: Array, at_c: Array) -> Array:
    """Place of the root from a (0) to b (1) by the inverse parabola; half where it does not fit."""
    with np.errstate(divide="ignore", invalid="ignore"):
        xi, phi = (a - b) / (c - b), (at_a - at_b) / (at_c - at_b)
        fits = (phi**2 < xi) & ((1.0 - phi) ** 2 < 1.0 - xi)
        place = at_a / (at_b - at_a) * at_c / (at_b - at_c)
        place = place + (c - a) / (b - a) * at_a / (at_c - at_a) * at_b / (at_c - at_b)
    return np.where(fits & np.isfinite(place), np.clip(place, 1e-6, 1.0 - 1e-6), 0.5)
