"""Many machines drawn from a scene's tolerances, each run by the coupling in C."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import ClassVar

import numpy as np
import tomli_w
from numpy.typing import NDArray

from ..errors import SceneError, SimulationError
from ..master.merged import merged, names_of_states
from ..master.one_file import composition
from ..master.schedule import end_time
from ..output.outcome import Outcome
from ..output.store import open_store
from ..output.table import Sheet
from ..output.workers import Progress, Workers, in_order
from ..result.alike import table_of
from ..result.many import cosimulate_many
from ..scene import Scene
from ..scene.grade import moments, residual_unbalance
from .vary import Variation, drawn, refuse_drawn, refuse_wrong

CHUNK = 50  # machines worked on together: some seconds at most
Vector = NDArray[np.float64]
# residual, grade, settled, merged, failure
Columns = tuple[Vector, Vector, Vector, Vector, NDArray[np.object_]]


@dataclass(frozen=True, eq=False, repr=False)
class Scatter(Outcome):
    """Machines of a scene, and what came of each.

    Attributes:
        title: of the scene.
        variations, seed: what the machines were drawn from.
        values: (n, variations) of every machine.
        residual: (n,) largest amplitude in the last revolution [m]; NaN where the run failed.
        grade: (n,) of ISO 21940-11 that the residual unbalance at the end just meets [mm/s]; NaN
            where the run failed or the scene's balancers do not tell their unbalance.
        settled: (n,) 1 where the last two revolutions are alike.
        merged: (n,) 1 where identical weights cannot part though they would, `master.merged`.
        failure: (n,) why a run failed; else empty.
        left_out: why there are no grades; else empty.
    """

    drawn_by: ClassVar[str] = "..scatter.plot:plot_scatter"
    document_by: ClassVar[str] = "..scatter.report:document"

    title: str
    variations: tuple[Variation, ...]
    seed: int
    values: Vector
    residual: Vector
    grade: Vector
    settled: Vector
    merged: Vector
    failure: NDArray[np.object_]
    left_out: str = ""

    @cached_property
    def ran(self) -> NDArray[np.bool_]:
        """(n,) which runs did not fail."""
        return np.asarray(self.failure == "")

    def table(self) -> Sheet:
        """One line a machine."""
        heads = [one.path for one in self.variations]
        outcomes = (self.residual, self.grade, self.settled, self.merged)
        numbers = np.column_stack([self.values, *outcomes])
        rows = [
            ["" if math.isnan(number) else number for number in row] + [failure]
            for row, failure in zip(numbers.tolist(), self.failure, strict=True)
        ]
        heads += ["residual amplitude [m]", "grade [mm/s]", "settled", "merged", "failure"]
        return Sheet(heads, rows, title=self.title)


def scatter(
    scene: Scene,
    variations: Sequence[Variation],
    count: int,
    *,
    seed: int = 1,
    workers: Workers = 1,
    progress: Progress | None = None,
    store: Path | None = None,
) -> Scatter:
    """Draw machines and run each; the same seed draws the same ones.

    Arguments are those of `Scene.scatter`, which says what is raised.
    """
    typical = refuse_wrong(scene, variations)
    composition(typical)
    values = drawn(variations, count, seed)
    refuse_drawn(typical, variations, values)
    paths = [one.path for one in variations]
    jobs = [(scene, paths, values[i : i + CHUNK]) for i in range(0, count, CHUNK)]
    made_for = {
        "content": "scatter",
        "scene": tomli_w.dumps(scene.document),
        "variations": "\n".join(one.text for one in variations),
        "seed": str(seed),
        "number of machines": str(count),
    }
    kept = None if store is None else open_store(store, made_for)
    parts = in_order(_machines, jobs, workers, progress, kept)
    residual, grade, settled, together, failure = map(np.concatenate, zip(*parts, strict=True))
    left_out = "" if moments(scene) is not None else "the unbalance of a liquid is not known"
    study = Scatter(
        scene.heading,
        tuple(variations),
        seed,
        values,
        residual,
        grade,
        settled,
        together,
        failure,
        left_out,
    )
    if not study.ran.any():
        raise SimulationError(f"{scene.name}: no machine could be run: {study.failure[0]}")
    return study


def _machines(job: tuple[Scene, list[str], Vector]) -> Columns:
    """Outcomes of some machines; one that cannot be costs itself alone."""
    scene, paths, values = job
    failure = np.full(len(values), "", dtype=object)
    machines: dict[int, Scene] = {}
    for k, row in enumerate(values.tolist()):
        try:
            machines[k] = scene.replace(dict(zip(paths, row, strict=True)))
        except SceneError as error:
            failure[k] = str(error)
    residual, grade, settled, together = np.full((4, len(values)), np.nan)
    if machines:
        asked, rows = moments(scene), list(machines)
        states = names_of_states(scene)
        results = ["residual", "settled", *(asked or ()), *states]
        scenes = list(machines.values())
        outcomes = cosimulate_many(scenes[0], table_of(scenes), results=results, threads=1)
        residual[rows], settled[rows], failure[rows] = (
            outcomes[name] for name in ("residual", "settled", "failure")
        )
        if asked is not None:
            grade[rows] = [
                residual_unbalance(
                    machine, {name: outcomes[name][place] for name in asked}, end_time(machine)
                )[1]
                for place, machine in enumerate(machines.values())
            ]
        for place, (row, machine) in enumerate(machines.items()):
            if not failure[row]:
                ends = {name: float(outcomes[name][place]) for name in states}
                together[row] = bool(merged(machine, ends))
    return residual, grade, settled, together, failure
