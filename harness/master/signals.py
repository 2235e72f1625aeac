"""Signals between units: complex xi + i eta, a cubic over each communication step.

Arrays have a row a signal.  A knot is value and slope at one point; a cubic is value, first, second
and third derivative at the start of its step.  The exchange order says how much of it is used:
0 held, 1 linear, 3 cubic Hermite from values and exact slopes of both ends.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

Knots = NDArray[np.complex128]  # (n, 2)
Cubics = NDArray[np.complex128]  # (n, 4)


def cubics_from_start(knots: Knots) -> Cubics:
    """Signals of which the start alone is known."""
    return np.concatenate((knots, np.zeros_like(knots)), axis=1)


@lru_cache(maxsize=64)
def _hermite(h: float) -> NDArray[np.complex128]:
    """What (value, slope) of the start and of the end after h [s] give to a cubic."""
    start = [[1.0, 0.0, -6.0 / h**2, 12.0 / h**3], [0.0, 1.0, -4.0 / h, 6.0 / h**2]]
    end = [[0.0, 0.0, 6.0 / h**2, -12.0 / h**3], [0.0, 0.0, -2.0 / h, 6.0 / h**2]]
    return np.array(start + end, complex)


@lru_cache(maxsize=64)
def _taylor(h: float) -> NDArray[np.complex128]:
    """What a cubic gives to the same cubic, told by value and derivatives h [s] later."""
    rows = [
        [h ** (j - i) / math.factorial(j - i) if j >= i else 0.0 for i in range(4)]
        for j in range(4)
    ]
    return np.array(rows, complex)


def interpolated(start: Knots, end: Knots, step: float, order: int = 3) -> Cubics:
    """Signals over a step [s] both of whose ends are known; of order 3 err step^4/384 f''''."""
    if order == 3:
        return np.concatenate((start, end), axis=1).dot(_hermite(step))
    cubics = np.zeros((len(start), 4), complex)
    cubics[:, 0] = start[:, 0] if order else end[:, 0]
    if order:
        cubics[:, 1] = (end[:, 0] - start[:, 0]) / step
    return cubics


def end_of(cubics: Cubics, step: float) -> Knots:
    """Value and slope of cubics at the end of their step."""
    return cubics.dot(_taylor(step))[:, :2]


class Signals:
    """Coupling signals of one kind: where they are, and what they did in the step before.

    Attributes:
        now: (n, 2) knots.
        last: (n, 4) cubics of the step before; its length is `last_step` [s].
    """

    def __init__(self, count: int) -> None:
        self.now, self.last = np.zeros((count, 2), complex), np.zeros((count, 4), complex)
        self.last_step = 0.0

    def predicted(self, order: int) -> Cubics:
        """What they would do over the next step, by exchange order."""
        cubics = self.last.dot(_taylor(self.last_step))
        if order < 3:
            cubics[:, order + 1 :] = 0.0
        return cubics

    def to(self, ends: Knots, step: float, order: int = 3) -> Cubics:
        """What they do on their way to these ends after a step [s]."""
        return interpolated(self.now, ends, step, order)

    def ends(self, cubics: Cubics, step: float) -> Knots:
        """Ends of cubics as the iteration compares them."""
        return end_of(cubics, step)

    def accept(self, ends: Knots, step: float) -> None:
        """Go on from the ends of a finished step [s]."""
        self.last, self.last_step = self.to(ends, step), step
        self.now = ends

    def drop_past(self) -> None:
        """Drop what they did before now: it says nothing of what comes."""
        self.last, self.last_step = cubics_from_start(self.now), 0.0
