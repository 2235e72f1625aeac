"""Share of run-ups that balances, over two values of a scene."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ...models.shares import wilson
from ..capture.captured import captured
from ..errors import SceneError
from ..output.table import Sheet
from ..output.workers import Progress, Workers
from ..scene import Scene
from ..stability.axis import Axis, Map, refuse_axes
from ..stability.map_store import compute_points
from .study import find_motions

STARTS_OF_POINT = 40  # +-15 points at 95 %


@dataclass(frozen=True, eq=False, repr=False)
class MotionsMap(Map):
    """Run-ups over two values.

    Attributes:
        share: of run-ups that balances; NaN where the point has failed.
        behind: share that ends with weights left behind.
        failure: why a point has failed; else empty.
    """

    drawn_by: ClassVar[str] = "..motions.plot:plot_motions_map"

    share: NDArray[np.float64]
    behind: NDArray[np.float64]
    failure: NDArray[np.object_]

    def lines(self) -> Iterator[str]:
        """What came of the run-ups, in words."""
        ran = self.share[~np.isnan(self.share)]
        yield f"{self.share.size} points, {STARTS_OF_POINT} run-ups each"
        if ran.size:
            low, high = wilson(STARTS_OF_POINT // 2, STARTS_OF_POINT)
            yield (
                f"Share that balances: {100 * ran.min():.0f} to {100 * ran.max():.0f} %, each "
                f"within {50 * (high - low):.0f} points with 95 % confidence"
            )
        for reason in dict.fromkeys(str(f) for f in self.failure.ravel() if f):
            yield f"A point failed: {reason}"

    def table(self) -> Sheet:
        """One line a point of the grid."""
        columns = {"share balanced": self.share, "share left behind": self.behind}
        return self._sheet(columns, self.failure)


def motions_map(
    scene: Scene,
    x: Axis,
    y: Axis,
    *,
    workers: Workers = 1,
    progress: Progress | None = None,
    store: Path | None = None,
) -> MotionsMap:
    """Arguments as `Scene.map`, which says what is raised."""
    refuse_axes(x, y)
    captured(scene)  # refuses what has no weights, and dry friction
    points = [(v, w) for v in y.values.tolist() for w in x.values.tolist()]
    jobs = [scene.replace({y.path: v, x.path: w}) for v, w in points]
    parts = compute_points(
        _point, jobs, "map of motions", scene, (x, y),
        workers=workers, progress=progress, store=store,
    )  # fmt: skip
    share, behind, failure = (
        np.array(column, dtype).reshape(len(y.values), len(x.values))
        for column, dtype in zip(parts, (float, float, object), strict=True)
    )
    if np.isnan(share).all():
        raise SceneError(f"no point of the map could be run: {failure[0, 0]}")
    return MotionsMap(scene, x, y, share, behind, failure)


def _point(scene: Scene) -> tuple[float, float, str]:
    try:
        found = find_motions(scene, [scene.profile().end], ["run-up"], STARTS_OF_POINT)
    except SceneError as error:
        return float("nan"), float("nan"), str(error)
    (point,) = found.points
    behind = sum(s.share for s in point.shares if s.motion.weights)
    return point.balanced.share, behind, ""
