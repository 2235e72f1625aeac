"""Weights that collide, pack and stick, moved from event to event within a communication step.

An event is a gap that closes, a contact whose pressure would turn into tension, a sliding group
that comes to rest, or a resting one that breaks away.  The earliest one of a substep is located by
stepping again from the same point, to 1e-12 of the substep, so that smooth parts keep order 4.
"""

from __future__ import annotations

import cmath
from dataclasses import dataclass

from ..weights import substeps
from .centre import CentreMotion, Instant, instant, turned
from .event_functions import (
    COMES_TO_REST,
    GAP_CLOSES,
    KINDS,
    PULLED_OPEN,
    EventFunction,
    EventFunctions,
    event_value,
    find_event_function,
    may_happen,
)
from .groups import find_groups, moved
from .impacts import approaching, settle
from .ring import WeightsInOrder, place
from .roots import crossing

_LOCATED = 1e-12  # of the substep
_MOST_PARTS = 100_000  # substeps and events within a communication step


@dataclass(slots=True)
class EventStepper:
    """Weights on their way through one communication step.

    Attributes:
        time: since the start of the step [s].
        impulse: of all collisions on the rotor, in the rotor frame at the step's start [N s].
        events: their number, that of contacts opened and of weights stuck or broken away.
    """

    weights: WeightsInOrder
    motion: CentreMotion
    time: float = 0.0
    impulse: complex = 0j
    events: int = 0


def run(stepper: EventStepper, step: float) -> None:
    """Move to the end of the step.

    Raises:
        ArithmeticError: the input is not finite, or events do not come to an end.
    """
    if approaching(stepper.weights):
        _settle(stepper, -1)
    for _ in range(_MOST_PARTS):
        left = step - stepper.time
        # as `weights.advance`, so that weights that meet nothing move in its substeps
        count = substeps(
            stepper.weights.track.weights, stepper.weights.angle_rate, stepper.motion.signal,
            stepper.motion.angular_acceleration, step, left, _MOST_PARTS,
        )  # fmt: skip
        _part(stepper, step if count == 1 else stepper.time + left / count)
        if stepper.time >= step:
            return
    raise ArithmeticError(
        f"more than {_MOST_PARTS} substeps and events of the weights in {step:g} s, "
        f"{stepper.time:g} s reached: use smaller communication steps"
    )


def _part(stepper: EventStepper, until: float) -> None:
    """Move to the first event before `until`, or there."""
    weights, motion, begin = stepper.weights, stepper.motion, stepper.time
    now, later, length = instant(motion, begin), instant(motion, until), until - begin
    find_groups(weights, now)
    functions = EventFunctions(weights, motion, begin, now)
    width = _LOCATED * length
    _move_groups(functions, later, length)
    first, event = _earliest(functions, later, length, width)
    while event is not None:
        later = instant(motion, begin + first)
        _move_groups(functions, later, first)
        # what came and went within the longer stretch may show only in the shorter one
        earlier, other = _earliest(functions, later, first, width)
        if other is None or earlier >= first - width:
            break
        first, event = earlier, other
    groups = weights.groups
    for i in range(groups.count):
        if not groups.resting[i]:  # rounding must not make resting weights creep
            place(
                weights, groups.first[i], groups.size[i], groups.end_middle[i], groups.end_rate[i]
            )
    stepper.time = until if event is None else begin + first
    if event is not None:
        stepper.events += 1
        _happen(stepper, event)


def _move_groups(functions: EventFunctions, later: Instant, length: float) -> None:
    """Set where the groups are, and how fast, after `length`."""
    weights, groups = functions.weights, functions.weights.groups
    for i in range(groups.count):
        end = moved(weights, i, functions.now, later, length)
        groups.end_middle[i], groups.end_rate[i] = end


def _earliest(
    functions: EventFunctions, later: Instant, length: float, width: float
) -> tuple[float, EventFunction | None]:
    """Time of the first event of those that show at the ends of a stretch, to `width`."""
    first, event = length, None
    for kind in KINDS:
        if not may_happen(functions, kind):
            continue
        for i in range(functions.weights.groups.count):
            candidate = find_event_function(functions, kind, i, later, length)
            if candidate is None:
                continue
            not_before = event is not None and candidate.upper >= first
            if not_before and event_value(candidate, first) >= 0.0:
                continue
            upper = min(candidate.upper, first)
            first = crossing(event_value, candidate, candidate.start, upper, width)
            event = candidate
    return first, event


def _happen(stepper: EventStepper, event: EventFunction) -> None:
    """Change what an event changes; breaking away changes nothing but the groups."""
    weights = stepper.weights
    if event.kind == GAP_CLOSES:
        _settle(stepper, event.where)
    elif event.kind == PULLED_OPEN:
        weights.joined[event.where] = False
    elif event.kind == COMES_TO_REST:
        first, size = weights.groups.first[event.group], weights.groups.size[event.group]
        for k in range(first, first + size):
            weights.angle_rate[k % weights.count] = 0.0


def _settle(stepper: EventStepper, closed: int) -> None:
    motion, time = stepper.motion, stepper.time
    blow = settle(stepper.weights, instant(motion, time), closed)
    stepper.impulse += blow * cmath.rect(1.0, turned(motion, time))
