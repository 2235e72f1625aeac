"""Check scenes against theory, one or many, the many in parallel processes."""

from __future__ import annotations

import os
import warnings
from collections import Counter
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path
from typing import Any

from ..errors import SimulationError
from ..master.left_out import left_out
from ..master.plan import plan
from ..output.outcome import Outcome
from ..output.table import Sheet
from ..output.workers import ItemProgress, Progress, Workers, as_they_come
from ..scene import Scene, bundled_scenes, load_scene
from ..scene.plausible import ImplausibleWarning
from .registry import CheckPart, parts_of
from .report import as_json, table
from .row import Row, Rows


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
    moved = None if progress is None else (lambda _scene, done: progress(done))
    (found,) = check_all([scene], moved, workers=1, isolate=False)
    return list(found.rows)


def checked_scenes() -> list[Scene]:
    """The bundled scenes that have something to check, but for those checked only on request."""
    scenes = map(load_scene, bundled_scenes())
    return [scene for scene in scenes if scene.checks and not scene.on_request]


def check_all(
    scenes: Sequence[Scene],
    progress: ItemProgress | None = None,
    workers: Workers | None = None,
    isolate: bool = True,
) -> list[SceneReport]:
    """Check many scenes, all their checks side by side; results in the scenes' order.

    Args:
        progress: called with a scene's name and its finished fraction.
        workers: processes, by default as many as there are cores, or an executor.
        isolate: a run that cannot be completed becomes a row that does not hold, so that the others
            are seen.

    Raises:
        UserError: a scene or an FMU is wrong.
    """
    split = [parts_of(scene) for scene in scenes]
    parts, owners = list(chain(*split)), [i for i, some in enumerate(split) for _ in some]
    left = Counter(owners)
    found: dict[int, list[Row]] = {}
    work = _rows_or_failure if isolate else CheckPart.rows
    with closing(as_they_come(work, parts, workers or os.cpu_count() or 1)) as ready:
        for index, rows in ready:
            found[index] = rows
            number = owners[index]
            left[number] -= 1
            if progress:
                progress(scenes[number].name, 1.0 - left[number] / len(split[number]))
    reports = []
    for number, (scene, name) in enumerate(zip(scenes, unique_names(scenes), strict=True)):
        mine = [found[index] for index, owner in enumerate(owners) if owner == number]
        named = tuple(replace(row, scene=name) for row in chain(*mine))
        left_out_of = tuple(left_out(scene, ["all"]))
        reports.append(SceneReport(name, scene.title, named, plan(scene).files, left_out_of))
    return reports


def _rows_or_failure(part: CheckPart) -> list[Row]:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ImplausibleWarning)  # commands print them as a line
            return part.rows()
    except SimulationError as error:
        rows = Rows(part.scene.name, part.kind)
        return [rows.statement("run", "completed", str(error), False, "")]


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
