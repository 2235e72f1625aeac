"""Vibration of a run with balancers and of the same run without."""

from __future__ import annotations

import numpy as np

from ...models.arrays import Array
from ..errors import UserError
from ..master.names import displacements
from ..output.picture import GREY, Line, Panel, Picture, PlotAxis, colour
from ..output.plot import metres
from ..scene import Scene
from .sag import complex_motion, from_sag, sag_of
from .verdict.passages import without_balancers

_POINTS = 400  # of an envelope
_SMALLEST = 1e-4  # of the largest vibration: less is not shown


def compare(scene: Scene, time: Array, signals: dict[str, Array]) -> Picture:
    """Largest distance of a station from the middle, in short parts of the time.

    Args:
        time: (T,) [s].
        signals: (T,) each, with the displacements of all stations [m].

    Raises:
        UserError: there are no balancers, displacements were not recorded, or the rotor without
            balancers cannot run.
    """
    if not scene.balancer:
        raise UserError("--compare: the scene has no balancer to leave out")
    count = len(scene.rotor.points)
    missing = [name for name in displacements(count) if name not in signals]
    if missing:
        raise UserError(f"--compare: {', '.join(missing)}: not recorded; name them in run.record")
    moved = from_sag(signals, sag_of(scene, time, signals.get("motor.speed")))
    size = np.abs(complex_motion(moved, count)).max(axis=0)
    bare = without_balancers(scene)
    if bare is None:
        raise UserError("--compare: the rotor without balancers cannot be run")
    return draw_both(scene, (time, size), bare)


def draw_both(scene: Scene, own: tuple[Array, Array], bare: tuple[Array, Array]) -> Picture:
    """The envelopes of both runs, each by its times (T,) [s] and distances (T,) [m]."""
    factor, unit = metres(float(max(own[1].max(), bare[1].max())))
    lines = [
        _envelope(*bare, factor, "without balancers", GREY),
        _envelope(*own, factor, "with balancers", colour(0)),
    ]
    top = max(float(line.points[1].max()) for line in lines)
    vibration = PlotAxis("vibration, 0-peak", unit, log=True, limits=(_SMALLEST * top, 1.5 * top))
    panels = [Panel((PlotAxis("time", "s"), vibration), lines)]
    profile = scene.profile()
    if profile.changes and not scene.operation.motor:
        speed = Line((own[0], profile.speeds_at(own[0])), "", GREY)
        panels.append(Panel((PlotAxis("time", "s"), PlotAxis("speed", "rad/s")), [speed]))
    return Picture(f"{scene.heading}: with and without balancers", panels)


def _envelope(time: Array, size: Array, factor: float, label: str, shade: str) -> Line:
    edges = np.linspace(time[0], time[-1], _POINTS + 1)
    part = np.clip(np.searchsorted(edges, time, side="right") - 1, 0, _POINTS - 1)
    largest = np.zeros(_POINTS)
    np.maximum.at(largest, part, size)
    seen = np.bincount(part, minlength=_POINTS) > 0
    middles = 0.5 * (edges[1:] + edges[:-1])
    return Line((middles[seen], largest[seen] * factor), label, shade)
