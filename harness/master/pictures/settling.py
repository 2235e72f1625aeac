"""Picture of settling: how long the rotor takes from every start of two weights."""

from __future__ import annotations

import re

import numpy as np

from ....models.arrays import Array
from ...errors import UserError
from ...output.picture import Field, Panel, Picture, PlotAxis
from ...scene import Scene
from ...scene.balancer import WeightBalancer

_TICKS = range(0, 361, 90)


def first_weights(scene: Scene) -> tuple[str, str]:
    """The start angles of the first two weights, as variables of the scene's composite.

    Raises:
        UserError: it has no two weights.
    """
    weights = [
        f"{b.label}.weight[{k}].angle0"
        for b in scene.balancer
        if isinstance(b, WeightBalancer)
        for k in range(1, b.count + 1)
    ]
    if len(weights) < 2:
        raise UserError(f"{scene.heading}: has no two weights, which a settling map needs")
    return weights[0], weights[1]


def settling_map(
    scene: Scene, names: tuple[str, str], angles: Array, seconds: Array, failed: int, end: float
) -> Picture:
    """Settling times (k, k) [s] over the angles (k,) [rad] of two weights at the start.

    Args:
        names: of the weights across and upward.
        seconds: NaN where the rotor has not settled at the `end` [s] of the run.
        failed: runs that could not be completed.
    """
    known = seconds[np.isfinite(seconds)]
    limits = (float(known.min()), float(known.max())) if known.size else (0.0, end)
    if limits[0] == limits[1]:
        limits = (0.0, limits[1] or end)
    degrees = np.degrees(angles)
    quantity = PlotAxis("settling time", "s", limits=limits)
    words = [re.sub(r"(.*)\.weight\[(\d+)\].*", r"weight \2 of \1", name) for name in names]
    axes = [PlotAxis(f"{weight} starts at", "deg", _TICKS) for weight in words]
    panel = Panel((axes[0], axes[1]), field=Field(degrees, degrees, seconds, quantity), equal=True)
    late = int(np.isnan(seconds).sum()) - failed
    said = f"{known.size} of {seconds.size} starts settle"
    said += f", {late} have not within {end:.3g} s (grey)" if late else ""
    said += f", {failed} cannot be run (grey)" if failed else ""
    return Picture(f"{scene.heading}\n{said}", [panel], height=6.0, width=8.0)
