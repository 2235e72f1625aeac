"""Checks of a scene against theory: each compares what the coupled units did with a closed form."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from ..parallel import spread
from ..report import Row
from ..scene import Scene
from ..scene_check import AnyCheck, CriticalSpeedsCheck, LiquidWindowCheck, TableCheck

Progress = Callable[[float], None]


def run_checks(scene: Scene, progress: Progress | None = None, workers: int = 1) -> list[Row]:
    """Every [[check]] of a scene, in order.

    Args:
        progress: called with the finished fraction.
        workers: processes that share the work.

    Raises:
        UserError: a check does not fit the scene.
        SimulationError: a run cannot be completed correctly.
    """
    if workers > 1 and len(scene.check) > workers:
        jobs = [(scene, check) for check in scene.check]
        return [row for rows in spread(_alone, jobs, workers, progress) for row in rows]
    rows: list[Row] = []
    for number, check in enumerate(scene.check):

        def report(fraction: float, done: int = number) -> None:
            if progress:
                progress((done + fraction) / len(scene.check))

        rows += _rows(scene, check, report, workers)
    return rows


def _alone(job: tuple[Scene, AnyCheck]) -> list[Row]:
    return list(_rows(*job, lambda fraction: None, 1))


def _rows(scene: Scene, check: AnyCheck, progress: Progress, workers: int) -> Iterator[Row]:
    if isinstance(check, LiquidWindowCheck):
        from .liquid_window import check_liquid_window

        return check_liquid_window(scene, check, progress)
    if isinstance(check, CriticalSpeedsCheck):
        from .critical_speeds import check_critical_speeds

        return check_critical_speeds(scene, check, progress)
    if isinstance(check, TableCheck):
        from .filimonikhina import check_table

        return check_table(scene, check, progress, workers)
    raise NotImplementedError(f"no check for {check!r}")
