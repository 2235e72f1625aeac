"""Roots of several functions at once, each between two points, where some functions jump."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Indices

_STEPS = 30  # at most
_SMOOTH = 5e-5  # relative accuracy of a root
_AT_JUMP = 1e-3  # of a jump, which is found by halving
_STEEP, _NEAR = 10.0, 0.02  # a slope within so small a part of a root that is a jump


class Roots:
    """Roots (n,) of functions with slopes of about 1, each between two points that are given late.

    By Chandrupatla 1997.  A function is -x or less at a point x beyond a jump.

    Attributes:
        found: NaN until it is found, and where the function was not known at a point on the way.
    """

    def __init__(self, count: int) -> None:
        self.found = np.full(count, np.nan)
        self._ends = np.full((2, 3, count), np.nan)  # places and values of the ends a, b, and c
        self._part = np.full(count, 0.5)
        self._left = np.zeros(count, int)

    def begin(self, rows: Indices, ends: Array) -> None:
        """Look between points a and b, (r,) each, where the functions have opposite signs.

        Args:
            ends: (4, r) a, the value there, b, and the value there.
        """
        a, at_a, b, at_b = ends
        self._ends[:, :, rows] = [[b, a, a], [at_b, at_a, at_a]]
        with np.errstate(divide="ignore", invalid="ignore"):
            part = np.where(_jumps(b, at_b, a, at_a), 0.5, at_b / (at_b - at_a))
        self._part[rows], self._left[rows] = part, _STEPS

    def open(self) -> Indices:
        """Rows that are not found yet."""
        return np.flatnonzero(self._left > 0)

    def guess(self, rows: Indices) -> Array:
        """Points (r,) at which the functions are asked for."""
        a, b, _ = self._ends[0][:, rows]
        return a + self._part[rows] * (b - a)

    def take(self, rows: Indices, x: Array, values: Array) -> None:
        """Values (r,) there, NaN where they are not known."""
        ends = self._ends[:, :, rows]
        same = values * ends[1, 0] > 0.0
        ends[:, 2] = np.where(same, ends[:, 0], ends[:, 1])
        ends[:, 1] = np.where(same, ends[:, 1], ends[:, 0])
        ends[:, 0] = x, values
        self._ends[:, :, rows] = ends
        (a, b, c), (at_a, at_b, at_c) = ends
        best = np.where(np.abs(at_a) < np.abs(at_b), a, b)
        jumps = _jumps(a, at_a, b, at_b)
        width = np.abs(b - a) / np.abs(best)
        left = np.minimum(np.abs(at_a), np.abs(at_b)) / np.abs(best)
        done = np.where(jumps, width <= _AT_JUMP, np.minimum(width, left) <= _SMOOTH)
        self._part[rows] = np.where(jumps, 0.5, _part(a, b, c, at_a, at_b, at_c))
        self._left[rows] = np.where(done | np.isnan(values), 0, self._left[rows] - 1)
        over = self._left[rows] == 0
        self.found[rows[over]] = np.where(np.isnan(values), np.nan, best)[over]


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
