"""Pictures of a run-up: waterfall and polar diagram; at constant speed they stand over time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ...models.arrays import Array
from ..errors import UserError
from ..master.names import along_axes
from ..output.picture import Field, Line, Panel, Picture, PlotAxis, colour
from ..output.plot import metres
from .motion import Motion, station_names
from .orders import spectra, synchronous

SHOWN = 24  # spectra behind each other in space
MARKED = 7  # speeds along a polar curve
_FRACTION = 1e-3  # of the largest amplitude: less is dark
_BESIDE = 0.2  # of the largest amplitude: texts of closer marks cover each other


def waterfall(motion: Motion, signal: str | None = None) -> Picture:
    """Spectra of a signal behind each other, and as colours over speed and frequency.

    Args:
        signal: a displacement [m]; by default the largest.
    """
    swept = motion.sweep
    signal = signal or _largest(swept)
    spectrum = spectra(swept.angle, swept.recorded[signal])
    if not spectrum.amplitude.any():
        raise UserError(f"{signal}: does not vibrate: there is no spectrum to show")
    factor, unit = metres(float(spectrum.amplitude.max()))
    axis, values = swept.across
    across = np.interp(spectrum.angle, swept.angle, values)
    speed = np.interp(spectrum.angle, swept.angle, swept.speed)
    turns = speed / math.tau
    frequency = spectrum.orders * turns[:, None]
    heights = spectrum.amplitude * factor
    amplitude = PlotAxis("amplitude, 0-peak", unit)
    upward = PlotAxis("frequency", "Hz", limits=(0.0, float(frequency.max())))
    chosen = np.unique(np.linspace(0, len(across) - 1, SHOWN).round().astype(int))
    lines = [
        Line((frequency[k], np.full_like(frequency[k], across[k]), heights[k]), width=0.9)
        for k in chosen[::-1]
    ]
    stack = Panel((upward, axis, amplitude), lines, title=f"{signal}: spectra", kind="space")
    field = _field(across, frequency, heights, amplitude)
    middle = len(across) // 2
    lines = []
    for order in (1, 2):
        at = across[middle : middle + 1], order * turns[middle : middle + 1]
        lines.append(Line((across, order * turns), "", "#FFFFFF", "dotted", 0.9))
        text = (f"order {order}",)
        lines.append(Line(at, "", "#FFFFFF", "dots", texts=text, text_colour="#FFFFFF"))
    flat = Panel((axis, upward), lines, field, title=f"{signal}: amplitude over frequency")
    return Picture(f"{motion.scene.heading}\nwaterfall{motion.swept}", [stack, flat], height=5.2)


def _field(across: Array, frequency: Array, heights: Array, amplitude: PlotAxis) -> Field:
    """Spectra over one and the same frequencies; none above what a window has seen."""
    even = np.linspace(0.0, float(frequency.max()), 400)
    columns = [np.interp(even, f, h, right=np.nan) for f, h in zip(frequency, heights, strict=True)]
    top = float(heights.max())
    quantity = PlotAxis(amplitude.name, amplitude.unit, log=True, limits=(_FRACTION * top, top))
    return Field(across, even, np.maximum(np.array(columns).T, _FRACTION * top), quantity)


def _largest(motion: Motion) -> str:
    size = np.abs(motion.displacement).max(axis=0)
    axis, station = np.unravel_index(int(size.argmax()), size.shape)
    return along_axes(len(motion.scene.rotor.points))[axis][station]


def polar(motion: Motion) -> Picture:
    """Synchronous amplitude and phase as one curve a station, along x and along y (Nyquist)."""
    swept = motion.sweep
    rows = np.moveaxis(swept.displacement, 0, 2).reshape(-1, len(swept.time))
    angle, amplitude = synchronous(swept.angle, rows)
    axis, values = swept.across
    across = np.interp(angle, swept.angle, values)
    return polar_picture(
        f"{motion.scene.heading}\nsynchronous vibration{motion.swept}",
        across,
        axis,
        amplitude.reshape(len(across), 2, -1),
        station_names(motion.scene),
    )


def polar_picture(
    title: str, across: Array, axis: PlotAxis, amplitude: Any, names: Sequence[str]
) -> Picture:
    """Polar diagrams of complex amplitudes (k, 2, n) [m] along x and y, marked by `across`."""
    factor, unit = metres(float(np.abs(amplitude).max()))
    largest = np.abs(amplitude).max(axis=0).argmax(axis=1)  # the station that is marked
    panels = []
    for column, letter in enumerate("xy"):
        lines = []
        for j, name in enumerate(names):
            curve = amplitude[:, column, j]
            points = np.angle(curve), np.abs(curve) * factor
            label = name if column and len(names) > 1 else ""
            lines.append(Line(points, label, colour(j)))
            if j == largest[column]:
                marked = _spaced_points(curve)
                texts = tuple(f"{across[k]:.3g} {axis.unit}" for k in marked)
                there = points[0][marked], points[1][marked]
                lines.append(Line(there, "", colour(j), "marks", texts=texts))
        heading = f"along {letter}: 0-peak [{unit}], phase to the rotor; marks: {axis.name}"
        axes = (PlotAxis("phase", "deg"), PlotAxis("amplitude, 0-peak", unit))
        panels.append(Panel(axes, lines, title=heading, kind="polar"))
    return Picture(title, panels, columns=2, height=5.4, width=6.4)


def _spaced_points(curve: Any) -> list[int]:
    """Points of a curve at equal distances along it, without those beside one before."""
    way = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(curve)))])
    chosen: list[int] = []
    for k in np.searchsorted(way, np.linspace(0.0, way[-1], MARKED)).tolist():
        if all(abs(curve[k] - curve[other]) > _BESIDE * np.abs(curve).max() for other in chosen):
            chosen.append(k)
    return chosen
