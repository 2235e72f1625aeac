"""What studies of drawn values have in common: machines of a scene, or systems of units."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import SimulationError
from ..output.outcome import Outcome
from ..output.store import StoredItems
from ..output.table import Sheet
from ..output.words import kinds_of
from ..output.workers import Progress, Workers, in_order
from .vary import Variation

QUANTILES = (0.05, 0.5, 0.95, 0.99)
Vector = NDArray[np.float64]
Columns = tuple[NDArray[np.float64], NDArray[np.object_]]  # (m, numbers), failure


@dataclass(frozen=True, eq=False, repr=False)
class Drawn(Outcome):
    """n machines whose values were drawn, and why some could not be run.

    Attributes:
        title: of the scene or the system.
        variations, seed: what they were drawn from.
        values: (n, variations) of every machine.
        failure: (n,) why a run failed; else empty.
    """

    title: str
    variations: tuple[Variation, ...]
    seed: int
    values: Vector
    failure: NDArray[np.object_]

    @cached_property
    def ran(self) -> NDArray[np.bool_]:
        """(n,) which runs did not fail."""
        return np.asarray(self.failure == "")

    def about(self) -> dict[str, Any]:
        """What was drawn, and what failed, for JSON."""
        failed = self.failure[~self.ran]
        return {
            "scene": self.title,
            "machines": len(self.values),
            "seed": self.seed,
            "vary": [one.text for one in self.variations],
            "failed": len(failed),
            "reasons": [{"machines": count, "such_as": text} for count, text in kinds_of(failed)],
        }

    def quantiles(self, outcome: Vector) -> dict[str, float]:
        """Of an outcome (n,) of those that ran."""
        return {f"{q:g}": float(np.quantile(outcome[self.ran], q)) for q in QUANTILES}

    def importance(self, outcome: Vector) -> list[dict[str, Any]]:
        """Spearman's rank correlation of each value with an outcome (n,), the largest first.

        Machines that failed are left out.  Nothing where all are alike.
        """
        from scipy.stats import spearmanr

        values, outcome = self.values[self.ran], outcome[self.ran]
        if len(outcome) < 3 or np.ptp(outcome) == 0.0:
            return []
        rows = [
            {"path": one.path, "rank_correlation": float(spearmanr(column, outcome).statistic)}
            for one, column in zip(self.variations, values.T, strict=True)
        ]
        return sorted(rows, key=lambda row: -abs(row["rank_correlation"]))

    def _sheet(self, columns: Mapping[str, Vector]) -> Sheet:
        """One line a machine: its values, columns (n,), and why it failed."""
        heads = [*(one.path for one in self.variations), *columns, "failure"]
        numbers = np.column_stack([self.values, *columns.values()]).tolist()
        rows = [
            ["" if np.isnan(number) else number for number in row] + [failure]
            for row, failure in zip(numbers, self.failure, strict=True)
        ]
        return Sheet(heads, rows, title=self.title)


def run_drawn(
    function: Callable[[Any], Columns],
    common: Sequence[Any],
    values: Vector,
    chunk: int,
    workers: Workers,
    progress: Progress | None,
    kept: StoredItems | None = None,
) -> Columns:
    """Outcomes of all machines, `chunk` of them at a time.

    Args:
        function: of a job (*common, values of some).

    Raises:
        SimulationError: none could be run.
    """
    jobs = [(*common, values[i : i + chunk]) for i in range(0, len(values), chunk)]
    parts = in_order(function, jobs, workers, progress, kept)
    numbers, failure = map(np.concatenate, zip(*parts, strict=True))
    if (failure != "").all():
        raise SimulationError(str(failure[0]))
    return numbers, failure
