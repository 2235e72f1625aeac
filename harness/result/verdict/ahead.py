"""A look ahead: what becomes of a run that has not settled, by a longer run of the same scene.

It runs only where a run's end leaves the question open, in C and no longer than `MOST_PASSES`
passes, and never for FMUs that were coupled separately: these may be another machine.

A motion that never settles amplifies every error.  Runs of ever smaller ones do not come together;
where two of them show the same, a third would show no more.
"""

from __future__ import annotations

import math
from collections.abc import Callable

from ...scene import Scene
from .known import Known
from .ran import Ran, run_again
from .stretches import Stretch, motor_angle

LONGER = 10.0  # times the run, at least
TIME_CONSTANTS = 25.0  # of the balanced motion, and as many of the weights' drag
SPARE = 20.0  # revolutions on top
MOST_PASSES = 100_000.0  # of a look ahead: about a second
FEWEST_PASSES = 30.0  # in a revolution, by which the cost of a very short run is guessed
SHORT = 3.0  # revolutions of such a run
# times the inertia times the speed without load over the largest torque: by then a motor that
# passes its resonances keeps its speed to some 1e-5
OF_MOTOR = 12.0
FEWEST_LONGER = 1.5  # times the run: a shorter look ahead tells nothing
LEAST_OF_REST = 0.01  # time constants: within fewer, weights that turn with the rotor hardly move
_CHANGES = "operation.unbalance_changes"
TOLERANCE = 1e-3  # of a look ahead: what becomes of a run needs no more


def look_ahead(
    run: Ran,
    stretch: Stretch,
    known: Known | None,
    ends: Callable[[Ran, Ran], bool],
    *,
    all_turn: bool = False,
) -> Ran | None:
    """A longer run that keeps a stretch's speed; None where it costs too much, or tells nothing.

    Args:
        known: facts at the speed that is kept; None: it still changes.
        ends: whether two runs that differ by more than the tolerance tell enough.
        all_turn: whether all weights turn with the rotor.
    """
    if run.separate:
        return None
    scene, end = kept(run.scene, stretch, float(run.time[-1])), float(run.time[-1])
    turned = max(scene.profile().angle(stretch.end) / math.tau, 1e-9)
    wanted = LONGER * turned
    if known is not None:
        slowest = min(known.time_constant, 1e300)
        rates = known.table.damping_rate
        if len(rates) and rates.min() > 0.0:
            slowest = max(slowest, 1.0 / float(rates.min()))
        further = TIME_CONSTANTS * slowest * known.speed / math.tau + SPARE
        wanted = max(wanted, turned + further)
    all_turns = max(run.scene.profile().angle(end) / math.tau, 1e-9)
    if scene.operation.motor:  # which turns slower than without load, and faster later
        all_turns = max(motor_angle(run.time, run.signals["motor.speed"])[-1] / math.tau, 1e-9)
    if scene.operation.motor:
        wanted = max(wanted, turned + _turns_of_motor(scene))
    elif known is None:
        profile = scene.profile()
        wanted = max(wanted, profile.angle(profile.times[-1]) / math.tau + LONGER * SPARE)
    passes = max(run.passes / all_turns, FEWEST_PASSES if all_turns < SHORT else 1.0)
    longer = min(wanted, MOST_PASSES / passes)
    if longer < FEWEST_LONGER * turned:
        return None
    if known is not None and all_turn and math.isfinite(known.time_constant):
        further = (longer - turned) * math.tau / known.speed
        if longer < wanted and further < LEAST_OF_REST * known.time_constant:
            return None
    changes: dict[str, float] = {"run.revolutions": longer}
    if scene.coupling.tolerance is not None:
        changes["coupling.tolerance"] = max(scene.coupling.tolerance, TOLERANCE)
    return run_again(scene.replace(changes), list(run.signals), ends)


def _turns_of_motor(scene: Scene) -> float:
    """Revolutions after which a motor keeps its speed, if no resonance holds it."""
    motor = scene.operation.motor
    assert motor is not None
    torque = max(torque for _, torque in motor.points)
    return OF_MOTOR * motor.inertia * motor.top_speed**2 / (math.tau * torque)


def kept(scene: Scene, stretch: Stretch, end: float) -> Scene:
    """The scene with the speed of a stretch before its end kept from there on, and the unbalance.

    Args:
        end: of the run [s].
    """
    if not stretch.end < end * (1.0 - 1e-9):
        return scene
    profile = scene.profile()
    corners = zip(profile.times, profile.speeds, strict=True)
    before = [(time, speed) for time, speed in corners if time < stretch.end]
    return changed_until(
        scene.replace({"operation.profile": [*before, (stretch.end, stretch.speed)]}), stretch.end
    )


def changed_until(scene: Scene, end: float) -> Scene:
    """The scene less the changes of its unbalance after a time [s]."""
    given = scene.document["operation"].get("unbalance_changes", [])
    planned = zip(given, scene.operation.unbalance_changes, strict=True)
    early = [table for table, change in planned if change.time <= end]
    return scene if len(early) == len(given) else scene.replace({_CHANGES: early})
