"""Pictures of a rotor in motion: orbits of its stations, and a run-up."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ..output.plot import Drawing, metres, save
from ..units import brief
from .plot import COLOURS, mark_critical
from .study import Orbits, RunUpMotion

ALONE, RUN = "tab:gray", "tab:blue"
_ACROSS = 3  # panels in a row


def plot_orbits(data: Orbits, path: Path | None) -> Path | Drawing:
    """Orbit of every station, one panel each: steady without balancers, and at a run's end with."""
    count = len(data.stations)
    columns = min(count, _ACROSS)
    rows = -(-count // columns)
    figure = Figure(figsize=(max(6.8, 4.6 * columns), 1.2 + 4.7 * rows), layout="constrained")
    grid = figure.subplots(rows, columns, squeeze=False).ravel()
    factor, unit = metres(
        max(float(np.abs(part).max(initial=0.0)) for part in (data.alone, data.run))
    )
    for j, (axes, name) in enumerate(zip(grid, data.stations, strict=False)):
        peaks = [_orbit(axes, data.alone[:, :, j] * factor, ALONE, "without balancers, steady")]
        if len(data.run):
            label = f"with balancers, last {data.revolutions} revolutions of the run"
            peaks.append(_orbit(axes, data.run[:, :, j] * factor, RUN, label))
        reach = 1.1 * max(peaks)
        axes.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
        axes.set(xlabel=f"x [{unit}]", ylabel=f"y [{unit}]")
        shown = ", ".join(brief(peak, 3) for peak in peaks)
        axes.set_title(f"{name}: 0-peak {shown} {unit}", fontsize="medium")
        axes.grid(alpha=0.3)
    figure.legend(
        *grid[0].get_legend_handles_labels(), loc="outside lower center", ncols=2, fontsize="small"
    )
    for axes in grid[count:]:
        axes.set_visible(False)
    figure.suptitle(
        f"{data.title}\norbits at {data.speed:g} rad/s, seen against the axis of rotation; "
        "the dot marks where each begins"
    )
    return save(figure, path)


def _orbit(axes: Any, orbit: Any, colour: str, label: str) -> float:
    """Draw an orbit; its largest distance from the axis of rotation."""
    x, y = orbit[:, 0], orbit[:, 1]
    axes.plot(x, y, color=colour, lw=1.3, label=label)
    axes.plot(x[0], y[0], "o", color=colour, ms=5)
    return float(np.hypot(x, y).max())


def plot_run_up(data: RunUpMotion, path: Path | None) -> Path | Drawing:
    """Displacement of every station while the speed rises, with and without balancers."""
    parts = [("without balancers", data.run)]
    if data.alone is not None:
        parts = [("with balancers", data.run), ("without balancers", data.alone)]
    figure = Figure(figsize=(9.5, 1.2 + 3.4 * len(parts)), layout="constrained")
    grid = figure.subplots(len(parts), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
    factor, unit = metres(max(float(part.max()) for _, (_, part) in parts))
    for axes, (name, (speeds, part)) in zip(grid, parts, strict=True):
        for j, station in enumerate(data.stations):
            peak = float(part[:, j].max()) * factor
            axes.plot(
                speeds, part[:, j] * factor, color=COLOURS[j % len(COLOURS)], lw=0.8,
                label=f"{station}, largest {peak:.3g} {unit}",
            )  # fmt: skip
        mark_critical(axes, data.critical, "critical speeds of the rotor alone")
        axes.set_title(name, fontsize="medium")
        axes.set_ylabel(f"displacement $\\sqrt{{x^2 + y^2}}$, 0-peak [{unit}]")
        axes.grid(alpha=0.3)
        axes.legend(fontsize="small", loc="upper right")
    grid[-1].set_ylim(bottom=0.0)  # of all panels, now that every line is drawn
    grid[-1].set_xlabel("speed [rad/s]")
    rise = f"{data.run[0][0]:.3g} to {data.run[0][-1]:.4g} rad/s within {data.seconds:.4g} s"
    figure.suptitle(f"{data.title}\nrun-up by co-simulation, {rise}")
    return save(figure, path)
