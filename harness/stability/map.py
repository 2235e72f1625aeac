"""Stability over two parameters of a scene: growth rates on a grid, some points co-simulated."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ...models.assembly import Assembly
from ...models.stability import growth_map
from ..errors import SimulationError
from ..output.store import StoredItems
from ..output.table import Sheet
from ..output.words import kinds_of
from ..output.workers import Progress, Workers, in_order
from ..scene import Scene
from ..scene.replace import SPEED
from .axis import Axis, Map, refuse_axes
from .boundaries import criterion_of
from .main_motion import MainMotion
from .map_store import open_map

Vector = NDArray[np.float64]
Reasons = NDArray[np.object_]  # why points have no growth rate; empty where they have
_STRIPS = {
    "growth": "largest growth rate [1/s]",
    "criterion": "negative: balanced by the criterion",
    "why_not": "why there is no growth rate",
}
_ROWS = 8  # values of the slow axis solved together; more would hide the progress
_PLASTIC = 1.324717957244746  # its powers spread points evenly over a square


@dataclass(frozen=True)
class MapPoint:
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


@dataclass(frozen=True, eq=False, repr=False)
class StabilityMap(Map):
    """Growth rates over two parameters.

    Attributes:
        growth: largest growth rate [1/s]; NaN where weights cannot balance.
        criterion: negative where the criterion says balanced, in units of its largest value; None
            where it does not apply.
        no_criterion: why not.
        points: co-simulated.
        failure: why a point has no growth rate, where its equations cannot be solved; else empty.
    """

    drawn_by: ClassVar[str] = "..stability.plot:plot_map"

    growth: Vector
    criterion: Vector | None
    no_criterion: str
    points: tuple[MapPoint, ...]
    failure: Reasons

    @property
    def agreeing(self) -> int:
        """Co-simulated points on the same side as Floquet, or without a main motion by both."""
        return sum(
            (p.growth > 0.0) == (self.growth[p.y, p.x] > 0.0)
            and math.isnan(p.growth) == math.isnan(self.growth[p.y, p.x])
            for p in self.points
        )

    def lines(self) -> Iterator[str]:
        """What was found, in words.

        >>> found = ab.load("filimonikhina").map("speed=1:6:4", "weights.drag=0.01:1:3:log")
        >>> list(found.lines())[0]
        '12 points: 6 balanced, 6 not, 0 where the weights cannot balance'
        """
        failed = self.failure[self.failure != ""]
        none = int(np.isnan(self.growth).sum()) - failed.size
        yield (
            f"{self.growth.size} points: {int((self.growth <= 0.0).sum())} balanced, "
            f"{int((self.growth > 0.0).sum())} not, {none} where the weights cannot balance"
        )
        if self.criterion is None:
            yield f"criterion: does not apply: {self.no_criterion}"
        if self.points:
            yield f"{self.agreeing} of {len(self.points)} co-simulated points agree with Floquet"
        refused = [*failed, *(p.refusal for p in self.points if p.refusal)]
        for count, reason in kinds_of(refused)[:3]:
            yield f"{count} without a verdict, such as: {reason}"

    def table(self) -> Sheet:
        """One line a point of the grid."""
        measured = {(p.y, p.x): p.growth for p in self.points}
        rows = []
        for (j, i), growth in np.ndenumerate(self.growth):
            word = ""
            if self.criterion is not None:
                word = "stable" if self.criterion[j, i] < 0.0 else "unstable"
            rows.append((*self._place(j, i), float(growth), word, measured.get((j, i), "")))
        heads = (*self.labels, "growth rate [1/s]", "criterion", "cosim growth rate [1/s]")
        return Sheet(heads, rows, title=self.title)


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

    Arguments are those of `Scene.map`, which says what is raised.
    """
    scene.refuse_friction("a map of growth rates is that")
    refuse_axes(x, y)
    report = progress or (lambda done: None)
    share = 1.0 if not cosim else 0.5
    transposed = y.path == SPEED  # a strip runs along the speed if that takes part
    slow, fast = (x, y) if transposed else (y, x)
    rows = _ROWS if fast.path == SPEED else 1
    starts = range(0, len(slow.values), rows)
    jobs = [(scene, slow.path, slow.values[i : i + rows].tolist(), fast) for i in starts]
    places = grid_points(cosim, len(x.values), len(y.values))
    kept: dict[str, StoredItems] = {}
    if store is not None:
        form: dict[str, Any] = {"along": "x" if transposed else "y", "rows": rows, "places": places}
        kept = open_map(store, "stability map", scene, x, y, _STRIPS, **form)
    strips = in_order(_strip, jobs, workers, lambda done: report(share * done), kept.get("strip"))
    grids = [np.concatenate(arrays) for arrays in zip(*strips, strict=True)]
    growth, criterion, why_not = (grid.T if transposed else grid for grid in grids)
    work = [(scene, {x.path: x.values[i], y.path: y.values[j]}) for i, j in places]
    rates = in_order(
        _measure, work, workers, lambda done: report(0.5 + 0.5 * done), kept.get("point")
    )
    applies = bool(np.isfinite(criterion).any())
    return StabilityMap(
        scene,
        x,
        y,
        growth,
        criterion if applies else None,
        "" if applies else _why_no_criterion(scene),
        tuple(MapPoint(*place, *rate) for place, rate in zip(places, rates, strict=True)),
        why_not,
    )


def _strip(
    job: tuple[Scene, str, list[float], Axis],
) -> tuple[Vector, Vector, Reasons]:
    """Growth rates, the criterion, reasons, (values of the slow axis, all of the fast)."""
    scene, slow, values, fast = job
    along = fast.path == SPEED
    others = [{}] if along else [{fast.path: value} for value in fast.values]
    scenes = [scene.replace({slow: v, **other}) for v, other in itertools.product(values, others)]
    for each in scenes:
        each.refuse_unrest("a map of growth rates")
    assemblies = [s.assembly() for s in scenes]
    speeds = fast.values if along else np.array([scenes[0].profile().end])
    growth, why_not = _rates(assemblies, speeds)
    criterion = np.concatenate([_criterion(a, speeds) for a in assemblies])
    shape = len(values), len(fast.values)
    return growth.reshape(shape), criterion.reshape(shape), why_not.reshape(shape)


def _rates(assemblies: Sequence[Assembly], speeds: Vector) -> tuple[Vector, Reasons]:
    """Growth rates (assemblies, speeds); what cannot be solved is NaN, and why."""
    why_not = np.full((len(assemblies), len(speeds)), "", dtype=object)
    try:
        return growth_map(assemblies, speeds), why_not
    except (ValueError, ArithmeticError):  # of NumPy's own LinAlgError is one
        pass
    growth = np.full(why_not.shape, math.nan)
    for i, j in np.ndindex(why_not.shape):
        try:
            growth[i, j] = growth_map([assemblies[i]], speeds[j : j + 1])[0, 0]
        except (ValueError, ArithmeticError) as error:
            why_not[i, j] = str(error)
    return growth, why_not


def _criterion(assembly: Assembly, speeds: Vector) -> Vector:
    try:
        criterion = criterion_of(assembly)
    except ValueError:
        return np.full(len(speeds), np.nan)
    scale = (criterion.w_x * criterion.w_y) ** 3 + speeds**6
    return np.asarray(criterion.value(speeds)) / scale


def _why_no_criterion(scene: Scene) -> str:
    try:
        criterion_of(scene.assembly())
    except ValueError as error:
        return str(error)
    return "no point of the map has one"


def grid_points(count: int, columns: int, rows: int) -> list[tuple[int, int]]:
    """Different points of a grid, evenly spread, the same for the same count.

    Additive recurrence of the plastic number: no two of n points in the unit square are nearer than
    0.6/sqrt(n), while Halton's and Sobol's sequences come down to 0.4 and less.
    """
    points: dict[tuple[int, int], None] = {}
    for k in itertools.count(1):
        if len(points) == min(count, columns * rows):
            break
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
