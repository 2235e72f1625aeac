"""Check scenes against theory, one or many, the many in parallel processes."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import chain, islice
from pathlib import Path
from typing import Any

from ..errors import SceneError, SimulationError
from ..master.left_out import left_out
from ..master.plan import plan
from ..output.outcome import Outcome
from ..output.table import Sheet
from ..output.workers import ItemProgress, Progress, Workers
from ..scene import Scene, bundled_scenes, load_scene
from .registry import parts_of, run_checks, run_parts
from .report import as_json, table
from .row import Row


@dataclass(frozen=True, repr=False)
class SceneReport(Outcome):
    """Rows of one scene, its FMUs, and what the scene lets be left out."""

    scene: str
    title: str
    rows: tuple[Row, ...]
    units: tuple[str, ...]
    left_out: tuple[str, ...]

    @property
    def holds(self) -> bool:
        """Whether every row holds."""
        return all(row.holds for row in self.rows)

    def table(self) -> Sheet:
        """What was expected and measured, row for row."""
        return table(self.rows, self.title or self.scene)

    def as_json(self) -> dict[str, Any]:
        """The rows, and whether all hold."""
        return as_json(self.rows)


def check(source: Scene | str | Path, progress: Progress | None = None) -> list[Row]:
    """Every [[check]] of a scene, a scene file, or a bundled scene.

    Raises:
        UserError: the scene is wrong, or has nothing to check.
        SimulationError: a run cannot be completed correctly.

    >>> all(row.holds for row in ab.check("liquid_touch"))
    True
    """
    scene = source if isinstance(source, Scene) else load_scene(source)
    _refuse_unchecked(scene)
    return run_checks(scene, progress)


def checked_scenes() -> list[Scene]:
    """The bundled scenes that have something to check, but for those checked only on request."""
    scenes = map(load_scene, bundled_scenes())
    return [scene for scene in scenes if scene.checks and not scene.on_request]


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
    owners = [number for number, some in enumerate(parts) for _ in some]

    def report(index: int, done: list[float]) -> None:
        if progress:
            number = owners[index]
            shares = [one for one, owner in zip(done, owners, strict=True) if owner == number]
            progress(scenes[number].name, sum(shares) / len(shares))

    cores = os.cpu_count() or 1
    ready = iter(run_parts(list(chain(*parts)), workers or cores, report, (SimulationError,)))
    reports = []
    for scene, name, some in zip(scenes, unique_names(scenes), parts, strict=True):
        rows = tuple(replace(row, scene=name) for row in chain(*islice(ready, len(some))))
        left = tuple(left_out(scene, ["all"]))
        reports.append(SceneReport(name, scene.title, rows, plan(scene).files, left))
    return reports


def unique_names(scenes: Sequence[Scene]) -> list[str]:
    """A name for the rows and files of every scene: its own, numbered where others share it."""
    taken: dict[str, list[Path | None]] = {}
    names = []
    for scene in scenes:
        place = scene.path.resolve() if scene.path else None
        places = taken.setdefault(scene.name, [])
        if place not in places:
            places.append(place)
        number = places.index(place) + 1
        names.append(scene.name if number == 1 else f"{scene.name}-{number}")
    return names


def _refuse_unchecked(scene: Scene) -> None:
    if not scene.checks:
        raise SceneError(
            f"{scene.path or scene.name}: nothing to check: add a [[check]] table, for example "
            'kind = "liquid_window"'
        )
