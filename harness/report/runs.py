"""The runs that a page needs: the scene as it is, and switched on from rest, with and without."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

from ..capture.captured import captured_or_none
from ..errors import SimulationError, UserError
from ..motions.outcome import Motions, Point
from ..motions.starts import drive_to, holders, job, length
from ..motions.study import find_motions
from ..output.workers import Workers
from ..result.result import Result
from ..result.run import cosimulate
from ..scene import Scene

STARTS = 40  # random ones of each kind
SEED = 1  # of these
LONGEST = 5000  # revolutions of a run that is to settle
_NO_DRIVE = {"operation.speed": None, "operation.run_up": None, "operation.motor": None}


@dataclass(frozen=True)
class SwitchedOn:
    """A run from standstill, or why there is none.

    Attributes:
        scene: as it was run up, weights at rest.
        run: with its balancers.
        bare: without them; None where there are none, or it failed.
        reason: why there is no run.
        assumed: how it is run up where the scene does not say.
        motions: of `STARTS` random starts of each kind; None: not known, `unknown` says why.
    """

    scene: Scene
    run: Result | None
    bare: Result | None
    reason: str = ""
    assumed: str = ""
    motions: Motions | None = None
    unknown: str = ""

    @property
    def run_ups(self) -> Point | None:
        """Random starts from standstill."""
        points = self.motions.points if self.motions else ()
        return next((point for point in points if point.start == "run-up"), None)


def own_run(scene: Scene) -> Result:
    """The scene as it is."""
    return _quietly(scene)


def switched_on(scene: Scene, seconds: float | None = None, workers: Workers = 1) -> SwitchedOn:
    """The scene's own drive where the speed rises from rest, else a run-up at a steady rate.

    Args:
        seconds: of the run-up [s]; default: of a slow one.
        workers: processes that run the random starts.
    """
    started, assumed = from_rest(scene, seconds)
    motions, unknown = _motions(started, workers)
    started = _typical(started, motions)
    try:
        started, run = _settled(started)
        bare = _quietly(started.without_balancers()) if started.balancer else None
    except (UserError, SimulationError) as error:
        return SwitchedOn(started, None, None, str(error), assumed, motions, unknown)
    return SwitchedOn(started, run, bare, "", assumed, motions, unknown)


def _typical(scene: Scene, motions: Motions | None) -> Scene:
    """The scene from that random start whose largest vibration is the median.

    Weights that begin evenly spread are no unbalance, and vibrate less than from nearly any start.
    """
    if motions is None:
        return scene
    point = next(point for point in motions.points if point.start == "run-up")
    made, _ = job(scene, point.speed, "run-up", SEED, point.middle, 1)
    angles, changes = made.values[0, 0::2].tolist(), {}
    for one in holders(scene):
        changes[f"{one.label}.angles"] = angles[: one.count]
        angles = angles[one.count :]
    return scene.replace(changes)


def _settled(scene: Scene) -> tuple[Scene, Result]:
    """A run, and the scene as it was run: once more, as long as the first one says it takes."""
    run = _quietly(scene)
    needed = run.summary().revolutions
    if needed is None or needed > LONGEST:
        return scene, run
    scene = scene.replace({"run.revolutions": needed})
    return scene, _quietly(scene)


def _motions(scene: Scene, workers: Workers) -> tuple[Motions | None, str]:
    """How random starts end, from the real start and from the friendliest."""
    if captured_or_none(scene) is None:
        return None, ""
    kinds = ["run-up"] if scene.operation.motor else ["run-up", "rest", "turning"]
    try:
        return find_motions(
            scene, [scene.profile().end], kinds, STARTS, seed=SEED, workers=workers
        ), ""
    except (UserError, SimulationError) as error:
        return None, str(error)


def from_rest(scene: Scene, seconds: float | None = None) -> tuple[Scene, str]:
    """The scene with a run-up from standstill, and what was assumed for it; weights at rest."""
    if scene.operation.motor and seconds is None:
        return scene, ""
    speed = scene.profile().end
    if seconds is not None:
        scene = scene.replace({**_NO_DRIVE, "operation.profile": [[0.0, 0.0], [seconds, speed]]})
    driven, reached, said = drive_to(scene, speed, "run-up")
    corners = [list(c) for c in zip(driven.profile().times, driven.profile().speeds, strict=True)]
    if driven.profile().speed(0.0) > 0.0:  # the scene's own rises from a speed
        still: dict[str, Any] = {}
    else:
        still = {f"{one.label}.speeds": [0.0] * one.count for one in holders(scene)}
    corners.append([reached + length(scene, speed), speed])
    assumed = f"{said} (--run-up 4s for your own)" if said else ""
    drive = {**_NO_DRIVE, "operation.profile": corners, "run.revolutions": None}
    return driven.replace({**drive, **still}), assumed


def _quietly(scene: Scene) -> Result:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return cosimulate(scene.replace({"run.record": None}))  # what a verdict needs
