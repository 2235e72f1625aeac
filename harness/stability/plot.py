"""Pictures of maps: growth rates with boundaries; what runs leave; what is proved."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.colors import ListedColormap, SymLogNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import NullLocator

from ..output.panels import COLOURS
from ..output.picture import Field, Line, Panel, Picture, PlotAxis
from ..output.plot import Drawing, metres, save
from ..output.ticks import logarithmic
from .axis import Map
from .map import StabilityMap
from .run_map import RunMap
from .speeds import Speeds

if TYPE_CHECKING:
    from .proved_map import ProvedMap


DECADES = 3.0  # of growth rates shown on either side of zero
FLOOR = 1e-5  # of the largest residual amplitude: below is rounding and transients that differ
_LABEL = 0.09  # of a bar's length: width of a number on it


def plot_map(data: StabilityMap, path: Path | None) -> Path | Drawing:
    """Blue where deviations decay, red where they grow."""
    figure, axes = _framed(data)
    x, y = data.x.values, data.y.values
    finite = np.abs(data.growth[np.isfinite(data.growth)])
    largest = float(np.quantile(finite, 0.98)) if finite.size else 0.0
    largest = largest or float(finite.max(initial=0.0)) or 1.0  # undamped machines neither grow
    # the tail is cut so that it cannot wash out the rest
    norm = SymLogNorm(largest / 10.0**DECADES, vmin=-largest, vmax=largest, base=10.0)
    colours = axes.pcolormesh(
        x, y, np.ma.masked_invalid(data.growth), cmap="RdBu_r", norm=norm,
        shading="nearest", rasterized=True,  # between colours is no growth: white stars
    )  # fmt: skip
    first = 10.0 ** np.floor(np.log10(largest))
    ends = [first / 10.0**k for k in range(int(DECADES))]
    bar = figure.colorbar(colours, ax=axes, extend="both", pad=0.015)
    bar.set_ticks([*(-end for end in ends), 0.0, *ends[::-1]])
    bar.ax.yaxis.set_major_formatter("{x:g}")
    bar.ax.yaxis.set_minor_locator(NullLocator())
    word = "balanced" if data.scene.assembly().weights else "stable"
    bar.set_label(f"largest growth rate [1/s]: below 0 {word}, above 0 not")
    handles: list[Artist] = [_boundary(axes, x, y, data.growth, "black", "-", "Floquet boundary")]
    if data.undecided.any():
        shown = np.where(data.undecided, 1.0, np.nan)
        axes.pcolormesh(x, y, shown, cmap=ListedColormap(["0.85"]), shading="nearest")
        handles.append(Patch(facecolor="0.85", label="undecided: growth below its error"))
    if data.criterion is not None:
        handles.append(
            _boundary(axes, x, y, data.criterion, "#e0a000", "--", "criterion boundary (a rule)")
        )
    if np.isnan(data.growth).any():
        axes.set_facecolor("0.85")
        axes.patch.set_hatch("///")
        axes.patch.set_edgecolor("0.6")
        handles.append(
            Patch(facecolor="0.85", edgecolor="0.6", hatch="///", label="weights cannot balance")
        )
    axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
    figure.legend(
        handles=handles, loc="outside lower center", ncols=min(3, len(handles)), fontsize="small"
    )
    return save(figure, path)


def plot_run_map(data: RunMap, path: Path | None) -> Path | Picture:
    """Residual amplitude as colour; dots where it still changes, grey where a run failed."""
    factor, unit = metres(float(np.nan_to_num(data.residual).max()))
    shown, limits, name = data.residual * factor, (0.0, 1.0), "residual amplitude"
    top = float(np.nan_to_num(shown).max())
    if top > 0.0:
        low = max(float(np.nanmin(shown)), FLOOR * top)
        if np.nanmin(shown) < low:
            name += f", darkest: at most {low:.2g}"
        # a colour needs a span, also where all runs leave the same
        limits = min(low, 0.99 * top), top
        shown = np.fmax(shown, low, where=np.isfinite(shown), out=np.full_like(shown, np.nan))
    amplitude = PlotAxis(name, unit, log=top > 0.0, limits=limits)
    j, i = np.nonzero(data.settled == 0.0)
    dots = Line((data.x.values[i], data.y.values[j]), "amplitude still changes", "#000000", "dots")
    return coloured(data, path, shown, amplitude, [dots] if len(i) else [])


def coloured(
    data: Map,
    path: Path | None,
    values: np.ndarray,
    quantity: PlotAxis,
    lines: Sequence[Line] = (),
) -> Path | Picture:
    """A grid of values as colours over both axes of a map."""
    x, y = (
        PlotAxis(label, log=axis.log)
        for label, axis in zip(data.labels, (data.x, data.y), strict=True)
    )
    field = Field(data.x.values, data.y.values, values, quantity)
    panel = Panel((x, y), list(lines), field)
    picture = Picture(data.title, [panel], height=4.6, width=8.6)
    return picture if path is None else picture.save(path)


def plot_proved_map(data: ProvedMap, path: Path | None) -> Path | Drawing:
    """Three colours: stable, unstable, undecided."""
    from .proved_map import STATES, edges

    figure, axes = _framed(data)
    colours = ("0.85", "tab:blue", "tab:red")
    look: Any = {"cmap": ListedColormap(colours), "vmin": 0, "vmax": 2, "rasterized": True}
    axes.pcolormesh(edges(data.x), edges(data.y), data.parts, **look)
    handles = [Patch(color=c, label=state) for c, state in zip(colours, STATES, strict=True)]
    figure.legend(handles=handles, loc="outside lower center", ncols=3, fontsize="small")
    return save(figure, path)


def plot_speeds(data: Speeds, path: Path | None) -> Path | Drawing:
    """A bar for every method: green where it finds balancing stable, orange where it does not."""
    figure = Figure(figsize=(8.6, 1.6 + 0.5 * len(data.methods)), layout="constrained")
    axes = figure.subplots()
    colours = {"stable": COLOURS[2], "unstable": COLOURS[1]}
    for row, (method, found) in enumerate(data.methods.items()):
        ends = [data.range[0], *(crossing.speed for crossing in found), data.range[1]]
        sides = [data.lowest[method], *(crossing.above for crossing in found)]
        for side, low, high in zip(sides, ends, ends[1:], strict=False):
            axes.barh(row, high - low, left=low, height=0.6, color=colours.get(side, "0.8"))
        for speed in _apart(ends[1:-1], data.range):
            axes.annotate(f"{speed:.5g}", (speed, row + 0.32), ha="center", fontsize="small")
    names = [f"{name} (a rule)" if name == "criterion" else name for name in data.methods]
    axes.set_yticks(range(len(data.methods)), names)
    axes.set(xlabel="speed [rad/s]", xlim=data.range, ylim=(-0.5, len(data.methods) - 0.3))
    unknown = ", not decided (grey)" if data.undecided else ""
    axes.set_title(f"{data.scene}: balancing is stable (green), unstable (orange){unknown}")
    return save(figure, path)


def _apart(speeds: Sequence[float], span: tuple[float, float]) -> list[float]:
    """Those, from below, that leave room for the number of the one before."""
    shown: list[float] = []
    for speed in speeds:
        if not shown or speed - shown[-1] > _LABEL * (span[1] - span[0]):
            shown.append(speed)
    return shown


def _framed(data: Map) -> tuple[Figure, Any]:
    """A figure, and axes with the names and scales of a map's."""
    figure = Figure(figsize=(8.6, 5.6), layout="constrained")
    axes = figure.subplots()
    for axis, given in ((axes.xaxis, data.x), (axes.yaxis, data.y)):
        if given.log:
            logarithmic(axis)
    axes.set(xlabel=data.labels[0], ylabel=data.labels[1], title=data.title)
    return figure, axes


def _boundary(
    axes: Any, x: np.ndarray, y: np.ndarray, values: np.ndarray, colour: str, style: str, name: str
) -> Line2D:
    """The line on which `values` change sign."""
    shown = np.ma.masked_invalid(values)
    if np.ma.min(shown) < 0.0 < np.ma.max(shown):
        axes.contour(x, y, shown, levels=[0.0], colors=colour, linestyles=style, linewidths=1.6)
    return Line2D([], [], color=colour, ls=style, lw=1.6, label=name)
