"""Polar pictures of balancing: what is mounted in each plane, and the vibration of runs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from ..output.picture import GREY, Line, Panel, Picture, PlotAxis, colour
from ..output.plot import readable
from .correction import Correction
from .cycles import BalancingReport, Technology

_PREFIXES = ((1.0, "kg m"), (1e-3, "g m"), (1e-6, "g mm"), (1e-9, "mg mm"))
_COLOURS = {"complex": colour(0), "scalar": colour(1)}
_GOAL = colour(2)
_PERMISSIBLE = "opposite of the actual unbalance: permissible at a support (the smaller share)"
_NUMBERS = ("", "2", "3", "4")  # of the cycles; those after them lie close together
_MARGIN = 1.15  # of the largest vector that is shown


def plot_corrections(result: BalancingReport, path: Path | None) -> Path | Picture:
    """One polar diagram per plane: what was mounted after every cycle, and where it had to go."""
    # a technology that diverges would shrink all else to a point
    shown = [t for t in result.technologies if t.meets] or list(result.technologies)
    needed = result.technologies[0].cycles[0].actual
    vectors = [needed, *(cycle.mounted for t in shown for cycle in t.cycles)]
    largest = float(np.abs(vectors).max())
    factor, unit = readable(largest, _PREFIXES)
    circle = result.at_supports.min() * np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 181))
    panels = []
    for i, plane in enumerate(result.planes):
        lines = [_line(factor * (circle - needed[i]), _PERMISSIBLE, _GOAL, "dashed")]
        for technology in result.technologies:
            lines += _mounted(technology, i, factor, _MARGIN * largest)
        title = f"plane {plane}: mounted [{unit}], angle in the rotor"
        panels.append(_panel(lines, title, has_legend=not i))
    title = f"{result.title}\n{result.grade} at {result.speed:g} rad/s on the machine"
    return _drawn(title, panels, path)


def plot_measured(result: Correction, path: Path | None) -> Path | Picture:
    """One polar diagram per plane, and one of the sensors."""
    measured = result.measured
    panels = []
    for j, plane in enumerate(measured.planes):
        trials = measured.mounted[:, j]
        pieces = [p.mass * np.exp(1j * p.angle) for p in result.pieces if p.plane == plane]
        lines = [
            _line([0.0, result.exact[j]], f"correction, {result.method}", _GOAL),
            _line(trials[np.abs(trials) > 0.0], "mounted in the runs", GREY, "marks"),
            _line(pieces, "to mount", colour(0), "marks"),
            _line([], "vibration measured", colour(1)),
            _line([], "vibration expected", colour(3)),
        ]
        title = f"plane {plane}: mass [g], angle in the rotor"
        panels.append(_panel(lines, title, has_legend=not j))
    readings = zip(measured.sensors, result.before, result.after, strict=True)
    lines = [
        line
        for name, before, after in readings
        for line in (
            _line([0.0, before], "", colour(1), texts=("", name)),
            _line([0.0, after], "", colour(3)),
        )
    ]
    panels.append(_panel(lines, f"vibration [{measured.unit}]"))
    return _drawn(f"Run {measured.runs[0]!r}, and with the corrections\n", panels, path)


def _mounted(technology: Technology, plane: int, factor: float, largest: float) -> list[Line]:
    """Corrections of one technology from nothing to the last, numbered by cycle."""
    mounted = np.array([cycle.mounted[plane] for cycle in technology.cycles])
    mounted = factor * mounted[np.abs(mounted) <= largest]
    end = "" if technology.meets else ", grade not met"
    label = f"{technology.name} coefficients: {len(technology.cycles)} cycles{end}"
    paint = _COLOURS[technology.name]
    numbers = replace(_line(mounted, "", paint, "marks", _NUMBERS), text_colour=paint)
    return [_line(mounted, label, paint), numbers]


def _line(
    values: ArrayLike, label: str, paint: str, style: str = "solid", texts: Sequence[str] = ()
) -> Line:
    """Complex values by angle and size."""
    there = np.atleast_1d(np.asarray(values, complex))
    points = np.angle(there), np.abs(there)
    return Line(points, label, paint, style, texts=tuple(texts))  # type: ignore[arg-type]


def _panel(lines: Sequence[Line], title: str, has_legend: bool = True) -> Panel:
    named = lines if has_legend else [replace(line, label="") for line in lines]
    return Panel((PlotAxis("angle"), PlotAxis("size")), named, title=title, kind="polar")


def _drawn(title: str, panels: Sequence[Panel], path: Path | None) -> Path | Picture:
    picture = Picture(title, panels, columns=len(panels), height=5.4, width=5.4)
    return picture if path is None else picture.save(path)
