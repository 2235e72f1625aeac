"""Stability over two parameters of a scene: growth rates on a grid."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ...models.assembly import Assembly
from ...models.stability import growth_map_with_errors
from ..output.table import Sheet
from ..output.words import kinds_of
from ..output.workers import Progress, Workers
from ..scene import Scene
from ..scene.replace import SPEED
from .axis import Axis, Map, refuse_axes
from .boundaries import criterion_of
from .map_store import compute_points

Vector = NDArray[np.float64]
Reasons = NDArray[np.object_]  # why points have no growth rate; empty where they have
_ROWS = 8  # values of the slow axis solved together; more would hide the progress


@dataclass(frozen=True, eq=False, repr=False)
class StabilityMap(Map):
    """Growth rates over two parameters.

    Attributes:
        growth: largest growth rate [1/s]; NaN where weights cannot balance.
        error: of it [1/s]; 0 where growth is so fast that its sign is certain.
        criterion: negative where the criterion says balanced, in units of its largest value; None
            where it does not apply.
        no_criterion: why not.
        failure: why a point has no growth rate, where its equations cannot be solved; else empty.
    """

    drawn_by: ClassVar[str] = "..stability.plot:plot_map"

    growth: Vector
    error: Vector
    criterion: Vector | None
    no_criterion: str
    failure: Reasons

    @property
    def undecided(self) -> NDArray[np.bool_]:
        """Where the growth does not exceed its error, as without any damping."""
        return np.asarray((self.error > 0.0) & (np.abs(self.growth) <= self.error))

    def lines(self) -> Iterator[str]:
        """What was found, in words.

        >>> found = ab.load("filimonikhina").map("speed=1:6:4", "weights.drag=0.01:1:3:log")
        >>> list(found.lines())[0]
        '12 points: 6 balanced, 6 not, 0 where the weights cannot balance'
        """
        failed = self.failure[self.failure != ""]
        none = int(np.isnan(self.growth).sum()) - failed.size
        known, unknown = ~self.undecided, int(self.undecided.sum())
        grows = int((known & (self.growth > 0.0)).sum())
        decays, points = int((known & (self.growth <= 0.0)).sum()), f"{self.growth.size} points"
        if self.scene.assembly().weights:
            unable = f"{none} where the weights cannot balance"
            yield f"{points}: {decays} balanced, {grows} not, {unable}"
        else:
            yield f"{points}: {decays} stable, {grows} not; the scene has no weights that balance"
        if unknown:
            most = float((np.abs(self.growth) + self.error)[self.undecided].max())
            yield f"{unknown} undecided or neutral: growth below {most:.2g} 1/s"
        if self.criterion is None:
            yield f"criterion: does not apply: {self.no_criterion}"
        for count, reason in kinds_of(failed)[:3]:
            yield f"{count} without a verdict, such as: {reason}"

    def table(self) -> Sheet:
        """One line a point of the grid."""
        word = np.full(self.growth.shape, "", dtype=object)
        if self.criterion is not None:
            word[:] = np.where(self.criterion < 0.0, "stable", "unstable")
        return self._sheet(
            {
                "growth rate [1/s]": self.growth,
                "criterion": word,
                "error of the rate [1/s]": self.error,
            }
        )


def stability_map(
    scene: Scene,
    x: Axis,
    y: Axis,
    *,
    workers: Workers = 1,
    progress: Progress | None = None,
    store: str | Path | None = None,
) -> StabilityMap:
    """Growth rates by Floquet over two parameters.

    Arguments are those of `Scene.map`, which says what is raised.
    """
    scene.refuse_friction("a map of growth rates is that")
    refuse_axes(x, y)
    transposed = y.path == SPEED  # a strip runs along the speed if that takes part
    slow, fast = (x, y) if transposed else (y, x)
    rows = _ROWS if fast.path == SPEED else 1
    starts = range(0, len(slow.values), rows)
    jobs = [(scene, slow.path, slow.values[i : i + rows].tolist(), fast) for i in starts]
    parts = compute_points(
        _strip, jobs, "stability map with errors", scene, (x, y),
        workers=workers, progress=progress, store=store,
    )  # fmt: skip
    grids = [np.concatenate(arrays) for arrays in parts]
    growth, error, criterion, why_not = (grid.T if transposed else grid for grid in grids)
    applies = bool(np.isfinite(criterion).any())
    return StabilityMap(
        scene,
        x,
        y,
        growth,
        error,
        criterion if applies else None,
        "" if applies else _why_no_criterion(scene),
        why_not,
    )


def _strip(
    job: tuple[Scene, str, list[float], Axis],
) -> tuple[Vector, Vector, Vector, Reasons]:
    """Growth rates, errors, the criterion, reasons, (values of the slow axis, all of the fast)."""
    scene, slow, values, fast = job
    along = fast.path == SPEED
    others = [{}] if along else [{fast.path: value} for value in fast.values]
    scenes = [scene.replace({slow: v, **other}) for v, other in itertools.product(values, others)]
    for each in scenes:
        each.refuse_unrest("a map of growth rates")
    assemblies = [s.assembly() for s in scenes]
    speeds = fast.values if along else np.array([scenes[0].profile().end])
    growth, error, why_not = _rates(assemblies, speeds)
    criterion = np.concatenate([_criterion(a, speeds) for a in assemblies])
    shape = len(values), len(fast.values)
    grids = (growth.reshape(shape), error.reshape(shape), criterion.reshape(shape))
    return (*grids, why_not.reshape(shape))


def _rates(assemblies: Sequence[Assembly], speeds: Vector) -> tuple[Vector, Vector, Reasons]:
    """Growth rates and errors (assemblies, speeds); what cannot be solved is NaN, and why."""
    why_not = np.full((len(assemblies), len(speeds)), "", dtype=object)
    try:
        return (*growth_map_with_errors(assemblies, speeds), why_not)
    except (ValueError, ArithmeticError):  # of NumPy's own LinAlgError is one
        pass
    growth, error = np.full(why_not.shape, math.nan), np.zeros(why_not.shape)
    for i, j in np.ndindex(why_not.shape):
        try:
            one = growth_map_with_errors([assemblies[i]], speeds[j : j + 1])
            growth[i, j], error[i, j] = (each[0, 0] for each in one)
        except (ValueError, ArithmeticError) as fault:
            why_not[i, j] = str(fault)
    return growth, error, why_not


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
