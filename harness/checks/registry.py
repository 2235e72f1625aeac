"""The kinds of checks, and their rows: each compares what the coupled units did with a theory."""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass, field
from typing import Any

from ..output.workers import Failed, Kinds, Progress, Workers, as_they_come, processes
from ..scene import Scene
from ..scene.check import AnyCheck
from .capacity import check_capacity, check_sizes
from .contact_order import check_contact_order
from .critical_speeds import check_critical_speeds
from .filimonikhina import check_row, table_rows
from .largest_spread import check_largest_spread
from .liquid_window import check_liquid_window
from .measured_error import check_measured_error
from .ranking import check_ranking
from .row import Row
from .runtimes import check_runtimes
from .slow_root import check_slow_root

# (scene, check, progress) -> rows; with `SPLIT` also the options of one of its parts
CHECKS: dict[str, Callable[..., Iterator[Row]]] = {
    "liquid_window": check_liquid_window,
    "critical_speeds": check_critical_speeds,
    "filimonikhina_table": check_row,
    "capacity": check_capacity,
    "goncharov_table": check_sizes,
    "contact_order": check_contact_order,
    "runtimes": check_runtimes,
    "measured_error": check_measured_error,
}
# (scene, check, progress, workers) -> rows: they share their runs among the workers themselves
SHARING: dict[str, Callable[..., Iterator[Row]]] = {
    "goncharov_ranking": check_ranking,
    "slow_root": check_slow_root,
    "largest_spread": check_largest_spread,
}
# check -> options of every part that can be done on its own
SPLIT: dict[str, Callable[[Any], list[dict[str, Any]]]] = {"filimonikhina_table": table_rows}


@dataclass(frozen=True)
class Part:
    """Of a scene's checks, as much as is done in one piece."""

    scene: Scene
    check: AnyCheck
    options: Mapping[str, Any] = field(default_factory=dict)

    @property
    def sharing(self) -> bool:
        """Whether it divides its work itself."""
        return self.check.kind in SHARING

    def rows(self, progress: Progress, workers: Workers = 1) -> list[Row]:
        """Do it."""
        kind = self.check.kind
        if self.sharing:
            return list(SHARING[kind](self.scene, self.check, progress, workers))
        return list(CHECKS[kind](self.scene, self.check, progress, **self.options))


def parts_of(scene: Scene) -> list[Part]:
    """Everything that a scene asks to be checked, in order."""
    return [
        Part(scene, check, options)
        for check in scene.check
        for options in SPLIT.get(check.kind, lambda _check: [{}])(check)
    ]


def run_checks(scene: Scene, progress: Progress | None = None, workers: Workers = 1) -> list[Row]:
    """Every [[check]] of a scene, in order.

    Args:
        progress: called with the finished fraction.
        workers: processes that share the work, or an executor.

    Raises:
        UserError: a check does not fit the scene.
        SimulationError: a run cannot be completed correctly.
    """
    parts = parts_of(scene)
    done = [0.0] * len(parts)
    outcomes: dict[int, list[Row]] = {}

    def report(index: int, fraction: float) -> None:
        done[index] = fraction
        if progress:
            progress(sum(done) / len(parts))

    with closing(run_parts(parts, workers, report)) as ready:
        for index, rows in ready:
            assert not isinstance(rows, Failed)
            outcomes[index] = rows
    return [row for index in range(len(parts)) for row in outcomes[index]]


def run_parts(
    parts: Sequence[Part],
    workers: Workers,
    progress: Callable[[int, float], None],
    isolate: Kinds = (),
) -> Generator[tuple[int, list[Row] | Failed], None, None]:
    """Index and rows of every part, whichever is ready first; to be closed (`closing`).

    Args:
        progress: called with a part's index and its finished fraction.
        isolate: exceptions that cost their part alone.
    """
    alone = [index for index, part in enumerate(parts) if not part.sharing]
    sharing = [index for index, part in enumerate(parts) if part.sharing]
    with ExitStack() as stack:
        if isinstance(workers, int):
            workers = workers if sharing else min(workers, len(alone))
            if workers > 1:
                workers = stack.enter_context(processes(workers))
        # across processes progress is told by every part, within this one also on the way
        items = [(parts[i], i, progress if workers == 1 else None) for i in alone]
        ready = stack.enter_context(closing(as_they_come(_rows_of, items, workers, isolate)))
        for place, outcome in ready:
            index = alone[place]
            progress(index, 1.0)
            yield index, outcome
        for index in sharing:

            def share(part: Part, index: int = index) -> list[Row]:
                return part.rows(lambda fraction: progress(index, fraction), workers)

            for _, shared in as_they_come(share, [parts[index]], 1, isolate):
                yield index, shared


def _rows_of(item: tuple[Part, int, Callable[[int, float], None] | None]) -> list[Row]:
    part, index, progress = item
    return part.rows(lambda fraction: progress(index, fraction) if progress else None)


def cores() -> int:
    """As many processes as can run at once."""
    return os.cpu_count() or 1
