"""Systems of units whose start values scatter: each is run, and its signals are compared."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError, SimulationError, UserError
from ..master.unit_run import UnitRun
from ..output.outcome import Outcome
from ..output.table import Sheet
from ..output.words import kinds_of
from ..output.workers import Progress, Workers, in_order
from ..result.system import run_system
from ..scene.system import System
from .vary import EXAMPLE, Variation, drawn

CHUNK = 4  # systems worked on together: some seconds at most
QUANTILES = (0.05, 0.5, 0.95, 0.99)
Vector = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class SystemScatter(Outcome):
    """Systems with drawn start values, and what came of each.

    Attributes:
        title: of the system.
        variations, seed: what the systems were drawn from.
        values: (n, variations) of every system.
        signals: (s,) names; `signal_units` what they are measured in.
        largest: (n, s) largest magnitude of each signal; NaN where the run failed.
        end: (n, s) value of each signal at the end.
        failure: (n,) why a run failed; else empty.
    """

    drawn_by: ClassVar[str] = "..scatter.plot_system:plot_scatter"
    document_by: ClassVar[str] = "..scatter.systems:document"

    title: str
    variations: tuple[Variation, ...]
    seed: int
    values: Vector
    signals: tuple[str, ...]
    signal_units: dict[str, str]
    largest: Vector
    end: Vector
    failure: NDArray[np.object_]

    @cached_property
    def ran(self) -> NDArray[np.bool_]:
        """(n,) which runs did not fail."""
        return np.asarray(self.failure == "")

    def table(self) -> Sheet:
        """One line a system."""
        heads = [one.path for one in self.variations]
        for what in ("largest", "at the end"):
            heads += [_head(name, what, self.signal_units[name]) for name in self.signals]
        numbers = np.column_stack([self.values, self.largest, self.end]).tolist()
        rows = [
            ["" if np.isnan(number) else number for number in row] + [failure]
            for row, failure in zip(numbers, self.failure, strict=True)
        ]
        return Sheet([*heads, "failure"], rows, title=self.title)


def _head(name: str, what: str, unit: str) -> str:
    return f"{name} {what}" + (f" [{unit}]" if unit else "")


def scatter_system(
    system: System,
    vary: Mapping[str, Any] | Iterable[str],
    count: int,
    *,
    seed: int = 1,
    workers: Workers = 1,
    progress: Progress | None = None,
) -> SystemScatter:
    """Draw systems and run each; the same seed draws the same ones.

    Arguments are those of `System.scatter`, which says what is raised.
    """
    variations = _variations(vary)
    typical = _typical(system, variations)
    with UnitRun(typical) as run:  # refuses what the FMUs do not have
        names = run.recorded()
        units = {n: run.units[n.partition(".")[0]].measured_in[n.partition(".")[2]] for n in names}
    values = drawn(variations, count, seed)
    paths = [one.path for one in variations]
    jobs = [(system, paths, names, values[i : i + CHUNK]) for i in range(0, count, CHUNK)]
    parts = in_order(_outcomes, jobs, workers, progress)
    numbers, failure = map(np.concatenate, zip(*parts, strict=True))
    found = SystemScatter(
        system.heading, tuple(variations), seed, values, tuple(names), units,
        numbers[:, : len(names)], numbers[:, len(names) :], failure,
    )  # fmt: skip
    if not found.ran.any():
        raise SimulationError(f"{system.label}: no system could be run: {failure[0]}")
    return found


def _variations(vary: Mapping[str, Any] | Iterable[str]) -> list[Variation]:
    """What varies, see `vary.variations`; a path is the FMU's own name, and means what it says."""
    if not isinstance(vary, Mapping):
        found = [Variation.parse(text) for text in vary]
        return [replace(one, path=one.text.partition("=")[0].strip()) for one in found]
    texts = {path: f"{path}={one}" for path, one in vary.items() if isinstance(one, str)}
    return [
        replace(Variation.parse(texts[path]), path=path)
        if path in texts
        else Variation(path, f"{path}={one.dist.name}{one.args or one.kwds}", one)
        for path, one in vary.items()
    ]


def _typical(system: System, variations: Sequence[Variation]) -> System:
    """The system with every value at its median.

    Raises:
        UserError: nothing varies, a path twice, or one that is no start value.
    """
    if not variations:
        raise UserError(f"--vary: nothing varies; give at least one {EXAMPLE}")
    units, paths = [unit.name for unit in system.unit], [one.path for one in variations]
    for path in paths:
        unit, _, variable = path.partition(".")
        if unit not in units or not variable or variable == "fmu":
            raise UserError(
                f"--vary {path}: must be UNIT.VARIABLE, a start value of one of: {', '.join(units)}"
            )
        if paths.count(path) > 1:
            raise UserError(f"--vary {path}: given {paths.count(path)} times")
    return system.replace({one.path: one.typical for one in variations})


def _outcomes(
    job: tuple[System, list[str], list[str], Vector],
) -> tuple[Vector, NDArray[np.object_]]:
    """Largest magnitudes and ends of signals; a system that fails costs itself alone."""
    system, paths, names, values = job
    numbers = np.full((len(values), 2 * len(names)), np.nan)
    failure = np.full(len(values), "", dtype=object)
    for k, row in enumerate(values.tolist()):
        try:
            result = run_system(system.replace(dict(zip(paths, row, strict=True))), record=names)
        except (SceneError, UserError, SimulationError) as error:
            failure[k] = str(error)
            continue
        signals = [result.signals[name] for name in names]
        numbers[k] = [*(np.abs(s).max() for s in signals), *(s[-1] for s in signals)]
    return numbers, failure


def document(found: SystemScatter) -> dict[str, Any]:
    """Everything that the command says."""
    failed = ~found.ran
    return {
        "scene": found.title,
        "machines": len(found.values),
        "seed": found.seed,
        "vary": [one.text for one in found.variations],
        "failed": int(failed.sum()),
        "reasons": [
            {"machines": count, "such_as": text} for count, text in kinds_of(found.failure[failed])
        ],
        "signals": {
            name: {
                "unit": found.signal_units[name],
                "largest": _quantiles(found.largest[found.ran, k]),
                "end": _quantiles(found.end[found.ran, k]),
                "importance": _importance(found, found.largest[found.ran, k]),
                "importance_of_end": _importance(found, found.end[found.ran, k]),
            }
            for k, name in enumerate(found.signals)
        },
    }


def _quantiles(values: Vector) -> dict[str, float]:
    return {f"{q:g}": float(np.quantile(values, q)) for q in QUANTILES}


def _importance(found: SystemScatter, outcome: Vector) -> list[dict[str, Any]]:
    """Spearman's rank correlation of each value with an outcome, the largest first."""
    from scipy.stats import spearmanr

    if len(outcome) < 3 or np.ptp(outcome) == 0.0:
        return []
    rows = [
        {"path": one.path, "rank_correlation": float(spearmanr(column, outcome).statistic)}
        for one, column in zip(found.variations, found.values[found.ran].T, strict=True)
    ]
    return sorted(rows, key=lambda row: -abs(row["rank_correlation"]))


def quantile_table(said: Mapping[str, Any]) -> Sheet:
    """A line a signal and outcome, with what matters most."""
    rows = []
    for name, one in said["signals"].items():
        for what, head, ranks in (
            ("largest", "largest", "importance"),
            ("end", "at the end", "importance_of_end"),
        ):
            first = one[ranks][:1]
            most = "".join(f"{f['path']} ({f['rank_correlation']:+.2f})" for f in first)
            numbers = [f"{value:.4g}" for value in one[what].values()]
            rows.append([_head(name, head, one["unit"]), *numbers, most])
    heads = [f"{100.0 * q:g} %" for q in QUANTILES]
    return Sheet(("signal", *heads, "most important (rank correlation)"), rows, "lrrrrl")


def lines(said: Mapping[str, Any]) -> list[str]:
    """What the table does not say."""
    found = [f"{said['machines']} systems, seed {said['seed']}: {said['failed']} failed"]
    return found + [f"{one['machines']} failed: {one['such_as']}" for one in said["reasons"]]
