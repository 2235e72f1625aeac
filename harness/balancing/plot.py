"""Polar picture of balancing: what was mounted in each plane, cycle by cycle."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

from ..output.plot import Drawing, readable, save
from .cycles import BalancingReport, Technology

# h_pad [inches]: the layout does not see titles that give way to the labels of angles
LAYOUT = ConstrainedLayoutEngine(h_pad=0.2)
_COLOURS = {"complex": "tab:blue", "scalar": "tab:orange"}
_MARKERS = {"complex": "o", "scalar": "s"}
_PREFIXES = ((1.0, "kg m"), (1e-3, "g m"), (1e-6, "g mm"), (1e-9, "mg mm"))


def moment(largest: float) -> tuple[float, str]:
    """Factor and unit in which a static moment reads well."""
    return readable(largest, _PREFIXES)


def plot_corrections(result: BalancingReport, path: Path | None) -> Path | Drawing:
    """One polar diagram a plane: what was mounted after every cycle, and where it had to go."""
    count = len(result.planes)
    # a technology that diverges would shrink all else to a point
    shown = [t for t in result.technologies if t.meets] or list(result.technologies)
    needed = result.technologies[0].cycles[0].actual
    vectors = [needed, *(cycle.mounted for t in shown for cycle in t.cycles)]
    largest = float(np.abs(vectors).max())
    factor, unit = moment(largest)
    figure = Figure(figsize=(5.4 * count, 6.4), layout=LAYOUT)
    for i, plane in enumerate(result.planes):
        axes: Any = figure.add_subplot(1, count, i + 1, projection="polar")
        for technology in result.technologies:
            _path(axes, technology, i, factor)
        goal = -needed[i]
        axes.plot(
            np.angle(goal), abs(goal) * factor, "*", color="tab:green", ms=16, zorder=1,
            label="opposite of the actual unbalance",
        )  # fmt: skip
        _around(axes, goal * factor, float(result.at_supports.min()) * factor)
        axes.set_rmax(1.15 * largest * factor)
        axes.set_rlabel_position(float(np.degrees(np.angle(goal))) + 150.0)
        axes.set_title(f"plane {plane}\nradius: mounted correction [{unit}], angle in the rotor")
        axes.grid(alpha=0.4)
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=2, fontsize="small")
    figure.suptitle(f"{result.title}\n{result.grade} at {result.speed:g} rad/s on the machine")
    return save(figure, path)


def _path(axes: Any, technology: Technology, plane: int, factor: float) -> None:
    """Corrections of one technology from nothing to the last, numbered by cycle."""
    mounted = np.array([cycle.mounted[plane] for cycle in technology.cycles])
    colour, marker = _COLOURS[technology.name], _MARKERS[technology.name]
    cycles = len(technology.cycles)
    end = "" if technology.meets else ", grade not met"
    axes.plot(
        np.angle(mounted), np.abs(mounted) * factor, marker=marker, ms=5, lw=1.2, color=colour,
        label=f"{technology.name} coefficients: {cycles} cycles{end}",
    )  # fmt: skip
    for number, vector in list(enumerate(mounted, start=1))[1:4]:
        axes.annotate(
            str(number), (float(np.angle(vector)), float(abs(vector)) * factor),
            textcoords="offset points", xytext=(6, 6), color=colour, fontsize="small",
        )  # fmt: skip


def _around(axes: Any, centre: complex, radius: float) -> None:
    """A circle of what is permissible about a point of the polar diagram."""
    circle = centre + radius * np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 181))
    axes.plot(
        np.angle(circle), np.abs(circle), "--", color="tab:green", lw=1.0,
        label="permissible at a support (the smaller share)",
    )  # fmt: skip
