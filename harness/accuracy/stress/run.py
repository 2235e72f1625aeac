"""Stiff and extreme cases, each in a right answer or a clear refusal; in parallel processes."""

from __future__ import annotations

import os
import time
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

from ...output.table import BAD, GOOD, Sheet
from ...output.workers import Progress, Workers, in_order
from ...scene.plausible import ImplausibleWarning
from . import cases_angles, cases_dry, cases_rotor, cases_shafts, cases_weights
from .case import Case, Outcome

COLUMNS = ("case", "expected", "outcome", "s", "holds")


@dataclass(frozen=True)
class StressRow:
    """One case: what was expected, what came of it in words, whether it holds, how long it took."""

    case: str
    expected: str
    outcome: str
    holds: bool
    seconds: float


@cache
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
        warnings.simplefilter("ignore", ImplausibleWarning)
        try:
            outcome = case.run()
        except Exception as error:
            outcome = Outcome(f"{type(error).__name__}: {error}", False)
    seconds = time.perf_counter() - start_time
    # a NaN fails every comparison; said once more for outcomes that compare nothing
    holds = bool(outcome.holds) and "nan" not in outcome.text.lower().split()
    return StressRow(case.name, case.expected, outcome.text, holds, seconds)


def stress(
    names: Sequence[str], progress: Progress | None = None, workers: Workers | None = None
) -> list[StressRow]:
    """Run cases; rows in the order of the names, which are of `all_cases`.

    Args:
        progress: called with the finished fraction.
        workers: processes, by default as many as there are cores, or an executor.
    """
    return in_order(run_case, names, workers or os.cpu_count() or 1, progress)


def table(rows: Sequence[StressRow]) -> Sheet:
    """The rows."""
    cells = [
        (r.case, r.expected, r.outcome, f"{r.seconds:.1f}", "yes" if r.holds else "NO")
        for r in rows
    ]
    colours = {"holds": {"yes": GOOD, "NO": BAD}}
    return Sheet(COLUMNS, cells, "lllrl", "Stiff and extreme cases", colours)
