"""Regions of speed by a growth rate that is measured at one speed after another."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from ...models.linear.growth import Growth
from ...models.linear.regions import NARROW, Regions, Samples, Side, regions_of
from ..output.workers import Progress

TOLERANCE = 1e-6  # relative, of a co-simulated boundary
NEAR = 2e-3  # relative distance from a guess at which the co-simulation is asked: it errs by less
LEAST_REACH = 3.0 * TOLERANCE  # relative: two numbers of steps agree so far without being right
SAFE = 4.0  # times the error of a growth over its slope: so far from a limit it is decided
FINE = 1e-5  # relative, to which a limit is to be known
# of the width of an undecided region, and of the speed, to which its ends are found
EDGE, WIDEST_EDGE = 0.03, 1e-3


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


@dataclass(frozen=True)
class Measured:
    """A growth rate with its error, and a rate as smooth in the speed as the method has it.

    Attributes:
        growth: with an error that is true of this speed.
        steps: per revolution, that gave it; `rate` of the same steps has no jump between speeds.
    """

    growth: Growth
    steps: int


def measured_regions(
    measure: Callable[[float], Measured],
    rate: Callable[[float, int], float],
    nodes: Sequence[float],
    progress: Progress | None = None,
    word: Side = "undecided",
    fine: float = FINE,
) -> Regions:
    """Regions by a growth rate that is costly to measure.

    Args:
        measure: growth at a speed [rad/s], as fine as it takes to decide.
        rate: growth rate [1/s] at a speed and a number of steps per revolution.
        nodes: speeds to begin with, ascending; changes between two of one sign are missed.
        word: for what cannot be decided.
        fine: a limit that is known less well, relative, is looked for in finer steps.
    """
    known: dict[float, Measured] = {}
    for number, speed in enumerate(nodes, start=1):
        known[speed] = measure(speed)
        if progress:
            progress(number / len(nodes))
    done: set[tuple[float, float]] = set()
    while True:
        ends = sorted(known)
        signs = [_sign(known[speed]) for speed in ends]
        pairs = [p for p in zip(pairwise(ends), pairwise(signs), strict=True) if p[0] not in done]
        changes = [pair for pair in pairs if pair[1][0] != pair[1][1]]
        if not changes:
            return regions_of(_samples(known), word)
        for (left, right), (before, after) in changes:
            done.add((left, right))
            if before * after < 0:
                known |= _limit(measure, rate, known, left, right, fine)
            elif right - left > _edge(ends, signs, left if after else right):
                middle = 0.5 * (left + right)
                known[middle] = measure(middle)


def _edge(speeds: list[float], signs: list[int], at: float) -> float:
    """How well the ends of the undecided region that holds one of the speeds are to be known."""
    first = last = speeds.index(at)
    while first > 0 and signs[first] == 0:
        first -= 1
    while last < len(signs) - 1 and signs[last] == 0:
        last += 1
    width = speeds[last] - speeds[first]
    return max(min(EDGE * width, WIDEST_EDGE * at), NARROW / 4.0 * at)


def _sign(one: Measured) -> int:
    return {"unstable": 1, "stable": -1, "neutral": 0}[one.growth.state]


def _samples(known: dict[float, Measured]) -> Samples:
    speeds = sorted(known)
    each = [known[speed].growth for speed in speeds]
    return Samples(
        np.array(speeds), np.array([g.rate for g in each]), np.array([g.error for g in each])
    )


def _limit(
    measure: Callable[[float], Measured],
    rate: Callable[[float, int], float],
    known: dict[float, Measured],
    left: float,
    right: float,
    fine: float,
) -> dict[float, Measured]:
    """The speed at which the growth is 0, and a speed on either side at which it is decided.

    The steps that decided both sides may be too coarse for the limit itself: it is then found once
    more, in the steps that say most of the growth there.
    """
    ends = known[left].growth, known[right].growth
    if right - left <= 3.0 * TOLERANCE * right:
        return {}
    steps, error = max(known[e].steps for e in (left, right)), max(e.error for e in ends)
    if rate(left, steps) * rate(right, steps) >= 0.0:  # the sides' own steps say otherwise
        return {}
    slope = abs(ends[1].rate - ends[0].rate) / (right - left)
    at = _root(rate, left, right, steps)
    reach = max(LEAST_REACH * right, SAFE * error / slope)
    if reach > fine * right:
        finest = measure(at)
        low, high = max(left, at - reach), min(right, at + reach)
        if rate(low, finest.steps) * rate(high, finest.steps) < 0.0:
            at, error = _root(rate, low, high, finest.steps), finest.growth.error
            reach = max(LEAST_REACH * right, SAFE * error / slope)
    found = {at: Measured(Growth(0.0, error), steps)}
    for speed in (at - reach, at + reach):
        if left < speed < right:
            found[speed] = measure(speed)
    return found


def _root(rate: Callable[[float, int], float], left: float, right: float, steps: int) -> float:
    found = brentq(rate, left, right, args=(steps,), xtol=0.1 * TOLERANCE * left, rtol=1e-12)
    return float(found)
