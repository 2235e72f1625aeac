"""Systems of units whose start values scatter: each is run, and its signals are compared."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from ..errors import SceneError, SimulationError, UserError
from ..master.unit_run import UnitRun
from ..output.table import Sheet
from ..output.workers import Progress, Workers
from ..result.system import run_system
from ..scene.system import System
from .drawn import QUANTILES, Columns, Drawn, Vector, run_drawn
from .vary import EXAMPLE, Variation, drawn, frozen

CHUNK = 4  # systems worked on together: some seconds at most


@dataclass(frozen=True, eq=False, repr=False)
class SystemScatter(Drawn):
    """Systems with drawn start values, and what came of each.

    Attributes:
        signals: (s,) names; `signal_units` what they are measured in.
        largest: (n, s) largest magnitude of each signal; NaN where the run failed.
        end: (n, s) value of each signal at the end.
    """

    drawn_by: ClassVar[str] = "..scatter.plot_system:plot_scatter"
    document_by: ClassVar[str] = "..scatter.systems:document"

    signals: tuple[str, ...]
    signal_units: dict[str, str]
    largest: Vector
    end: Vector

    def table(self) -> Sheet:
        """One line a system."""
        return self._sheet(
            {
                _head(name, what, self.signal_units[name]): outcome[:, k]
                for what, outcome in (("largest", self.largest), ("at the end", self.end))
                for k, name in enumerate(self.signals)
            }
        )


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
    try:
        common = (system, paths, names)
        numbers, failure = run_drawn(_outcomes, common, values, CHUNK, workers, progress)
    except SimulationError as error:
        raise SimulationError(f"{system.label}: no system could be run: {error}") from error
    return SystemScatter(
        title=system.heading,
        variations=tuple(variations),
        seed=seed,
        values=values,
        failure=failure,
        signals=tuple(names),
        signal_units=units,
        largest=numbers[:, : len(names)],
        end=numbers[:, len(names) :],
    )


def _variations(vary: Mapping[str, Any] | Iterable[str]) -> list[Variation]:
    """What varies, see `vary.variations`; a path is the FMU's own name, and means what it says."""
    if not isinstance(vary, Mapping):
        found = [Variation.parse(text) for text in vary]
        return [replace(one, path=one.text.partition("=")[0].strip()) for one in found]
    texts = {path: f"{path}={one}" for path, one in vary.items() if isinstance(one, str)}
    return [
        replace(Variation.parse(texts[path]) if path in texts else frozen(path, one), path=path)
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
) -> Columns:
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
    return found.about() | {
        "signals": {
            name: {
                "unit": found.signal_units[name],
                "largest": found.quantiles(found.largest[:, k]),
                "end": found.quantiles(found.end[:, k]),
                "importance": found.importance(found.largest[:, k]),
                "importance_of_end": found.importance(found.end[:, k]),
            }
            for k, name in enumerate(found.signals)
        },
    }


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
