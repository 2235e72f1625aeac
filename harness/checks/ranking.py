"""Which number of weights settles first: Goncharov's criterion against co-simulated runs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ...models.constants import DEFAULT_TOLERANCE
from ...models.papers.capacity import fastest_count
from ..design.choices import Design, design
from ..design.recommendation import by_measure, by_median, contradicted, order, rivals
from ..design.scenes import batches
from ..scene import Scene
from .goncharov import settled_runs, weights_with_slow_root
from .row import Row, Rows
from .slow_root import MOST, WIDTH, decay_rows

FINER = 0.01  # of a tolerance: of runs to compare with
REPEATED = 0.02  # of the settling time: errors of steps, and times that are read 8 times a turn
SOURCE = "Goncharov 2017, 5.4.3, Fig. 7"


def check_ranking(
    scene: Scene, most: int = MOST, starts: int = 200, repeated: int = 4
) -> Iterator[Row]:
    """The fastest number, the order, decay rates, and what the tolerance leaves.

    Args:
        most: weights, from 2 on.
        starts: random ones for every number of weights.
        repeated: starts of every number that are repeated with a finer tolerance.
    """
    rows = Rows(scene.name, "goncharov_ranking")
    data = design(
        scene,
        width=WIDTH[weights_with_slow_root(scene).kind],
        counts=range(2, most + 1),
        starts=starts,
    )
    yield from _order(data, rows)
    found = data.decays
    if any(one.dominant for one in found):
        yield from decay_rows(found, rows)
    yield _repeated(repeated, data, rows)


def _order(data: Design, rows: Rows) -> Iterator[Row]:
    if not data.with_capacity:
        quantity = f"{data.kind}: numbers that can balance {data.unbalance:g} kg m"
        yield rows.statement(quantity, "some", "none", False, SOURCE)
        return
    claimed = fastest_count(data.kind, [c.count for c in data.with_capacity])
    first = {c.count: f"{c.median:.3g} s ({c.low:.3g}-{c.high:.3g})" for c in rivals(data)}
    yield rows.statement(
        f"{data.kind}: first to settle, median and 95 % interval",
        str(claimed),
        ", ".join(f"{count}: {times}" for count, times in first.items()),
        claimed in first,
        f"{SOURCE}; intervals that reach the fastest are named",
    )
    pairs = contradicted(data)
    yield rows.statement(
        f"{data.kind}: order of the medians",
        order(by_measure(data)),
        order(by_median(data)) + (f" ({pairs})" if pairs else ""),
        not pairs,
        f"{SOURCE}: (1-p) m n at the largest p; fails where intervals that part contradict it",
    )


def _repeated(count: int, data: Design, rows: Rows) -> Row:
    """Settling times of the first starts with a finer tolerance against those of the study."""
    coarse, work = [], []
    for choice in data.with_capacity:
        tolerance = FINER * (choice.scene.coupling.tolerance or DEFAULT_TOLERANCE)
        fine = choice.scene.replace({"coupling.tolerance": tolerance})
        for batch in batches(fine, data.unbalance, count):
            work += [replace(batch, starts=(start,)) for start in batch.starts]
        coarse += [run.seconds for run in choice.runs[:count]]
    again = [run.seconds for run in settled_runs(work)]
    times = np.array([coarse, again])
    settled = np.isfinite(times)
    both, lost = settled.all(axis=0), int((settled[0] != settled[1]).sum())
    if lost or not both.any():
        words = f"{lost} starts settle with one of the tolerances alone, {both.sum()} with both"
        quantity = "settling with a hundredth of the tolerance"
        return rows.statement(quantity, "alike", words, False, "the same starts")
    measured, expected = times[:, both]
    finer = "settling time and that with a hundredth of the tolerance"
    quantity = f"{finer}, worst of {both.sum()} starts [s]"
    return rows.number(quantity, expected, measured, REPEATED, "the same starts, co-simulated")
