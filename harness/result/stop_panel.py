"""The way across each stop of a rotor over time, with its gap and where it was touched."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...models.arrays import Array
from ..master.names import along_axes
from ..output.picture import GREY, Line, Panel, PlotAxis, colour
from ..output.plot import metres
from ..scene import Scene
from .verdict.words import times

_FARTHEST = 3.0  # gaps: what is farther out is cut off, so that the gap can be seen


def stop_panel(scene: Scene, time: Array, signals: Mapping[str, Array]) -> Panel | None:
    """A panel of all stops; None without any, or where the motion was not recorded.

    Args:
        time: (T,) [s].
        signals: (T,) each, by name; displacements from rest without gravity.
    """
    ways = ways_across(scene, signals)
    if not ways:
        return None
    gaps = [stop.gap for stop in scene.rotor.stops]
    largest = max(gaps + [float(way.max()) for way in ways])
    top = min(largest, _FARTHEST * max(gaps))
    factor, unit = metres(top)
    lines = []
    for k, (stop, way) in enumerate(zip(scene.rotor.stops, ways, strict=True), start=1):
        name = f"{stop.called}, 0-peak {factor * way.max():.3g} {unit}"
        lines.append(Line((time, factor * way), name, colour(k - 1), width=1.0))
        touches = signals.get(f"rotor.stop[{k}].touches", np.zeros(len(time)))
        began = np.flatnonzero(np.diff(touches, prepend=0.0) > 0.0)
        if len(began):
            points = time[began], np.full(len(began), factor * stop.gap)
            said = f"touched {times(round(touches[-1]))}"
            lines.append(Line(points, said, colour(k - 1), "marks"))
    for gap in sorted(set(gaps)):
        ends = time[[0, -1]], np.full(2, factor * gap)
        lines.append(Line(ends, f"gap, {factor * gap:.3g} {unit}", GREY, "dashed"))
    upward = PlotAxis("way across stops", unit, limits=(0.0, 1.05 * factor * top))
    return Panel((PlotAxis("time", "s"), upward), lines, beside=True)


def ways_across(scene: Scene, signals: Mapping[str, Array]) -> list[Array]:
    """Of every stop how far from rest without gravity it was (T,) [m]; none where not recorded."""
    return [np.hypot(*way) for way in motions_across(scene, signals)]


def motions_across(scene: Scene, signals: Mapping[str, Array]) -> list[Array]:
    """Of every stop x and y of the displacement across it (2, T) [m]; none where not recorded."""
    names = along_axes(len(scene.rotor.points))
    if not all(name in signals for axis in names for name in axis):
        return []
    motion = np.array([[signals[name] for name in axis] for axis in names])
    rotor = scene.restrained_assembly().rotor
    return [np.einsum("an,ant->at", stop.rows, motion) for stop in rotor.stops]
