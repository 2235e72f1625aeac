"""The first step after the start or a jump of the drive, when forces begin to change at once.

Weights under heavy drag d are pulled into the rotor's motion within 1/d: a cubic over the whole
step with the slope of that first instant is wrong by d times the step, while its loop converges
perfectly.  So the first step is divided into parts that double.
"""

from __future__ import annotations

import math

from ..master.system import System

STEEP = 0.2  # of the force: more than this by the slope of its first instant, and a step is divided
FIRST = 0.05  # of the force: what it may change by that slope over the first part
MOST_HALVINGS = 60  # a force that rises from exactly zero has no size to compare with


def parts(system: System, step: float, least: int = 0) -> list[float]:
    """Lengths that add up to `step` [s], doubling; just `step` where nothing is steep.

    Args:
        least: halvings wanted in any case.
    """
    if not system.fresh or system.order == 0 or not system.exchanges:
        return [step]
    largest = max(abs(f.now[0]) for f in system.forces)
    change = step * max(abs(f.now[1]) for f in system.forces)
    halvings = least
    if change > STEEP * largest > 0.0:
        halvings = max(least, min(MOST_HALVINGS, math.ceil(math.log2(change / (FIRST * largest)))))
    if not halvings:
        return [step]
    first = math.ldexp(step, -halvings)
    return [first, *(math.ldexp(step, -k) for k in range(halvings, 0, -1))]
