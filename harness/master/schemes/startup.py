"""What a communication step is divided into: at the start, and at a jump of the drive.

Weights under heavy drag d are pulled into the rotor's motion within 1/d: a cubic over the whole
step with the slope of that first instant is wrong by d times the step, while its loop converges
perfectly.  So a step without a past is divided into parts that double.

Where the rotor's acceleration jumps, the units' outputs are still those before the jump, and FMI
2.0 lets nobody read new ones without a step: so a negligible part of the step is taken on its own.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from ..schedule import DrivenSpeed
from ..system import System
from .protocol import Scheme

STEEP = 0.2  # of the force: more than this by the slope of its first instant, and a step is divided
FIRST = 0.05  # of the force: what it may change by that slope over the first part
MOST_HALVINGS = 60  # a force that rises from exactly zero has no size to compare with
KINK = 1e-6  # of a step: it errs by less than 1e-7, and rounding does not yet spoil the slopes


def substeps(
    system: System, scheme: Scheme, drive: DrivenSpeed, time: float, step: float
) -> Iterable[tuple[float, float]]:
    """Begin and length of every step to be taken for one communication step [s]; mostly itself.

    The units are told of the drive on the way, and brought over its jumps.
    """
    if system.has_no_past and not scheme.chooses_steps:
        return _divided(system, scheme, drive, time, step)
    if drive.jumps(time):
        return _across(system, scheme, time, step, drive.brief)
    return ((time, step),)


def _divided(
    system: System, scheme: Scheme, drive: DrivenSpeed, time: float, step: float
) -> Iterator[tuple[float, float]]:
    """Parts of a step without a past, those at a jump of the drive brought over it."""
    parts, begin = doubling_steps(system, step, scheme.startup_halvings), time
    for part in parts:
        if drive.jumps(begin):
            yield from _across(system, scheme, begin, part, drive.brief)
        else:
            yield begin, part
        begin += part
    if len(parts) > 1:
        scheme.after_start(system, begin, step)


def _across(
    system: System, scheme: Scheme, begin: float, step: float, brief: float
) -> Iterator[tuple[float, float]]:
    """What is left of a step that begins with a jump of the drive, divided if need be.

    Of a step that is to be chosen, which is all that is left, a `brief` one is negligible.
    """
    negligible = min(KINK * step, brief)
    scheme.cross_jump(system, begin, negligible)
    system.drop_past()
    begin += negligible
    pieces = [step - negligible]
    if scheme.startup_halvings:
        pieces = doubling_steps(system, pieces[0], scheme.startup_halvings)
    for piece in pieces:
        yield begin, piece
        begin += piece


def doubling_steps(system: System, step: float, halvings: int = 0) -> list[float]:
    """Lengths that add up to `step` [s], doubling; just `step` where nothing is steep.

    Args:
        halvings: wanted in any case.
    """
    if system.order == 0 or not system.coupled:
        return [step]
    largest = max(max(abs(force.now[0]), force.largest) for force in system.forces)
    change = step * max(abs(force.now[1]) for force in system.forces)
    if change > STEEP * largest > 0.0:
        steep = math.ceil(math.log2(change / (FIRST * largest)))
        halvings = max(halvings, min(MOST_HALVINGS, steep))
    if not halvings:
        return [step]
    first = math.ldexp(step, -halvings)
    return [first, *(math.ldexp(step, -k) for k in range(halvings, 0, -1))]
