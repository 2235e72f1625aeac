"""Check scenes against theory, one or many, the many in parallel processes."""

from __future__ import annotations

import os
import queue
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, wait
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from ..errors import SceneError, SimulationError
from ..scene import Scene, bundled_scenes, load_scene
from .row import Row

_POLL = 0.1  # s between looks at the progress of the workers

Progress = Callable[[int, float], None]


@dataclass(frozen=True)
class Checked:
    """Rows of one scene, the FMUs loaded for them, and what the scene let be left out."""

    scene: str
    title: str
    rows: tuple[Row, ...]
    units: tuple[str, ...]
    left_out: tuple[str, ...]


def check(source: Scene | str | Path, progress: Callable[[float], None] | None = None) -> list[Row]:
    """Every [[check]] of a scene, a scene file, or a bundled scene.

    Raises:
        UserError: the scene is wrong, or has nothing to check.
        SimulationError: a run cannot be completed correctly.
    """
    from .registry import run_checks

    scene = source if isinstance(source, Scene) else load_scene(source)
    _refuse_unchecked(scene)
    return run_checks(scene, progress)


def checked_scenes() -> list[Scene]:
    """The bundled scenes that have something to check, but for those checked only on request."""
    scenes = map(load_scene, bundled_scenes())
    return [scene for scene in scenes if scene.check and not scene.on_request]


def check_all(scenes: Sequence[Scene], progress: Progress | None = None) -> list[Checked]:
    """Check many scenes in as many processes as there are cores, results in the scenes' order.

    A run that cannot be completed becomes a row that does not hold, so that the others are seen.

    Args:
        progress: called with a scene's index and its finished fraction.

    Raises:
        UserError: a scene or an FMU is wrong.
    """
    for scene in scenes:
        _refuse_unchecked(scene)
    cores = os.cpu_count() or 1
    workers = min(len(scenes), cores)
    if workers < 2:
        return [check_one(scene, _for_index(progress, i), cores) for i, scene in enumerate(scenes)]
    context = get_context("spawn")  # threads of numerical libraries do not survive a fork
    reports: Any = context.Queue()
    with ProcessPoolExecutor(workers, context, _adopt, (reports,)) as pool:
        futures = [pool.submit(_work, i, scene) for i, scene in enumerate(scenes)]
        try:
            _follow(futures, reports, progress)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return [future.result() for future in futures]


def check_one(
    scene: Scene, progress: Callable[[float], None] | None = None, workers: int = 1
) -> Checked:
    """Check one scene, its checks in `workers` processes.

    A run that cannot be completed becomes a row that does not hold.
    """
    from .registry import run_checks

    units, left_out = _facts(scene)
    begun = time.perf_counter()
    try:
        rows = run_checks(scene, progress, workers)
    except SimulationError as error:
        kinds = ", ".join(dict.fromkeys(c.kind for c in scene.check))
        seconds = time.perf_counter() - begun
        rows = [
            Row(scene.name, kinds, "run", "completed", str(error), None, None, False, seconds, "")
        ]
    return Checked(scene.name, scene.title, tuple(rows), units, left_out)


def _facts(scene: Scene) -> tuple[tuple[str, ...], tuple[str, ...]]:
    from ..master.cosimulation import CoSimulation
    from ..master.facts import left_out

    with CoSimulation(scene) as units:
        try:
            units.start()
        except SimulationError:
            return tuple(p.name for p in dict.fromkeys(units.paths)), ()
        names = tuple(path.name for path in dict.fromkeys(units.paths))
        return names, tuple(left_out(units.facts(), ["all"]))


def _refuse_unchecked(scene: Scene) -> None:
    if not scene.check:
        raise SceneError(
            f"{scene.path or scene.name}: nothing to check: add a [[check]] table, for example "
            'kind = "liquid_window"'
        )


def _for_index(progress: Progress | None, index: int) -> Callable[[float], None] | None:
    return None if progress is None else lambda fraction: progress(index, fraction)


_reports: Any = None  # the worker's way to tell its progress


def _adopt(reports: Any) -> None:
    global _reports
    _reports = reports


def _work(index: int, scene: Scene) -> Checked:
    return check_one(scene, lambda fraction: _reports.put((index, fraction)))


def _follow(futures: Sequence[Future[Checked]], reports: Any, progress: Progress | None) -> None:
    """Pass progress on until all are done; the first error ends the wait."""
    pending = set(futures)
    while pending:
        done, pending = wait(pending, timeout=_POLL)
        while True:
            try:
                index, fraction = reports.get_nowait()
            except queue.Empty:
                break
            if progress:
                progress(index, fraction)
        for future in done:
            future.result()
