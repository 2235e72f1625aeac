"""Many random scenes, counted by what came of them."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from typing import Any

from autobalancer.harness.output.table import Sheet
from autobalancer.harness.output.workers import Progress, Workers, in_order
from tests.studies.truth.judge import MISSES, OUTCOMES, SET_ASIDE, Verdict, judge


def verdicts(
    counts: Mapping[str, int],
    seed: int = 1,
    workers: Workers = 1,
    progress: Progress | None = None,
    first: int = 0,
    **options: Any,
) -> list[Verdict]:
    """Verdicts of all scenes, by family and number.

    Args:
        counts: how many scenes of each family.
        first: number of the first scene of each.
        seed: they are drawn with.
        options: of `judge`.
    """
    items = [(family, n) for family, count in counts.items() for n in range(first, first + count)]
    return in_order(partial(_judged, seed, options), items, workers, progress)


def _judged(seed: int, options: Mapping[str, Any], item: tuple[str, int]) -> Verdict:
    family, number = item
    return judge(family, seed, number, **options)


def table(found: Sequence[Verdict]) -> Sheet:
    """Per cent of each outcome by family; scenes set aside are not counted.

    Also how many err by at most `FACTOR` times their own estimate.
    """
    columns = [outcome for outcome in OUTCOMES if outcome not in SET_ASIDE]
    heads = ["family", "scenes", *columns, "set aside", "estimated rightly"]
    rows = []
    for name in [*dict.fromkeys(verdict.family for verdict in found), "all"]:
        mine = [v for v in found if name in (v.family, "all")]
        counted = [v for v in mine if v.outcome not in SET_ASIDE]
        outcomes = Counter(v.outcome for v in counted)
        shares = [_per_cent(outcomes[c], len(counted)) for c in columns]
        row = [name, str(len(counted)), *shares, str(len(mine) - len(counted))]
        estimated = [v.within for v in counted if v.within is not None]
        row.append(_per_cent(sum(estimated), len(estimated)))
        rows.append(row)
    return Sheet(heads, rows, "l" + "r" * (len(heads) - 1))


def _per_cent(part: int, whole: int) -> str:
    return f"{100.0 * part / whole:.1f}" if whole else "-"


def misses(found: Iterable[Verdict]) -> list[Verdict]:
    """Runs that were wrong without saying so rightly, worst first."""
    wrong = [v for v in found if v.outcome in MISSES]
    return sorted(wrong, key=lambda v: -(v.error if v.error is not None else math.inf))


def line(verdict: Verdict) -> str:
    """One miss in words."""
    if verdict.error is None:
        return f"{verdict.family} {verdict.number}: {verdict.outcome}: {verdict.words.strip()}"
    stated = f", states {verdict.stated:.2g}" if verdict.stated else ""
    return (
        f"{verdict.family} {verdict.number}: {verdict.outcome}: errs by {verdict.error:.2g} in "
        f"{verdict.where}{stated} ({verdict.steps} steps)"
    )
