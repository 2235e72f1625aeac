"""What still vibrates after a scene's run, over two of its parameters: every point run in C."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ..master.one_file import composition
from ..output.table import Sheet
from ..output.words import kinds_of
from ..output.workers import Progress, Workers
from ..result.alike import refuse_unvaried, table_of
from ..result.many import cosimulate_many
from ..scene import Scene
from .axis import Axis, Map, refuse_axes
from .map_store import compute_points

_RESULTS = ("residual", "settled", "failure")
Rows = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class RunMap(Map):
    """Runs over two parameters.

    Attributes:
        residual: largest amplitude in the last revolution [m]; NaN where the run failed.
        settled: 1 where the last two revolutions are alike.
        failure: why a run failed; else empty.
    """

    drawn_by: ClassVar[str] = "..stability.plot:plot_run_map"

    residual: Rows
    settled: Rows
    failure: NDArray[np.object_]

    def lines(self) -> Iterator[str]:
        """What came of the runs, in words."""
        failed = self.failure[self.failure != ""]
        ran, steady = self.residual.size - failed.size, int(np.nansum(self.settled))
        yield (
            f"{self.residual.size} runs in C as one composite: {steady} with an amplitude that is "
            f"steady over the last two revolutions, {ran - steady} not, {failed.size} failed"
        )
        if ran:
            low, high = 1e3 * np.nanmin(self.residual), 1e3 * np.nanmax(self.residual)
            yield f"Residual amplitude: {low:.4g} to {high:.4g} mm"
        for count, reason in kinds_of(failed)[:3]:
            yield f"{count} failed, such as: {reason}"

    def table(self) -> Sheet:
        """One line a point of the grid."""
        columns = {"residual amplitude [m]": self.residual, "settled": self.settled}
        return self._sheet(columns, self.failure)


def run_map(
    scene: Scene,
    x: Axis,
    y: Axis,
    *,
    workers: Workers = 1,
    progress: Progress | None = None,
    store: Path | None = None,
) -> RunMap:
    """Run the scene at every point of a grid.

    Args:
        workers, progress, store: as `stability_map`.

    Raises:
        UserError: a path is unknown or cannot be varied, a value on an axis is wrong, both axes are
            the same, the scene cannot be run in C, or the store is another map's.
    """
    refuse_axes(x, y)
    scene.refuse_free("a map of runs")
    for axis in (x, y):
        refuse_unvaried(scene, axis.path)
    for ends in itertools.product((0, -1), repeat=2):  # what is wrong is so before the work
        at = {axis.path: axis.values[end] for axis, end in zip((x, y), ends, strict=True)}
        composition(scene.replace(at))
    jobs = [(scene, x, y.path, value) for value in y.values.tolist()]
    parts = compute_points(
        _row, jobs, "map of runs", scene, (x, y), workers=workers, progress=progress, store=store
    )
    return RunMap(scene, x, y, *(np.concatenate(column) for column in parts))


def _row(job: tuple[Scene, Axis, str, float]) -> tuple[NDArray, ...]:
    """Results (1, len(x)) of the runs along x."""
    scene, x, path, value = job
    scenes = [scene.replace({x.path: each, path: value}) for each in x.values.tolist()]
    results = ("residual", "settled")
    outcomes = cosimulate_many(scenes[0], table_of(scenes), results=results, threads=1)
    return tuple(outcomes[name][None] for name in _RESULTS)
