"""Stiff and extreme cases, each in a right answer or a clear refusal; in parallel processes."""

from __future__ import annotations

import os
import time
import warnings
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from multiprocessing import get_context
from typing import TYPE_CHECKING, Any

from .case import Outcome
from .cases import all_cases

if TYPE_CHECKING:
    from rich.table import Table

Progress = Callable[[int, int, str], None]


@dataclass(frozen=True)
class StressRow:
    """One case: what was expected, what came of it in words, whether it holds, how long it took."""

    case: str
    expected: str
    outcome: str
    holds: bool
    seconds: float


def run_case(name: str) -> StressRow:
    """Run one case; an error that nobody foresaw is an outcome that does not hold."""
    case = all_cases()[name]
    begun = time.perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)  # an overflow must not pass in silence
        try:
            outcome = case.run()
        except Exception as error:
            outcome = Outcome(f"{type(error).__name__}: {error}", False)
    seconds = time.perf_counter() - begun
    # a NaN fails every comparison; said once more for outcomes that compare nothing
    holds = bool(outcome.holds) and "nan" not in outcome.text.lower().split()
    return StressRow(case.name, case.expected, outcome.text, holds, seconds)


def stress(names: Sequence[str] | None = None, progress: Progress | None = None) -> list[StressRow]:
    """Run cases in as many processes as there are cores; rows in the cases' order.

    Args:
        names: of `stress.cases.all_cases`; by default all.
        progress: called with how many are done, how many there are, and the one just done.
    """
    names = list(all_cases() if names is None else names)
    workers = min(len(names), os.cpu_count() or 1)
    if workers < 2:
        return [run_case(name) for name in names]
    rows: dict[str, StressRow] = {}
    context = get_context("spawn")  # threads of numerical libraries do not survive a fork
    with ProcessPoolExecutor(workers, context) as pool:
        try:
            for future in as_completed([pool.submit(run_case, name) for name in names]):
                row = future.result()
                rows[row.case] = row
                if progress:
                    progress(len(rows), len(names), row.case)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return [rows[name] for name in names]


def as_json(rows: Sequence[StressRow]) -> dict[str, Any]:
    """`{"rows": [{"case", "expected", "outcome", "holds", "seconds"}]}`."""
    return {"rows": [asdict(row) for row in rows]}


def table(rows: Sequence[StressRow]) -> Table:
    """The rows for the terminal."""
    from rich.markup import escape
    from rich.table import Table

    grid = Table(title="Stiff and extreme cases", title_justify="left")
    for column in ("case", "expected", "outcome", "s", "holds"):
        grid.add_column(column, justify="right" if column == "s" else "left", overflow="fold")
    for row in rows:
        verdict = "[green]yes[/green]" if row.holds else "[bold red]NO[/bold red]"
        texts = map(escape, (row.case, row.expected, row.outcome))
        grid.add_row(*texts, f"{row.seconds:.1f}", verdict)
    return grid


def markdown(rows: Sequence[StressRow]) -> str:
    """The rows as a Markdown table."""
    lines = ["| case | expected | outcome | s |", "|---|---|---|---|"]
    for row in rows:
        verdict = row.outcome if row.holds else f"**does not hold:** {row.outcome}"
        lines.append(f"| {row.case} | {row.expected} | {verdict} | {row.seconds:.1f} |")
    return "\n".join(lines) + "\n"
