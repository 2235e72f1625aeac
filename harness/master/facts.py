"""The facts of a run, and the words that are made of them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from ..errors import LoopError
from ..scene import Scene
from ..scene.run import LOOSEST_TOLERANCE
from .limits import LOOSE_RESIDUAL, STATED_ERROR

NOT_ESTIMATED = (
    "the error of separate units in given steps is not estimated: use a tolerance, or one file"
)
NOT_ESTIMATED_OF_UNITS = (
    "the error of the coupling in given steps is not estimated: use coupling.tolerance"
)
FEW = 10  # given steps per revolution from which the estimate of what they miss can be trusted


@dataclass(frozen=True, kw_only=True)
class RunFacts:
    """What a run of coupled units did.

    Attributes:
        files: names of the FMUs loaded, or of the one file.
        note: on the kind of the units, where it is not the one asked for.
        messages: what the units have logged.
        calls: number of FMI calls by kind; none of one file.
        passes: steps of the rotor: corrector passes and rejected steps count.
        steps: communication steps.
        unconverged: steps whose forces were left changing, and the worst of their residuals.
        estimated_error: of the motion, relative to itself, for steps too long for the signals;
            0 where nothing is estimated.
        unresolved: steps with a signal that the cubics do not follow.
        unknown_error: why the error of the run is not known; empty where it is.
    """

    files: tuple[str, ...]
    note: str
    messages: tuple[str, ...]
    calls: Mapping[str, int]
    passes: int
    steps: int
    unconverged: int
    worst_residual: float
    estimated_error: float = 0.0
    unresolved: int = 0
    unknown_error: str = ""


@dataclass(frozen=True, kw_only=True)
class Facts(RunFacts):
    """What a co-simulation of a scene did.

    Attributes:
        scene: that was run.
        series_order: of the machine in one piece, which goes on by power series; 0: its parts are
            coupled by signals.
        collocated_steps: of a stiff machine in one piece: steps by collocation.
    """

    scene: Scene
    series_order: int = 0
    collocated_steps: int = 0


def exchanging(scene: Scene) -> bool:
    """Whether something has to be predicted over a step: a balancer's force, how a motor turns."""
    sent = any(balancer.exchanges_force for balancer in scene.balancer)
    return sent or scene.operation.motor is not None


def _told(facts: RunFacts) -> list[str]:
    """What the units have told, and steps whose loop has not converged."""
    notes = [*filter(None, [facts.note]), *facts.messages]
    if facts.unconverged:
        notes.append(
            f"{facts.unconverged} of {facts.steps} steps left a residual above "
            f"{LOOSE_RESIDUAL:g} of the force (worst {facts.worst_residual:.2g}): use smaller "
            "steps or more corrections"
        )
    return notes


def events(facts: Facts) -> list[str]:
    """What a user must know about the run: validity and convergence."""
    notes = _told(facts)
    tolerance = facts.scene.coupling.tolerance
    if tolerance is not None:
        if facts.unknown_error:
            notes.append(
                f"the error of this run is not known: {facts.unknown_error} (tolerance "
                f"{tolerance:g}): impacts decide the motion, and only mean and rms of a long run "
                "are known: use a smaller run.revolutions, or other start values"
            )
        elif facts.estimated_error > tolerance:
            notes.append(
                f"tolerance = {tolerance:g} is not kept: runs with ever shorter steps still "
                f"differ, the relative error of the motion is about {facts.estimated_error:.1g}: "
                f"use {_looser(facts.estimated_error)}a smaller run.revolutions; where "
                "neighbouring motions diverge, only mean and rms of a long run are known"
            )
    elif facts.estimated_error >= STATED_ERROR:
        notes.append(
            "steps too long for signals that vary faster: the relative error of the motion is "
            f"about {facts.estimated_error:.1g}: use more coupling.steps_per_rev, or a tolerance"
        )
    elif facts.unresolved:
        notes.append(
            f"{facts.unresolved} of {facts.steps} steps were too long for signals that "
            "vary faster: use more coupling.steps_per_rev, or a tolerance"
        )
    elif facts.calls and exchanging(facts.scene):
        notes.append(NOT_ESTIMATED)
    elif (facts.scene.coupling.steps_per_rev or FEW) < FEW and exchanging(facts.scene):
        notes.append(
            f"{facts.scene.coupling.steps_per_rev} steps per revolution are few, and errors that "
            "gather over many revolutions are not estimated: use a tolerance"
        )
    return notes


def events_of_units(facts: RunFacts, tolerance: float | None, coupled: bool) -> list[str]:
    """The same of a run of units of any origin, with a tolerance or in given steps."""
    notes = _told(facts)
    if tolerance is None:
        return [*notes, NOT_ESTIMATED_OF_UNITS] if coupled else notes
    if facts.estimated_error > tolerance:
        notes.append(
            f"tolerance = {tolerance:g} is not kept: runs with ever shorter steps still differ, "
            f"the relative error is about {facts.estimated_error:.1g}: use "
            f"{_looser(facts.estimated_error)}a smaller run.duration; a unit whose own solver errs "
            "by that much, or that jumps, allows no smaller one"
        )
    return notes


def _looser(error: float) -> str:
    """The tolerance that such an error keeps, as advice; empty where none so loose is allowed."""
    kept = 10.0 ** math.ceil(math.log10(error))
    return f"coupling.tolerance = {kept:g} or " if kept <= LOOSEST_TOLERANCE else ""


def advice(error: Exception, scene: Scene, meets_events: bool = False) -> str:
    """What to do where forces that jump keep a loop from converging; empty where none can.

    Where a weight sticks, or collides and no step ends there, no step is short enough for a
    tolerance, and corrector passes need not agree on whether it happens.
    """
    coupling = scene.coupling
    names = [b.label for b in scene.balancer if b.can_meet or b.can_stick]
    asked = coupling.corrections is not None
    if asked or not isinstance(error, LoopError) or meets_events or not names:
        return ""
    why = "corrector passes need not agree on it"
    if coupling.tolerance is not None:
        why = f"no step is short enough for tolerance = {coupling.tolerance:g}"
    return (
        f"; the weights of {', '.join(names)} can touch or stick: where one does, the force jumps "
        f"within the step, and {why}: give coupling.corrections (for example 4) with "
        "steps_per_rev instead, then such steps are counted and reported"
    )
