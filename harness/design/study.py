"""`Scene.design`: from what a user writes to the candidates that are judged."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from ..errors import SceneError, UserError, refuse_count
from ..motions.starts import refuse_unknown
from ..output.workers import Progress, Workers
from ..scene import Scene
from ..units import si_number
from .drags import drag_range
from .fitting import Fitting, fitting
from .scenes import race_of, unbalance_of, weights_of, with_balls
from .space import Space, read_space


def design(
    scene: Scene,
    unbalance: float | str | None,
    *,
    race: float | str | None,
    width: float | str | None,
    clearance: float | str,
    material: str | float,
    reserve: float,
    start: str,
    run_up: float | str | None,
    drag: float | str | None,
    oil: str | None,
    standard: bool,
    starts: int,
    counts: Sequence[int],
    workers: Workers = 1,
    progress: Progress | None = None,
) -> Fitting:
    """As `Scene.design`, which says what is meant and raised."""
    refuse_unknown([start])
    refuse_count(starts, "n")
    scene.refuse_friction("a design compares with the vibration without balancers, which is that")
    scene.refuse_free("a design")
    scene.refuse_restraints("a design compares with the vibration without balancers, that")
    steady, drive = _driven(scene, start, run_up)
    given = read_space(unbalance, race, width, material, reserve)
    steady = with_balls(steady, given["race"], given["width"])
    balls = weights_of(steady)
    if standard and balls.kind != "balls":
        raise UserError("--standard: standard diameters are those of balls")
    room = 2.0 * (balls.weight_radius or 0.0) if given["width"] is None else given["width"]
    free = si_number(clearance, "m", "--clearance")
    if not 0.0 <= free < room:
        raise UserError(f"--clearance {clearance}: must be 0 or more, and less than the width")
    space = Space(
        given["race"] or race_of(balls), room, free, given["density"], given["least"],
        unbalance_of(steady) if given["unbalance"] is None else given["unbalance"], reserve,
    )  # fmt: skip
    if not space.unbalance > 0.0:
        raise UserError("--unbalance: must be above 0, such as 300 g mm: it is what is balanced")
    drags = drag_range(scene, drag, oil)
    options: dict[str, Any] = {"workers": workers, "progress": progress, "drive": drive}
    return fitting(
        steady,
        space,
        drags,
        counts=counts,
        start=start,
        starts=starts,
        standard=standard,
        **options,
    )


def _driven(scene: Scene, start: str, run_up: float | str | None) -> tuple[Scene, dict[str, Any]]:
    """The scene at its constant speed, and the changes that make its run-up."""
    profile, own = scene.profile(), scene.operation
    if own.motor is not None:
        raise SceneError(
            f"{scene.label}: design: operation.motor: give operation.speed or run_up instead; "
            "check the weights that are recommended with `autobalancer motions`"
        )
    seconds = None if run_up is None else si_number(run_up, "s", "--run-up")
    if seconds is not None and (start != "run-up" or not seconds > 0.0):
        raise UserError(f"--run-up {run_up}: must be above 0, and belongs to --starts run-up")
    drive: dict[str, Any] = {}
    if seconds is not None:
        drive = {"operation.profile": [[0.0, 0.0], [seconds, profile.end]]}
    elif profile.changes:
        corners = zip(profile.times, profile.speeds, strict=True)
        drive = {"operation.profile": [list(corner) for corner in corners]}
    gone = {"operation.run_up": None, "operation.profile": None, "run.revolutions": None}
    steady = scene.replace({"operation.speed": profile.end, **gone}) if profile.changes else scene
    return steady, {"operation.speed": None, **drive} if drive else {}
