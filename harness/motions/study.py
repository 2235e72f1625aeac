"""Every steady motion that many starts of a scene reach, over speed and kind of start."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import tomli_w

from ..capture.captured import captured
from ..errors import SceneError, UserError, refuse_count, refuse_seed
from ..output.store import open_store
from ..output.workers import Progress, Workers, in_order
from ..scene import Scene
from .kinds import Kind, motion_of
from .outcome import Motions, Point, Share
from .settle import alone, settle
from .starts import STARTS, drive_to, job, perturbed, refuse_unknown, run_up_begins

if TYPE_CHECKING:
    from numpy.typing import NDArray

CHUNK = 25  # starts worked on together
_Rows = tuple["NDArray[Any]", ...]  # kind, weights, frequency, vibration, largest, failure


def find_motions(
    scene: Scene,
    speeds: Sequence[float],
    starts: Sequence[str],
    n: int,
    *,
    seed: int = 1,
    workers: Workers = 1,
    progress: Progress | None = None,
    store: str | Path | None = None,
) -> Motions:
    """As `Scene.motions`, which says what is raised."""
    refuse_seed(seed)
    _refuse(scene, speeds, starts, n)
    scene, said = perturbed(scene)
    closed = [captured(scene, speed).found for speed in speeds]
    notes = [said] if said else []
    meanings, word = dict(STARTS), ""
    if "run-up" in starts:
        driven, _, word = drive_to(scene, max(speeds), "run-up")
        meanings["run-up"] = f"{run_up_begins(driven)}, the speed rises"
    notes += [f"{start}: {meanings[start]}." for start in starts]
    if word:
        notes.append(f"{word[0].upper()}{word[1:]}.")
    jobs = [
        (scene, float(speed), start, seed, first, min(CHUNK, n - first))
        for speed in speeds
        for start in starts
        for first in range(0, n, CHUNK)
    ]
    kept = None if store is None else open_store(store, _made_for(scene, speeds, starts, n, seed))
    rows = in_order(_runs, jobs, workers, progress, kept)
    points, chunks = [], math.ceil(n / CHUNK)
    for k, (speed, start) in enumerate((s, t) for s in speeds for t in starts):
        parts = rows[k * chunks : (k + 1) * chunks]
        columns = [np.concatenate(each) for each in zip(*parts, strict=True)]
        found = closed[list(speeds).index(speed)]
        points.append(_point(columns, float(speed), start, found, alone(scene, speed)))
    _refuse_stalled(scene, points)
    return Motions(scene.heading, tuple(points), n, tuple(notes), scene)


def _runs(work: tuple[Scene, float, str, int, int, int]) -> _Rows:
    """Motions of some starts."""
    made, _ = job(*work)
    found, failure, largest = settle(work[0], made)
    return found.kind, found.weights, found.frequency, found.vibration, largest, failure


def _point(
    columns: Sequence[NDArray[Any]], speed: float, start: str, closed: Any, bare: float
) -> Point:
    kind, weights, frequency, vibration, largest, failure = columns
    named = [motion_of(*row, closed) for row in zip(kind, weights, frequency, strict=True)]
    names, shares = [one.name for one in named], []
    for name in sorted(set(names), key=lambda each: (-names.count(each), each)):
        motion, rows = named[names.index(name)], np.array([each == name for each in names])
        shares.append(
            Share(
                motion, int(rows.sum()), len(named),
                float(np.median(frequency[rows])), float(np.median(vibration[rows])),
            )
        )  # fmt: skip
    reasons = [str(f) for f in failure if f]
    middle = int(np.argsort(largest, kind="stable")[len(largest) // 2])
    return Point(
        speed, start, tuple(shares), bare, float(np.median(largest)),
        reasons[0] if reasons else "", middle,
    )  # fmt: skip


def _refuse(scene: Scene, speeds: Sequence[float], starts: Sequence[str], n: int) -> None:
    refuse_unknown(list(starts))
    refuse_count(n, "n")
    if not speeds or not all(speed > 0.0 for speed in speeds):
        raise UserError("speeds: must be positive, at least one")
    if scene.operation.unbalance_changes:
        scene.refuse_changes("a steady motion")
    scene.refuse_free("motions")
    captured(scene)  # refuses what has no weights, and dry friction
    if scene.operation.motor and "run-up" in starts and len(set(speeds)) > 1:
        raise SceneError(
            f"{scene.label}: operation.motor: the motor's run-up ends at its own speed alone: give "
            "--starts rest,turning for other speeds, or operation.run_up instead of the motor"
        )


def _refuse_stalled(scene: Scene, points: Sequence[Point]) -> None:
    if not scene.operation.motor:
        return
    for point in points:
        slow = next((s for s in point.shares if s.motion.kind is Kind.SLOW_ROTOR), None)
        if slow and slow.count == slow.of:
            raise SceneError(
                f"{scene.label}: operation.motor: the motor stalls: in all {slow.of} run-ups the "
                f"rotor stays at {slow.frequency:.4g} rad/s, below its {point.speed:.4g} rad/s: "
                "give more torque, or --starts rest,turning, which hold the speed"
            )


def _made_for(
    scene: Scene, speeds: Sequence[float], starts: Sequence[str], n: int, seed: int
) -> dict[str, str]:
    return {
        "content": "motions",
        "scene": tomli_w.dumps(scene.document),
        "speeds": " ".join(f"{speed!r}" for speed in speeds),
        "starts": " ".join(starts),
        "number of starts": str(n),
        "seed": str(seed),
    }
