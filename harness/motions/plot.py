"""Pictures of steady motions: stacked shares over speed, and sweeps with arrows."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from ..capture.captured import captured
from ..output.picture import COLOURS, Picture, PlotAxis
from ..output.plot import Drawing, metres, save
from ..output.ticks import logarithmic
from ..stability.plot import coloured
from ..units import shown_in
from .kinds import Kind

if TYPE_CHECKING:
    from ..scene import Scene
    from .map import MotionsMap
    from .outcome import Motions, Point
    from .sweep import Sweep

_COLOURS = {
    Kind.BALANCED: "#009E73",
    Kind.SYNCHRONOUS: "#56B4E9",
    Kind.TWO_FREQUENCIES: "#CC79A7",
    Kind.IRREGULAR: "#E69F00",
    Kind.UNDECIDED: "#BBBBBB",
    Kind.SLOW_ROTOR: "#777777",
    Kind.FAILED: "#000000",
}
_BEHIND = ("#D55E00", "#B04000", "#F08040", "#8A3000", "#FFB080", "#602000")


def plot_motions(data: Motions, path: Path | None = None) -> Path | Drawing:
    """A panel for every kind of start; lines: release speeds, and limits of balancing (Floquet)."""
    starts = list(dict.fromkeys(point.start for point in data.points))
    names = list(dict.fromkeys(s.motion.name for p in data.points for s in p.shares))
    names.sort(key=lambda name: (name != "balanced", name))
    colours = _colours(data, names)
    unit, factor = shown_in("rad/s")
    figure = Figure(figsize=(9.0, 1.2 + 2.3 * len(starts)), layout="constrained")
    grid = figure.subplots(len(starts), 1, sharex=True, squeeze=False)[:, 0]
    handles = {}
    for axes, start in zip(grid, starts, strict=True):
        points = [p for p in data.points if p.start == start]
        speeds = np.array([p.speed for p in points]) * factor
        width = 0.8 * float(np.diff(speeds).min()) if len(speeds) > 1 else 0.1 * speeds[0]
        bottom = np.zeros(len(points))
        for name in names:
            shares = np.array([_share(p, name) for p in points])
            handles[name] = axes.bar(speeds, 100 * shares, width, 100 * bottom, color=colours[name])
            bottom += shares
        for label, style, at in _lines(data):
            for speed in at:
                line = axes.axvline(speed * factor, color="black", ls=style, lw=1.2)
                handles.setdefault(label, line)
        axes.set(ylabel="% of starts", ylim=(0, 100), title=f"from {start}")
        margin = 0.6 * width
        axes.set_xlim(speeds.min() - margin, speeds.max() + margin)
    grid[-1].set_xlabel(f"speed [{unit}]")
    figure.suptitle(data.title)
    figure.legend(
        list(handles.values()), list(handles), loc="outside lower center", ncols=2, fontsize="small"
    )
    return save(figure, path)


def plot_sweep(data: Sweep, path: Path | None = None) -> Path | Drawing:
    """Vibration over speed up and down, with arrows, and the rotor without balancers."""
    unit, factor = shown_in("rad/s")
    size, length = metres(float(max(np.max(b.vibration) for b in data.branches)))
    figure = Figure(figsize=(9.0, 4.4), layout="constrained")
    axes = figure.subplots()
    for k, branch in enumerate(data.branches):
        x, y = branch.speed * factor, branch.vibration * size
        axes.plot(x, y, color=COLOURS[k], label=branch.name)
        for part in (0.3, 0.55, 0.8):
            at = int(part * (len(x) - 1))
            tip = min(at + 1, len(x) - 1)
            axes.annotate(
                "", (x[tip], y[tip]), (x[at], y[at]),
                arrowprops={"arrowstyle": "-|>", "color": COLOURS[k], "lw": 1.5},
            )  # fmt: skip
        ends = [getattr(one, branch.name).vibration * size for one in data.held]
        if ends:
            label = f"{branch.name}, held until it has settled"
            speeds = [one.speed * factor for one in data.held]
            axes.plot(speeds, ends, "ov"[k], color=COLOURS[k], mfc="none", label=label)
    x = data.branches[0].speed
    axes.plot(np.sort(x) * factor, data.alone * size, "--", color="0.4", label="without balancers")
    axes.set(xlabel=f"speed [{unit}]", ylabel=f"vibration [{length}]")
    logarithmic(axes.yaxis)
    axes.set_title(data.title)
    axes.legend()
    return save(figure, path)


def plot_motions_map(data: MotionsMap, path: Path | None) -> Path | Picture:
    """Share of run-ups that balances as colour."""
    quantity = PlotAxis("run-ups that balance", "%", limits=(0.0, 100.0))
    return coloured(data, path, 100.0 * data.share, quantity)


def _share(point: Point, name: str) -> float:
    return sum(s.share for s in point.shares if s.motion.name == name)


def _colours(data: Motions, names: list[str]) -> dict[str, str]:
    kinds = {s.motion.name: s.motion.kind for p in data.points for s in p.shares}
    behind = [name for name in names if kinds[name] is Kind.BEHIND]
    found = {name: _BEHIND[k % len(_BEHIND)] for k, name in enumerate(behind)}
    return {name: found.get(name) or _COLOURS[kinds[name]] for name in names}


def _lines(data: Motions) -> list[tuple[str, str, list[float]]]:
    """Release speeds by the closed form and limits by Floquet, within the speeds."""
    speeds = [p.speed for p in data.points]
    low, high = min(speeds), max(speeds)
    found = captured(data.scene, high).found
    speeds_of = ([m.release_speed for m in one.motions] for one in found.natural)
    released = [float(np.nanmax(s)) for s in speeds_of if not np.isnan(s).all()]
    lines = [("release speed (closed form)", ":", [w for w in released if low <= w <= high])]
    if low < high:
        limits = boundaries(data.scene, low, high)
        lines.append(("limit of balancing (Floquet)", "--", limits))
    return lines


def boundaries(scene: Scene, low: float, high: float) -> list[float]:
    """Limits of balancing by Floquet; none where the weights cannot balance."""
    from ...models.boundaries import balancing_boundaries
    from ...models.linear.balanced import CannotBalance

    try:
        return [c.speed for c in balancing_boundaries(scene.assembly(), low, high)]
    except (CannotBalance, ArithmeticError, ValueError):
        return []
