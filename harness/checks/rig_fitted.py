"""The rig with everything that was fitted to 1 and 3 washers, held against 0 to 4.

Every run is in C, as the scene's composite; *expected* is the rig's.  What holds, and what that
proves: harness/bristol.md.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from ..output.workers import Progress
from ..scene import Scene
from ..scene.check import RigFittedCheck
from .rig import CRITICAL
from .rig_data import SOURCE
from .rig_quantities import Quantity, with_balls, with_fitted_balls, without_balls
from .row import Row, Rows

TOLERANCES = {"critical speed": CRITICAL, "plain": 0.12, "balls": 0.25}
PREDICTED = 1.5  # times what is left where it was fitted
FITTED, OTHERS = [1, 3], [0, 2, 4]  # washers
PARTS: dict[str, Callable[[Scene], Iterator[Quantity]]] = {
    "without balls": without_balls,
    "with balls": lambda scene: with_balls(with_fitted_balls(scene)),
}


def check_rig_fitted(
    scene: Scene, check: RigFittedCheck, progress: Progress, rows_of: str
) -> Iterator[Row]:
    """Rows of one of `PARTS`.

    Raises:
        SceneError: the scene is not of the rig.
        SimulationError: a run has failed.
    """
    rows = Rows(scene.name, check.kind)
    for one in PARTS[rows_of](scene):
        yield from _rows(one, rows)
    progress(1.0)


def rig_fitted_parts(_check: RigFittedCheck) -> list[dict[str, Any]]:
    """Options of the parts of the check."""
    return [{"rows_of": name} for name in PARTS]


def _rows(one: Quantity, rows: Rows) -> Iterator[Row]:
    label, tolerance = one.label, TOLERANCES.get(one.kind, math.nan)
    if one.kind == "curve":
        fitted, predicted = (one.rms(washers) for washers in (FITTED, OTHERS))
        said = f"{label}: 0, 2, 4 washers, below {PREDICTED:g} times that of 1 and 3"
        yield rows.statement(said, fitted, predicted, predicted < PREDICTED * fitted, SOURCE)
    elif one.kind == "balls":
        yield rows.number(label, 0.0, one.rms(), tolerance, SOURCE, 1.0)
    elif one.kind in TOLERANCES:
        unit = "rpm" if one.kind == "critical speed" else "mm"
        said = f"{label}, worst of 1 to 4 washers [{unit}]"
        there = np.isfinite(one.measured) & (np.arange(5) > 0)
        yield rows.number(said, one.measured[there], one.found[there], tolerance, SOURCE)
