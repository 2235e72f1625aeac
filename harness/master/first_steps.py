"""The first steps of a run: shorter ones, where forces start steeply."""

from __future__ import annotations

import math

import numpy as np

from .limits import FIRST_CHANGE, MOST_HALVINGS, STEEP_FORCE_CHANGE
from .system import System


def steep_halvings(system: System, step: float, halvings: int = 0) -> int:
    """How often the first step [s] is halved; `halvings` where no force starts steeply.

    Weights under heavy drag d are pulled into the rotor's motion within 1/d: a cubic over a whole
    first step with the slope of that instant is wrong by d times the step, while its loop
    converges.

    Args:
        halvings: wanted in any case.
    """
    if system.order == 0 or not system.coupled:
        return 0
    for kind in system.kinds:
        largest, slope = np.abs(system.forces.now[kind]).max(axis=0).tolist()
        change = step * slope
        if change > STEEP_FORCE_CHANGE * largest > 0.0:
            steep = math.ceil(math.log2(change / (FIRST_CHANGE * largest)))
            halvings = max(halvings, min(MOST_HALVINGS, steep))
    return halvings


def divided_doubling(halvings: int, parts: int) -> list[list[float]]:
    """Steps that double up to the first one of a run, each divided into parts.

    A finer run divides them as it divides all others: were they the same in both, their errors
    would be, and the difference of the two runs would not show them.

    Returns:
        Of each of the `parts` communication steps that take the place of the first one, the lengths
        of its steps over its own; they add up to 1.
    """
    shares: list[list[float]] = [[] for _ in range(parts)]
    at, end = 0, 1 << halvings  # of the present communication step, in the shortest step
    for doubling in (0, *range(halvings)):
        for _ in range(parts):
            shares[at // end].append(math.ldexp(1.0, doubling - halvings))
            at += 1 << doubling
    return shares
