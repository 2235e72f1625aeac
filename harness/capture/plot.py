"""Brake over the weights' speed, for each number of weights, with the pull of the drag."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ...models.arrays import Array
from ...models.capture.capture import brake_curve
from ..output.picture import GREY, Line, Panel, Picture, PlotAxis, Style, colour
from ..units import shown_in

if TYPE_CHECKING:
    from .captured import Captured

_POINTS = 1500
_BESIDE_ROTOR = 0.985  # of its speed: beyond it weights have passed


def plot_captured(data: Captured, path: Path | None = None) -> Path | Picture:
    """Stable motions where brake and drag meet are marked, unstable ones are crosses.

    Both are divided by the mean drag per speed: the lag Om - w that the brake holds, and Om - w.
    """
    found = data.found
    unit, factor = shown_in("rad/s")
    w = np.linspace(0.0, found.speed, _POINTS + 1)[1:]
    natural = [one.frequency for one in found.natural]
    w = np.unique(
        np.concatenate(
            [
                w,
                *(
                    _around(f, one.damping_ratio, found.speed)
                    for f, one in zip(natural, found.natural, strict=True)
                ),
            ]
        )
    )
    most = max(found.natural, key=lambda one: len(one.motions), default=None)
    chosen = _chosen([m.weights for m in most.motions]) if most else []
    lines, stable, unstable, top = [], [], [], found.speed
    for number, k in enumerate(chosen):
        lag = brake_curve(data.scene.assembly(), found, k, w)
        top = max(
            top,
            min(
                float(np.nanmax(lag[w < _BESIDE_ROTOR * found.speed], initial=0.0)),
                2.0 * found.speed,
            ),
        )
        label = f"brake of {k} of {found.count} {data.called}"
        lines.append(Line((w * factor, lag * factor), label, colour(number)))
        unstable += _crossings(w, lag, found.speed, falling=True)
        # above all natural frequencies weights at one angle of a track repel each other
        if k > 1 and len(data.scene.balancer) == 1:
            rising = _crossings(w, lag, found.speed, falling=False)
            unstable += [x for x in rising if x > max(natural)]
        stable += [m.frequency for _, m in found.motions if m.weights == k]
    lines.append(Line((w * factor, (found.speed - w) * factor), "drag", GREY, "dashed"))
    marks: tuple[tuple[list[float], str, Style], ...]
    marks = ((stable, "stable: left behind", "marks"), (unstable, "unstable", "crosses"))
    for points, label, style in marks:
        if points:
            x = np.array(points)
            lines.append(Line((x * factor, (found.speed - x) * factor), label, "#000000", style))
    axes = (
        PlotAxis("speed of the weights", unit, limits=(0.0, found.speed * factor)),
        PlotAxis("lag that brake or drag hold", unit, limits=(0.0, 1.05 * top * factor)),
    )
    title = f"{data.title}\nrotor at {found.speed * factor:.4g} {unit}"
    picture = Picture(title, [Panel(axes, lines)], height=4.6)
    return picture if path is None else picture.save(path)


def _around(frequency: float, ratio: float, speed: float) -> Array:
    near = frequency * (1.0 + max(ratio, 1e-4) * np.linspace(-8.0, 8.0, 161))
    return near[(near > 0.0) & (near < speed)]


def _chosen(numbers: list[int]) -> list[int]:
    """At most six of them, the first and the last among these."""
    if len(numbers) <= 6:
        return numbers
    places = np.linspace(0, len(numbers) - 1, 6).round().astype(int)
    return [numbers[k] for k in places]


def _crossings(w: Array, lag: Array, speed: float, falling: bool) -> list[float]:
    """Where the brake falls or rises through the drag, before the weights have passed."""
    left = (w + lag - speed) * (1.0 if falling else -1.0)
    with np.errstate(invalid="ignore"):
        passes = (left[:-1] > 0.0) & (left[1:] <= 0.0)
    at = np.flatnonzero(passes & (w[1:] < _BESIDE_ROTOR * speed))
    part = left[at] / (left[at] - left[at + 1])
    return [float(x) for x in w[at] + part * (w[at + 1] - w[at])]
