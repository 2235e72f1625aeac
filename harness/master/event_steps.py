"""Steps that end at events of the units: a stop is touched or let go, a support or a weight sticks.

A unit integrates from event to event.  Over a step with an event inside, what it sends is no cubic:
its signals jump or have a corner, and the coupling has order 1.  So the unit is told to end such a
step at its first event, by `shortest_stopped_step`; FMI 2.0 has `fmi2Discard` and
`fmi2LastSuccessfulTime` for it.  Weights that can collide are not told: the rotor receives an
impulse over two steps.

Data flow of a step: the scheme tries it; a unit ends early (`EndedEarly`); the scheme rolls all
units back; the step is tried again, so that it ends shortly before the event; a brief step leads
over the event, and the signals start from there without a past.  The forces of the first trial are
predicted: where those that agree move the event, the next trial finds it again.

The unit finds events, the scheme rolls back, and this file chooses the steps.  A unit that is not
told steps through its events, as it does under other masters.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from ..errors import SimulationError
from ..scene import Scene
from .fmu import EndedEarly
from .plan import ROTOR
from .schedule import SLIVER

SHORTEST_STOPPED = 3.0  # brief steps: a shorter step is taken whole, with all its events
HERE = 1.5  # brief steps: an event that is so near is crossed by the next one
BESIDE = 0.5  # of a brief step: a step ends so far before an event, or behind it
SHORT = 0.25  # of a step: one that is shorter says nothing of a whole one
BEFORE = 0.9  # of the way to an event: what a trial step may take
MOST_CROSSINGS = 4  # brief steps over one event, the last of which must agree
MOST_TRIALS = 10000  # of a step: so often the unit's own supports may change in one


def stopping_parameters(scene: Scene, brief: float) -> dict[str, dict[str, float | bool]]:
    """What tells units to end steps at events, by unit name.

    Args:
        brief: step that crosses an event [s].
    """
    shortest = {"shortest_stopped_step": SHORTEST_STOPPED * brief}
    found: dict[str, dict[str, float | bool]] = {}
    if scene.rotor.stops or scene.rotor.friction:
        found[ROTOR] = {**shortest}
    for one in scene.balancer:
        if one.can_stick and not one.can_meet:
            found[one.label] = {**shortest, "stop_at_contact": True}
    return found


class Advance(Protocol):
    """Goes on by a part of a step [s].

    At an event, over it or up to it, forces must agree: where they jump an event would be lost.
    `tolerant`: where they do not, that is no error.  Returns whether they agree.

    Raises:
        EndedEarly: an event is within it, and it is rolled back.
    """

    def __call__(self, part: float, at_event: bool, tolerant: bool = False) -> bool: ...


def cover_events(step: float, brief: float, advance: Advance) -> None:
    """Go through a step, to each of its events and over it.

    Args:
        step: [s].
        brief: step that crosses an event [s].
        advance: takes a step.

    Raises:
        SimulationError: events without an end.
    """
    left = trial = step
    for _ in range(MOST_TRIALS):
        try:
            advance(trial, trial < left)
        except EndedEarly as early:
            trial = early.made - BESIDE * brief
            if early.made > HERE * brief:
                continue
            left -= _cross(early.made + BESIDE * brief, left, brief, advance)
        else:
            left -= trial
        if left <= SLIVER * step:
            return
        trial = left
    raise SimulationError(
        f"the rotor touches stops, or supports or weights stick and slip, more than {MOST_TRIALS} "
        f"times in a step of {step:.3g} s: use smaller steps"
    )


def _cross(first: float, left: float, brief: float, advance: Advance) -> float:
    """Go over an event by a brief step, `first`, and more of them until forces agree [s].

    Passes need not agree on what an event changes: a support that sticks by one force slips by its
    answer.  In a brief step that moves nothing, and behind it the forces are others.
    """
    done, trial = 0.0, first
    for number in range(MOST_CROSSINGS):
        trial = left - done if left - done < trial + brief else trial
        agrees = advance(trial, True, number < MOST_CROSSINGS - 1)
        done += trial
        if agrees or left - done <= SLIVER * left:
            break
        trial = brief
    return done


def before_events(step: float, act: Callable[[float], None]) -> None:
    """Do something that takes trial steps [s] without events and leaves the units where they are.

    Where an event is so near that only short steps fit before it, it is left out.
    """
    trial = step
    while trial >= SHORT * step:
        try:
            return act(trial)
        except EndedEarly as early:
            trial = BEFORE * early.made
    return None
