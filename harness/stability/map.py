"""Stability over two parameters of a scene: growth rates on a grid, some points co-simulated."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...models.assembly import Assembly
from ...models.stability import growth_map
from ..errors import SimulationError, UserError
from ..output.table import Sheet
from ..output.workers import Progress, Workers, in_order
from ..scene import Scene
from .axis import SPEED, Axis
from .boundaries import criterion_of
from .main_motion import MainMotion

Vector = NDArray[np.float64]
Reasons = list[tuple[int, str]]  # why points of a strip have no growth rate, by their places
_ROWS = 8  # values of the slow axis solved together; more would hide the progress
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
    points: tuple[Point, ...] = ()
    failed: tuple[Point, ...] = ()

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
        for (j, i), growth in np.ndenumerate(self.growth):
            numbers = (f"{n:.10g}" for n in (self.x.values[i], self.y.values[j], growth))
            word = ""
            if self.criterion is not None:
                word = "stable" if self.criterion[j, i] < 0.0 else "unstable"
            rows.append((*numbers, word, measured.get((j, i), "")))
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
) -> StabilityMap:
    """Growth rates by Floquet over two parameters, and by co-simulation at some points.

    Args:
        cosim: how many points of the grid, spread evenly, are also co-simulated.
        workers: processes, or an executor; a script that asks for more than one needs
            `if __name__ == "__main__":`.
        progress: called with the finished fraction.

    Raises:
        UserError: a path is unknown, a value on an axis is wrong, or both axes are the same.
    """
    if x.path == y.path:
        raise UserError(f"{x.path}: both axes are the same")
    for axis in (x, y):
        if axis.path == SPEED and not axis.values[0] > 0.0:
            raise UserError(f"speed = {axis.values[0]:g} rad/s: must be greater than 0")
    report = progress or (lambda done: None)
    share = 1.0 if not cosim else 0.5
    transposed = y.path == SPEED  # a strip runs along the speed if that takes part
    slow, fast = (x, y) if transposed else (y, x)
    rows = _ROWS if fast.path == SPEED else 1
    starts = range(0, len(slow.values), rows)
    jobs = [(scene, slow.path, slow.values[i : i + rows].tolist(), fast) for i in starts]
    strips = in_order(_strip, jobs, workers, lambda done: report(share * done))
    shape = len(slow.values), len(fast.values)
    growth, criterion = (np.concatenate([s[k] for s in strips]).reshape(shape) for k in (0, 1))
    missing = [
        (divmod(start * shape[1] + place, shape[1]), why)
        for start, (_, _, reasons) in zip(starts, strips, strict=True)
        for place, why in reasons
    ]
    points: list[Point] = []
    if cosim:
        places = grid_points(cosim, len(x.values), len(y.values))
        work = [(scene, {x.path: x.values[i], y.path: y.values[j]}) for i, j in places]
        rates = in_order(_measure, work, workers, lambda done: report(0.5 + 0.5 * done))
        points = [Point(*place, *rate) for place, rate in zip(places, rates, strict=True)]
    applies = bool(np.isfinite(criterion).any())
    return StabilityMap(
        scene.heading,
        x,
        y,
        (x.label(scene), y.label(scene)),
        growth.T if transposed else growth,
        (criterion.T if transposed else criterion) if applies else None,
        "" if applies else _why_no_criterion(scene),
        tuple(points),
        tuple(Point(*(at if transposed else at[::-1]), math.nan, why) for at, why in missing),
    )


def _strip(job: tuple[Scene, str, list[float], Axis]) -> tuple[Vector, Vector, Reasons]:
    """Growth rates and the criterion at some values of the slow axis and all of the fast one."""
    scene, slow, values, fast = job
    along = fast.path == SPEED
    others = [{}] if along else [{fast.path: value} for value in fast.values]
    scenes = [scene.replace({slow: v, **other}) for v, other in itertools.product(values, others)]
    assemblies = [s.assembly() for s in scenes]
    speeds = fast.values if along else np.array([scenes[0].profile().end])
    growth, reasons = _rates(assemblies, speeds)
    return growth, np.concatenate([_criterion(a, speeds) for a in assemblies]), reasons


def _rates(assemblies: Sequence[Assembly], speeds: Vector) -> tuple[Vector, Reasons]:
    """Growth rates of all pairs, assembly by assembly; what cannot be solved is NaN, and why."""
    try:
        return growth_map(assemblies, speeds).ravel(), []
    except (ValueError, ArithmeticError):  # of NumPy's own LinAlgError is one
        pass
    growth, reasons = [], []
    for number, (assembly, speed) in enumerate(itertools.product(assemblies, speeds)):
        try:
            growth.append(growth_map([assembly], [speed])[0, 0])
        except (ValueError, ArithmeticError) as error:
            growth.append(math.nan)
            reasons.append((number, str(error)))
    return np.array(growth), reasons


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
