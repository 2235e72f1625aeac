"""When the units meet, and how the rotor is driven: communication steps over a scene's run."""

from __future__ import annotations

import math

from ...models.constants import DEFAULT_TOLERANCE
from ..scene import Scene
from ..scene.run import DEFAULT_STEPS, UNCORRECTED
from .limits import BRIEF_STEP, FULL_BRIEF_TOLERANCE, SMALLEST_BRIEF_SHARE
from .runtime import runtime

SLIVER = 1e-12  # of a time: rounding, not a step


def in_one_piece(scene: Scene) -> Scene:
    """The scene as one file runs it: with its tolerance, or the default in place of given steps."""
    return scene.once(_in_one_piece)


def _in_one_piece(scene: Scene) -> Scene:
    given = scene.coupling.tolerance
    return scene if given else scene.replace({"coupling.tolerance": DEFAULT_TOLERANCE})


def meets_events(scene: Scene) -> bool:
    """Whether steps of separate units end where a stop is touched or a weight or support sticks.

    That takes native units, and steps that are taken back.  Corners of a motor's characteristic lie
    within steps all the same.
    """
    corrects = scene.coupling.scheme not in UNCORRECTED
    native = runtime(scene.coupling.units).backend == "native"
    return scene.has_events and corrects and native


def brief_step(scene: Scene) -> float:
    """Step in which an event, its pulse or a jump of the drive has less error than a step [s]."""
    share = min(
        1.0,
        max(
            SMALLEST_BRIEF_SHARE,
            (scene.coupling.tolerance or FULL_BRIEF_TOLERANCE) / FULL_BRIEF_TOLERANCE,
        ),
    )
    return share * BRIEF_STEP * step_size(scene)


def at_fixed_steps(scene: Scene) -> Scene:
    """The scene with given steps, the default number where it has a tolerance."""
    return scene.once(_at_fixed_steps)


def _at_fixed_steps(scene: Scene) -> Scene:
    return scene.replace({"coupling.steps_per_rev": steps_per_rev(scene)})


def steps_per_rev(scene: Scene) -> int:
    """Communication steps in a revolution at the highest speed."""
    return scene.coupling.steps_per_rev or DEFAULT_STEPS


def step_size(scene: Scene, steps: int | None = None) -> float:
    """Communication step [s]: a fraction of the shortest revolution of the run.

    `steps` a revolution are by default the scene's.
    """
    return 2.0 * math.pi / (scene.profile().top * (steps or steps_per_rev(scene)))


def end_time(scene: Scene) -> float:
    """Time after which the scene's run is done [s]."""
    if scene.run.duration is not None:
        return scene.run.duration
    if scene.runs_its_profile:
        return scene.profile().seconds
    return scene.profile().time_of(2.0 * math.pi * scene.run.revolutions)


def milestones(scene: Scene) -> list[float]:
    """Times that must be communication points [s]: corners, changes of unbalance, the run's end."""
    end = end_time(scene)
    jumps = {*scene.profile().times, *(c.time for c in scene.operation.unbalance_changes)}
    return [*sorted(time for time in jumps if 0.0 < time < end), end]


def schedule(scene: Scene, steps: int | None = None) -> list[tuple[float, int]]:
    """Fixed step lengths [s] and how many of each, so that every milestone is met.

    `steps` a revolution are by default the scene's.
    """
    parts = []
    start = 0.0
    for bound in milestones(scene):
        # a remainder of rounding must not become a step of its own
        count = max(1, math.ceil((bound - start) / step_size(scene, steps) - 1e-9))
        parts.append(((bound - start) / count, count))
        start = bound
    return parts
