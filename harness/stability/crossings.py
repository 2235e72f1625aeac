"""Speeds at which a measured growth rate changes its sign."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from ...models.linear.boundaries import Crossing
from ..output.workers import Progress

TOLERANCE = 1e-6  # relative, of a co-simulated boundary
NEAR = 2e-3  # relative distance from a guess at which the co-simulation is asked: it errs by less
Side = Literal["stable", "unstable"]


def side(growth: float) -> Side:
    """Of the sign change on which a growth rate is."""
    return "unstable" if growth > 0.0 else "stable"


def nodes_around(guesses: Sequence[float], low: float, high: float) -> NDArray[np.float64]:
    """Speeds at which the sign of the growth shows whether the guessed crossings are there.

    Both sides of every guess, the middle between neighbours, and the ends of the range.  A side is
    at most a third of the way to the neighbour, so that the order stays.
    """
    bounds = [low, *guesses, high]
    nodes = {low, high}
    for before, guess, after in zip(bounds, bounds[1:], bounds[2:], strict=False):
        reach = min(NEAR * guess, (guess - before) / 3.0, (after - guess) / 3.0)
        nodes |= {guess - reach, guess + reach, 0.5 * (before + guess), 0.5 * (guess + after)}
    return np.array(sorted(nodes))


def crossings(
    growth: Callable[[float], float], nodes: Sequence[float], progress: Progress | None = None
) -> tuple[list[Crossing], Side]:
    """Changes of sign of a measured growth rate between neighbouring speeds, and the first sign."""
    known, sides = functools.cache(growth), []
    for number, speed in enumerate(nodes, start=1):
        sides.append(side(known(speed)))
        if progress:
            progress(number / len(nodes))
    changes = []
    for (left, before), (right, after) in pairwise(zip(nodes, sides, strict=True)):
        if before != after:
            speed = brentq(known, left, right, xtol=TOLERANCE * left)
            changes.append(Crossing(float(speed), after))
    return changes, sides[0]
