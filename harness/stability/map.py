"""Stability over two parameters of a scene: growth rates on a grid, some points co-simulated."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...models.assembly import Assembly
from ...models.criteria import Criterion
from ...models.stability import growth_map
from ..errors import SimulationError, UserError
from ..output.table import Sheet
from ..output.workers import Progress, Workers, in_order
from ..scene import Scene
from .axis import SPEED, Axis
from .main_motion import MainMotion
from .map_store import ROWS, open_map

_Strip = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.object_]]
_PLASTIC = 1.324717957244746  # its powers spread points evenly over a square


@dataclass(frozen=True)
class Point:
    """A co-simulated point.

    Attributes:
        x, y: places on both axes.
        growth: largest growth rate [1/s]; NaN where there is no verdict.
        refusal: why not.
    """

    x: int
    y: int
    growth: float
    refusal: str = ""


@dataclass(frozen=True)
class StabilityMap:
    """Growth rates over two parameters.

    Attributes:
        title: of the scene.
        x, y: axes, and their labels.
        growth: (len(y), len(x)) largest growth rate [1/s]; NaN where weights cannot balance.
        criterion: (len(y), len(x)) negative where the criterion says balanced, in units of its
            largest value; None where it does not apply.
        no_criterion: why not.
        points: co-simulated.
        failed: of the grid, without a growth rate because its equations cannot be solved.
    """

    title: str
    x: Axis
    y: Axis
    labels: tuple[str, str]
    growth: NDArray[np.float64]
    criterion: NDArray[np.float64] | None
    no_criterion: str = ""
    points: tuple[Point, ...] = field(default=())
    failed: tuple[Point, ...] = field(default=())

    @property
    def agreeing(self) -> int:
        """Co-simulated points on the same side as Floquet, or without a main motion by both."""
        return sum(
            (p.growth > 0.0) == (self.growth[p.y, p.x] > 0.0)
            and math.isnan(p.growth) == math.isnan(self.growth[p.y, p.x])
            for p in self.points
        )

    def to_csv(self, path: Path) -> Path:
        """One line a point of the grid.

        Raises:
            UserError: the file cannot be written.
        """
        measured = {(p.y, p.x): f"{p.growth:.10g}" for p in self.points}
        rows = []
        for j, y in enumerate(self.y.values):
            for i, x in enumerate(self.x.values):
                word = ""
                if self.criterion is not None:
                    word = "stable" if self.criterion[j, i] < 0.0 else "unstable"
                cells = (f"{x:.10g}", f"{y:.10g}", f"{self.growth[j, i]:.10g}", word)
                rows.append((*cells, measured.get((j, i), "")))
        heads = (*self.labels, "growth rate [1/s]", "criterion", "cosim growth rate [1/s]")
        return Sheet(heads, rows).write_csv(path)


def stability_map(
    scene: Scene,
    x: Axis,
    y: Axis,
    *,
    cosim: int = 0,
    workers: Workers = 1,
    progress: Progress | None = None,
    store: Path | None = None,
) -> StabilityMap:
    """Growth rates by Floquet over two parameters, and by co-simulation at some points.

    Args:
        cosim: how many points of the grid, spread evenly, are also co-simulated.
        workers: processes, or an executor; a script that asks for more than one needs
            `if __name__ == "__main__":`.
        progress: called with the finished fraction.
        store: keeps every outcome as it comes; what it holds already is not computed again.

    Raises:
        UserError: a path is unknown, a value on an axis is wrong, both axes are the same, or the
            store is another map's.
    """
    if x.path == y.path:
        raise UserError(f"{x.path}: both axes are the same")
    for axis in (x, y):
        if axis.path == SPEED and not axis.values[0] > 0.0:
            raise UserError(f"speed = {axis.values[0]:g} rad/s: must be greater than 0")
    share = 1.0 if not cosim else 0.5

    def report(done: float) -> None:
        if progress:
            progress(done)

    jobs = list(_jobs(scene, x, y))
    places = grid_points(cosim, len(x.values), len(y.values))
    kept = {} if store is None else open_map(store, scene, x, y, jobs[0].transposed, places)
    parts = in_order(_strip, jobs, workers, lambda done: report(share * done), kept.get("strip"))
    growth, criterion, why_not = (np.vstack(arrays) for arrays in zip(*parts, strict=True))
    if jobs[0].transposed:
        growth, criterion, why_not = growth.T, criterion.T, why_not.T
    work = [(scene, {x.path: x.values[i], y.path: y.values[j]}) for i, j in places]
    rates = in_order(
        _measure, work, workers, lambda done: report(0.5 + 0.5 * done), kept.get("point")
    )
    applies = bool(np.isfinite(criterion).any())
    return StabilityMap(
        scene.heading,
        x,
        y,
        (x.label(scene), y.label(scene)),
        growth,
        criterion if applies else None,
        "" if applies else _why_no_criterion(scene),
        tuple(Point(*place, *rate) for place, rate in zip(places, rates, strict=True)),
        tuple(
            Point(int(i), int(j), math.nan, str(why_not[j, i]))
            for j, i in np.argwhere(why_not != "")
        ),
    )


@dataclass(frozen=True)
class _Job:
    """Some values of the slow axis, with all of the fast one; the speed is fast if it takes part.

    Attributes:
        transposed: the slow axis is x.
    """

    scene: Scene
    slow: str
    values: tuple[float, ...]
    fast: Axis
    transposed: bool


def _jobs(scene: Scene, x: Axis, y: Axis) -> Iterator[_Job]:
    transposed = y.path == SPEED
    slow, fast = (x, y) if transposed else (y, x)
    for start in range(0, len(slow.values), ROWS):
        values = tuple(slow.values[start : start + ROWS].tolist())
        yield _Job(scene, slow.path, values, fast, transposed)


def _strip(job: _Job) -> _Strip:
    """Growth rates, the criterion, and why there is no rate, (values, fast values) each."""
    if job.fast.path == SPEED:
        assemblies = [job.scene.replace({job.slow: v}).assembly() for v in job.values]
        rates, why_not = _rates(assemblies, job.fast.values)
        return rates, np.array([_criterion(a, job.fast.values) for a in assemblies]), why_not
    rows = []
    for value in job.values:
        scenes = [job.scene.replace({job.slow: value, job.fast.path: v}) for v in job.fast.values]
        speed = np.array([scenes[0].profile().end])
        assemblies = [scene.assembly() for scene in scenes]
        rates, why_not = _rates(assemblies, speed)
        criterion = np.concatenate([_criterion(a, speed) for a in assemblies])
        rows.append((rates[:, 0], criterion, why_not[:, 0]))
    growth, criterion, why_not = (np.array(row) for row in zip(*rows, strict=True))
    return growth, criterion, why_not


def _rates(
    assemblies: Sequence[Assembly], speeds: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.object_]]:
    """Growth rates (assemblies, speeds); a point that cannot be solved is NaN, with its reason."""
    why_not = np.full((len(assemblies), len(speeds)), "", dtype=object)
    try:
        return growth_map(assemblies, speeds), why_not
    except (ValueError, ArithmeticError):  # of NumPy's own LinAlgError is one
        pass
    growth = np.full(why_not.shape, np.nan)
    for i, assembly in enumerate(assemblies):
        for j in range(len(speeds)):
            try:
                growth[i, j] = growth_map([assembly], speeds[j : j + 1])[0, 0]
            except (ValueError, ArithmeticError) as error:
                why_not[i, j] = str(error)
    return growth, why_not


def _criterion(assembly: Assembly, speeds: NDArray[np.float64]) -> NDArray[np.float64]:
    try:
        if not assembly.weights:
            raise ValueError
        criterion = Criterion.of(assembly)
    except ValueError:
        return np.full(len(speeds), np.nan)
    scale = (criterion.w_x * criterion.w_y) ** 3 + speeds**6
    return np.asarray(criterion.value(speeds)) / scale


def _why_no_criterion(scene: Scene) -> str:
    assembly = scene.assembly()
    if not assembly.weights:
        return "the criterion is for weights, and the scene has none"
    try:
        Criterion.of(assembly)
    except ValueError as error:
        return str(error)
    return "no point of the map has one"


def grid_points(count: int, columns: int, rows: int) -> list[tuple[int, int]]:
    """Different points of a grid, evenly spread, the same for the same count.

    Additive recurrence of the plastic number: no two of n points in the unit square are nearer than
    0.6/sqrt(n), while Halton's and Sobol's sequences come down to 0.4 and less.
    """
    count = min(count, columns * rows)
    points: dict[tuple[int, int], None] = {}
    k = 0
    while len(points) < count:
        k += 1
        u, v = (0.5 + k / _PLASTIC) % 1.0, (0.5 + k / _PLASTIC**2) % 1.0
        points[int(u * columns), int(v * rows)] = None
    return list(points)


def _measure(job: tuple[Scene, dict[str, float]]) -> tuple[float, str]:
    scene, changes = job
    scene = scene.replace(changes)
    try:
        with MainMotion(scene) as motion:
            return motion.growth(scene.profile().end), ""
    except SimulationError as error:  # one point without a verdict must not cost the map
        return math.nan, str(error)
