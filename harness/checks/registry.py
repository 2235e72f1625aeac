"""Checks of a scene against theory: each compares what the coupled units did with a closed form."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from ..output.workers import spread
from ..scene import Scene
from ..scene.check import (
    AnyCheck,
    CapacityCheck,
    ContactOrderCheck,
    CriticalSpeedsCheck,
    LargestSpreadCheck,
    LiquidWindowCheck,
    RankingCheck,
    SizesCheck,
    SlowRootCheck,
    TableCheck,
)
from .row import Row

Progress = Callable[[float], None]
_SHARING = (
    RankingCheck,
    SlowRootCheck,
    LargestSpreadCheck,
)  # they share their runs among the processes themselves


def run_checks(scene: Scene, progress: Progress | None = None, workers: int = 1) -> list[Row]:
    """Every [[check]] of a scene, in order.

    Args:
        progress: called with the finished fraction.
        workers: processes that share the work.

    Raises:
        UserError: a check does not fit the scene.
        SimulationError: a run cannot be completed correctly.
    """
    parts = [(scene, check, row) for check in scene.check for row in _table_rows(check)]
    sharing = any(isinstance(check, _SHARING) for check in scene.check)
    if workers > 1 and len(parts) > 1 and not sharing:
        return [row for rows in spread(_alone, parts, workers, progress) for row in rows]
    rows: list[Row] = []
    for number, part in enumerate(parts):

        def report(fraction: float, done: int = number) -> None:
            if progress:
                progress((done + fraction) / len(parts))

        rows += _rows(*part, report, workers)
    return rows


def _table_rows(check: AnyCheck) -> Iterable[int]:
    """Rows of a table that are checked one by one; any other check is in one piece."""
    if isinstance(check, TableCheck):
        from ...models.papers.tables import TABLE_1, TABLE_2

        return range(len(TABLE_1 if check.table == 1 else TABLE_2))
    return (0,)


def _alone(part: tuple[Scene, AnyCheck, int]) -> list[Row]:
    return list(_rows(*part, lambda fraction: None))


def _rows(
    scene: Scene, check: AnyCheck, table_row: int, progress: Progress, workers: int = 1
) -> Iterator[Row]:
    if isinstance(check, LiquidWindowCheck):
        from .liquid_window import check_liquid_window

        return check_liquid_window(scene, check, progress)
    if isinstance(check, CriticalSpeedsCheck):
        from .critical_speeds import check_critical_speeds

        return check_critical_speeds(scene, check, progress)
    if isinstance(check, TableCheck):
        from .filimonikhina import check_row

        return check_row(scene, check.table, table_row, progress)
    if isinstance(check, CapacityCheck):
        from .capacity import check_capacity

        return check_capacity(scene, check, progress)
    if isinstance(check, SizesCheck):
        from .capacity import check_sizes

        return check_sizes(scene)
    if isinstance(check, RankingCheck):
        from .ranking import check_ranking

        return check_ranking(scene, check, progress, workers)
    if isinstance(check, SlowRootCheck):
        from .slow_root import check_slow_root

        return check_slow_root(scene, check, progress, workers)
    if isinstance(check, ContactOrderCheck):
        from .contact_order import check_contact_order

        return check_contact_order(scene, check, progress)
    if isinstance(check, LargestSpreadCheck):
        from .largest_spread import check_largest_spread

        return check_largest_spread(scene, check, progress, workers)
    raise NotImplementedError(f"no check for {check!r}")
