"""The kinds of checks, and their rows: each compares what the coupled units did with a theory."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from ..errors import SceneError
from ..output.workers import Failed, Kinds, Progress, Workers, as_they_come, processes
from ..scene import Scene
from ..scene.check import AnyCheck
from .capacity import check_capacity, check_sizes
from .contact_order import CASES, check_contact_order
from .critical_speeds import check_critical_speeds
from .filimonikhina import TABLES, check_row
from .largest_spread import check_largest_spread
from .liquid_window import check_liquid_window
from .ranking import check_ranking
from .rig import GROUPS, check_rig
from .row import Row, Rows
from .runtimes import check_runtimes
from .slow_root import check_slow_root
from .sommerfeld import check_sommerfeld

# (scene, check, progress) -> rows
CHECKS: dict[str, Callable[..., Iterator[Row]]] = {
    "liquid_window": check_liquid_window,
    "critical_speeds": check_critical_speeds,
    "capacity": check_capacity,
    "runtimes": check_runtimes,
    "sommerfeld": check_sommerfeld,
}
# (scene, progress) -> rows, of one source; with `SPLIT` also the options of one of their parts
PAPERS: dict[str, Callable[..., Iterator[Row]]] = {
    "filimonikhina_table": check_row,
    "goncharov_table": check_sizes,
    "contact_order": check_contact_order,
    "rig": check_rig,
}
# (scene, progress, workers) -> rows, of one source: they share their runs among the workers
SHARING: dict[str, Callable[..., Iterator[Row]]] = {
    "goncharov_ranking": check_ranking,
    "slow_root": check_slow_root,
    "largest_spread": check_largest_spread,
}
# compare runs with runs; the theory of the others knows no gravity
UNDER_GRAVITY = ("contact_order", "runtimes")
# options of every part that can be done on its own
SPLIT: dict[str, list[dict[str, Any]]] = {
    "filimonikhina_table": [{"index": index} for index in range(len(TABLES))],
    "contact_order": [{"index": index} for index in range(len(CASES))],
    "rig": [{"rows_of": name} for name in GROUPS],
}


@dataclass(frozen=True)
class CheckPart:
    """Of a scene's checks, as much as is done in one piece."""

    scene: Scene
    check: AnyCheck
    options: Mapping[str, Any] = field(default_factory=dict)

    @property
    def sharing(self) -> bool:
        """Whether it divides its work itself."""
        return self.check.kind in SHARING

    def rows(self, progress: Progress, workers: Workers = 1) -> list[Row]:
        """Run the part, and give its rows."""
        kind = self.check.kind
        if self.sharing:
            return list(SHARING[kind](self.scene, progress, workers))
        if kind in PAPERS:
            return list(PAPERS[kind](self.scene, progress, **self.options))
        return list(CHECKS[kind](self.scene, self.check, progress))


def parts_of(scene: Scene) -> list[CheckPart]:
    """Everything that a scene asks to be checked, in order.

    Raises:
        SceneError: gravity acts, and a check knows of none.
    """
    for number, check in enumerate(scene.checks, start=1):
        if scene.operation.gravity and check.kind not in UNDER_GRAVITY:
            raise SceneError(
                f'{scene.name}: check[{number}].kind = "{check.kind}": its theory knows no '
                "gravity: take operation.gravity out"
            )
    return [
        CheckPart(scene, check, options)
        for check in scene.checks
        for options in SPLIT.get(check.kind, [{}])
    ]


def run_checks(scene: Scene, progress: Progress | None = None) -> list[Row]:
    """Every [[check]] of a scene, in order.

    Args:
        progress: called with the finished fraction.

    Raises:
        UserError: a check does not fit the scene.
        SimulationError: a run cannot be completed correctly.
    """

    def report(_index: int, done: list[float]) -> None:
        if progress:
            progress(sum(done) / len(done))

    return [row for rows in run_parts(parts_of(scene), 1, report) for row in rows]


def run_parts(
    parts: Sequence[CheckPart],
    workers: Workers,
    progress: Callable[[int, list[float]], None],
    isolate: Kinds = (),
) -> list[list[Row]]:
    """Rows of every part, in order.

    Args:
        progress: called with the index of a part that moved on, and the finished fractions of all.
        isolate: exceptions that cost their part alone, whose one row says why.
    """
    alone = [index for index, part in enumerate(parts) if not part.sharing]
    sharing = [index for index, part in enumerate(parts) if part.sharing]
    done = [0.0] * len(parts)
    outcomes: dict[int, list[Row] | Failed[Any]] = {}

    def report(index: int, fraction: float) -> None:
        done[index] = fraction
        progress(index, done)

    with ExitStack() as stack:
        if isinstance(workers, int):
            workers = workers if sharing else min(workers, len(alone))
            if workers > 1:
                workers = stack.enter_context(processes(workers))
        # across processes progress is told by every part, within this one also on the way
        items = [(parts[i], partial(report, i) if workers == 1 else None) for i in alone]
        ready = stack.enter_context(closing(as_they_come(_rows_of, items, workers, isolate)))
        for place, outcome in ready:
            report(alone[place], 1.0)
            outcomes[alone[place]] = outcome
        for i in sharing:
            share = partial(_rows_of, workers=workers)
            ((_, shared),) = as_they_come(share, [(parts[i], partial(report, i))], 1, isolate)
            outcomes[i] = shared
    return [
        _lost(part, found) if isinstance(found, Failed) else found
        for part, (_, found) in zip(parts, sorted(outcomes.items()), strict=True)
    ]


def _rows_of(item: tuple[CheckPart, Progress | None], workers: Workers = 1) -> list[Row]:
    part, progress = item
    return part.rows(progress or (lambda _fraction: None), workers)


def _lost(part: CheckPart, failed: Failed[Any]) -> list[Row]:
    rows = Rows(part.scene.name, part.check.kind)
    return [rows.statement("run", "completed", str(failed.error), False, "")]
