"""Stiff and extreme cases, each in a right answer or a clear refusal; in parallel processes."""

from __future__ import annotations

import os
import time
import warnings
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass

from ...output.table import BAD, GOOD, Sheet
from ...output.workers import ItemProgress, Workers, as_they_come
from . import cases_angles, cases_dry, cases_rotor, cases_shafts, cases_weights
from .case import Case, Outcome

COLUMNS = ("case", "expected", "outcome", "s")


@dataclass(frozen=True)
class StressRow:
    """One case: what was expected, what came of it in words, whether it holds, how long it took."""

    case: str
    expected: str
    outcome: str
    holds: bool
    seconds: float


def all_cases() -> dict[str, Case]:
    """Every case in order, by name."""
    parts = (cases_rotor, cases_weights, cases_dry, cases_shafts, cases_angles)
    return {case.name: case for part in parts for case in part.cases()}


def run_case(name: str) -> StressRow:
    """Run one case; an error that nobody foresaw is an outcome that does not hold."""
    case = all_cases()[name]
    start_time = time.perf_counter()
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)  # an overflow must not pass in silence
        try:
            outcome = case.run()
        except Exception as error:
            outcome = Outcome(f"{type(error).__name__}: {error}", False)
    seconds = time.perf_counter() - start_time
    # a NaN fails every comparison; said once more for outcomes that compare nothing
    holds = bool(outcome.holds) and "nan" not in outcome.text.lower().split()
    return StressRow(case.name, case.expected, outcome.text, holds, seconds)


def stress(
    names: Sequence[str] | None = None,
    progress: ItemProgress | None = None,
    workers: Workers | None = None,
) -> list[StressRow]:
    """Run cases; rows in the cases' order.

    Args:
        names: of `all_cases`; by default all.
        progress: called with the case just done, and the finished fraction.
        workers: processes, by default as many as there are cores, or an executor.
    """
    names = list(all_cases() if names is None else names)
    rows: dict[int, StressRow] = {}
    with closing(as_they_come(run_case, names, workers or os.cpu_count() or 1)) as ready:
        for index, row in ready:
            assert isinstance(row, StressRow)
            rows[index] = row
            if progress:
                progress(row.case, len(rows) / len(names))
    return [rows[index] for index in range(len(names))]


def table(rows: Sequence[StressRow]) -> Sheet:
    """The rows for the terminal."""
    cells = [
        (r.case, r.expected, r.outcome, f"{r.seconds:.1f}", "yes" if r.holds else "NO")
        for r in rows
    ]
    colours = {"holds": {"yes": GOOD, "NO": BAD}}
    return Sheet((*COLUMNS, "holds"), cells, "lllrl", "Stiff and extreme cases", colours)


def markdown(rows: Sequence[StressRow]) -> str:
    """The rows as a Markdown table."""
    cells = []
    for row in rows:
        verdict = row.outcome if row.holds else f"**does not hold:** {row.outcome}"
        cells.append((row.case, row.expected, verdict, f"{row.seconds:.1f}"))
    return Sheet(COLUMNS, cells).markdown() + "\n"
