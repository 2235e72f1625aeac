"""Check scenes against theory, one or many, the many in parallel processes."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from ..errors import SceneError, SimulationError
from ..master.left_out import left_out
from ..master.plan import plan
from ..output.workers import Failed, ItemProgress, Progress, Workers
from ..scene import Scene, bundled_scenes, load_scene
from .registry import Part, cores, parts_of, run_checks, run_parts
from .row import Row, Rows


@dataclass(frozen=True)
class SceneReport:
    """Rows of one scene, its FMUs, and what the scene lets be left out."""

    scene: str
    title: str
    rows: tuple[Row, ...]
    units: tuple[str, ...]
    left_out: tuple[str, ...]


def check(source: Scene | str | Path, progress: Progress | None = None) -> list[Row]:
    """Every [[check]] of a scene, a scene file, or a bundled scene.

    Raises:
        UserError: the scene is wrong, or has nothing to check.
        SimulationError: a run cannot be completed correctly.
    """
    scene = source if isinstance(source, Scene) else load_scene(source)
    _refuse_unchecked(scene)
    return run_checks(scene, progress)


def checked_scenes() -> list[Scene]:
    """The bundled scenes that have something to check, but for those checked only on request."""
    scenes = map(load_scene, bundled_scenes())
    return [scene for scene in scenes if scene.check and not scene.on_request]


def check_all(
    scenes: Sequence[Scene],
    progress: ItemProgress | None = None,
    workers: Workers | None = None,
) -> list[SceneReport]:
    """Check many scenes, all their checks side by side; results in the scenes' order.

    A run that cannot be completed becomes a row that does not hold, so that the others are seen.

    Args:
        progress: called with a scene's name and its finished fraction.
        workers: processes, by default as many as there are cores, or an executor.

    Raises:
        UserError: a scene or an FMU is wrong.
    """
    for scene in scenes:
        _refuse_unchecked(scene)
    parts = [parts_of(scene) for scene in scenes]
    flat = [(number, part) for number, some in enumerate(parts) for part in some]
    done = [0.0] * len(flat)

    def report(index: int, fraction: float) -> None:
        done[index] = fraction
        number = flat[index][0]
        if progress:
            shares = [one for one, (owner, _) in zip(done, flat, strict=True) if owner == number]
            progress(scenes[number].name, sum(shares) / len(shares))

    rows: dict[int, list[Row]] = {}
    work = [part for _, part in flat]
    with closing(run_parts(work, workers or cores(), report, (SimulationError,))) as ready:
        for index, outcome in ready:
            rows[index] = _lost(work[index], outcome) if isinstance(outcome, Failed) else outcome
    reports = []
    for number, scene in enumerate(scenes):
        own = [row for i, (owner, _) in enumerate(flat) if owner == number for row in rows[i]]
        left = tuple(left_out(scene, ["all"]))
        reports.append(SceneReport(scene.name, scene.title, tuple(own), plan(scene).files, left))
    return reports


def _lost(part: Part, failed: Failed) -> list[Row]:
    rows = Rows(part.scene.name, part.check.kind)
    return [rows.statement("run", "completed", str(failed.error), False, "")]


def _refuse_unchecked(scene: Scene) -> None:
    if not scene.check:
        raise SceneError(
            f"{scene.path or scene.name}: nothing to check: add a [[check]] table, for example "
            'kind = "liquid_window"'
        )
