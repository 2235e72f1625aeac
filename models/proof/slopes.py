"""Balls with their slopes: what a set of machines adds to the one in its middle, to first order.

By the mean value theorem f(e) lies in f(0) + sum e_j f_j, |e_j| <= 1, where the ball f_j holds the
derivative for the whole set.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from flint import arb
from numpy.typing import NDArray

Exact = NDArray[np.object_]


class Sloped:
    """A ball of all values in a set, and the balls of the derivatives by e_1, e_2, ...

    Comparisons are those of the values.
    """

    __slots__ = ("slopes", "value")

    def __init__(self, value: arb, slopes: Exact) -> None:
        self.value, self.slopes = value, slopes

    def __add__(self, other: Any) -> Sloped:
        if isinstance(other, Sloped):
            return Sloped(self.value + other.value, self.slopes + other.slopes)
        return Sloped(self.value + other, self.slopes)

    def __mul__(self, other: Any) -> Sloped:
        if isinstance(other, np.ndarray):
            return NotImplemented  # the array multiplies its entries
        if isinstance(other, Sloped):
            slopes = self.slopes * other.value + other.slopes * self.value
            return Sloped(self.value * other.value, slopes)
        return Sloped(self.value * other, self.slopes * other)

    def __neg__(self) -> Sloped:
        return Sloped(-self.value, -self.slopes)

    def __sub__(self, other: Any) -> Sloped:
        return self + -other

    def __rsub__(self, other: Any) -> Sloped:
        return -self + other

    def __truediv__(self, other: Any) -> Sloped:
        return self * (1 / other)

    def __rtruediv__(self, other: Any) -> Sloped:
        inverse = 1 / self.value
        return Sloped(inverse, self.slopes * (-inverse * inverse)) * other

    __radd__, __rmul__ = __add__, __mul__

    def __abs__(self) -> Sloped:
        if self.value > 0 or self.value < 0:
            return self if self.value > 0 else -self
        return Sloped(abs(self.value), self.slopes * arb(0, 1))

    def __lt__(self, other: Any) -> bool:
        return bool(self.value < ball(other))

    def __gt__(self, other: Any) -> bool:
        return bool(self.value > ball(other))

    def __le__(self, other: Any) -> bool:
        return bool(self.value <= ball(other))

    def __ge__(self, other: Any) -> bool:
        return bool(self.value >= ball(other))

    def __float__(self) -> float:
        return float(self.value)

    def _by(self, value: arb, slope: arb) -> Sloped:
        return Sloped(value, self.slopes * slope)

    def sqrt(self) -> Sloped:
        root = self.value.sqrt()
        return self._by(root, 1 / (2 * root))

    def cos(self) -> Sloped:
        return self._by(self.value.cos(), -self.value.sin())

    def sin(self) -> Sloped:
        return self._by(self.value.sin(), self.value.cos())


Number = arb | Sloped


def largest(one: Number, other: Number) -> Number:
    """The larger one; where it is not proved which, with the slopes of both."""
    if not isinstance(one, Sloped) and not isinstance(other, Sloped):
        return one.max(other)
    if one > other or one < other:
        return one if one > other else other
    count = max(len(x.slopes) for x in (one, other) if isinstance(x, Sloped))
    pairs = zip(slopes_of(one, count), slopes_of(other, count), strict=True)
    return Sloped(ball(one).max(ball(other)), np.array([x.union(y) for x, y in pairs], object))


def ball(number: Any) -> arb:
    """The ball of a number's values."""
    return number.value if isinstance(number, Sloped) else arb(number)


def slopes_of(number: Any, count: int) -> Exact:
    """The balls of a number's derivatives."""
    return number.slopes if isinstance(number, Sloped) else np.array([arb(0)] * count, object)
