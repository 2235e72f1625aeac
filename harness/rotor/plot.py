"""Pictures of a rotor over its speed: Campbell diagram, unbalance response, run-up."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from ...models.arrays import Array
from ...models.linear.modes import Campbell
from ..master.pictures.over_speed import polar_picture
from ..output.picture import Picture, PlotAxis
from ..output.plot import Drawing, metres, save
from ..units import in_words
from .study import RunUpMotion, UnbalanceResponse

COLOURS = ("tab:blue", "tab:orange", "tab:green", "tab:purple", "tab:brown", "tab:pink")
CRITICAL = "tab:red"
_LINES = {"forward": "-", "backward": "--", "planar": ":"}  # senses of whirl
_STRAIGHT = 1e-6  # |whirl| below it is no whirl, as in the modes


def plot_campbell(data: Campbell, critical: Array, title: str, path: Path | None) -> Path | Drawing:
    """Natural frequencies and damping ratios against speed, forward and backward whirl."""
    figure = Figure(figsize=(9.0, 8.0), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    frequency = np.abs(data.eigenvalues)
    damping = -data.eigenvalues.real / np.where(frequency > 0.0, frequency, 1.0)
    for k in range(frequency.shape[1]):
        colour = COLOURS[k % len(COLOURS)]
        _by_whirl(above, data.speeds, frequency[:, k], data.whirl[:, k], colour)
        _by_whirl(below, data.speeds, damping[:, k], data.whirl[:, k], colour)
    for order, line in ((1, "-"), (2, "-.")):
        above.plot(data.speeds, order * data.speeds, line, color="gray", lw=1.0)
    for number, speed in enumerate(critical):
        above.plot(speed, speed, "o", color=CRITICAL, ms=7, mfc="none", mew=1.8)
        # neighbours may be close: one label below, the next above
        where, side = ((8, -12), "left") if number % 2 == 0 else ((-8, 6), "right")
        above.annotate(
            in_words(f"{speed:.4g} rad/s"), (speed, speed), textcoords="offset points",
            xytext=where, ha=side, color=CRITICAL, fontsize="small",
        )  # fmt: skip
    senses = [_sense(whirl) for whirl in data.whirl.T]
    _campbell_legend(above, np.unique(senses))
    above.set_ylim(0.0, _top(frequency, data.speeds))
    above.set_ylabel("natural frequency $|\\lambda|$ [rad/s]")
    below.axhline(0.0, color="black", lw=0.8)
    below.set_ylabel("damping ratio [1]\n(negative: unstable)")
    below.set_xlabel("speed [rad/s]")
    below.set_xlim(0.0, float(data.speeds[-1]))
    for axes in (above, below):
        axes.grid(alpha=0.3)
    above.set_title(f"{title}\nrotor without balancers")
    return save(figure, path)


def _top(frequency: Array, speeds: Array) -> float:
    """Where the frequency axis ends: modes far above the speeds would press the rest together."""
    low = frequency[frequency <= 1.3 * speeds[-1]]
    return 1.08 * max(float(speeds[-1]), float(low.max(initial=0.0)))


def _by_whirl(axes: Any, x: Array, y: Array, whirl: Array, colour: str) -> None:
    """One mode, its line telling the sense of its whirl at each speed."""
    sense = _sense(whirl)
    for value, line in zip((1, -1, 0), _LINES.values(), strict=True):
        inside = sense == value
        # one more point on, so that a change of sense leaves no gap
        shown = inside | np.concatenate([[False], inside[:-1]])
        if inside.any():
            axes.plot(x, np.where(shown, y, np.nan), line, color=colour, lw=1.5)


def _sense(whirl: Array) -> Array:
    """Of each whirl: 1 forward, -1 backward, 0 planar."""
    return np.where(np.abs(whirl) < _STRAIGHT, 0, np.sign(whirl))


def _campbell_legend(axes: Any, senses: Array) -> None:
    lines = [
        Line2D([], [], color="black", ls=ls, label=f"{name} motion")
        for value, (name, ls) in zip((1, -1, 0), _LINES.items(), strict=True)
        if value in senses
    ]
    lines.append(Line2D([], [], color="gray", lw=1.0, label="frequency = speed"))
    lines.append(Line2D([], [], color="gray", lw=1.0, ls="-.", label="frequency = 2 x speed"))
    ring = Line2D([], [], color=CRITICAL, ls="", marker="o", mfc="none", mew=1.8)
    ring.set_label("critical speed, undamped")
    axes.legend(handles=[*lines, ring], loc="upper left", fontsize="small")


def plot_response(data: UnbalanceResponse, path: Path | None) -> Path | Drawing:
    """Amplitude and phase of every station against speed, x and y side by side."""
    alike = np.allclose(data.amplitude[:, 1], -1j * data.amplitude[:, 0], rtol=1e-9, atol=0.0)
    axes_shown = (0,) if alike else (0, 1)
    figure = Figure(figsize=(7.5 * len(axes_shown), 8.0), layout="constrained")
    grid = figure.subplots(
        2, len(axes_shown), sharex=True, sharey="row", squeeze=False, height_ratios=(2, 1)
    )
    factor, unit = metres(float(np.abs(data.amplitude[:, list(axes_shown)]).max()))
    for column, along in enumerate(axes_shown):
        above, below = grid[:, column]
        _response_lines(above, below, data, along, factor)
        for axes in (above, below):
            mark_critical(axes, data.critical, "critical speeds")
            axes.grid(which="both", alpha=0.25)
        name = "x and y alike, y a quarter turn later" if alike else f"along {'xy'[along]}"
        above.set_title(name)
        above.set_yscale("log")
        below.set_xlabel("speed [rad/s]")
        below.set_yticks(range(-180, 181, 90))
        below.set_xlim(0.0, float(data.speeds[-1]))
    grid[0, 0].set_ylabel(f"amplitude, 0-peak [{unit}]")
    grid[1, 0].set_ylabel("phase to the rotor's angle [deg]")
    grid[0, 0].legend(fontsize="small")
    figure.suptitle(f"{data.title}\nunbalance response of the rotor without balancers")
    return save(figure, path)


def polar_response(data: UnbalanceResponse) -> Picture:
    """The same as one curve a station (Nyquist), by the equations."""
    title = f"{data.title}\nunbalance response of the rotor without balancers"
    axis = PlotAxis("speed", "rad/s")
    return polar_picture(title, data.speeds, axis, data.amplitude, data.stations)


def _response_lines(
    above: Any, below: Any, data: UnbalanceResponse, along: int, factor: float
) -> None:
    for j, name in enumerate(data.stations):
        colour = COLOURS[j % len(COLOURS)]
        curve, points = data.amplitude[:, along, j], data.measured[:, along, j]
        above.plot(data.speeds, np.abs(curve) * factor, color=colour, label=f"{name}, equations")
        above.plot(
            data.points, np.abs(points) * factor, "o", ms=4, color=colour,
            label=f"{name}, co-simulated unit",
        )  # fmt: skip
        below.plot(*_unbroken(data.speeds, curve), color=colour)
        below.plot(data.points, np.degrees(np.angle(points)), "o", ms=4, color=colour)


def _unbroken(speeds: Array, curve: NDArray[np.complexfloating]) -> tuple[Array, Array]:
    """Phase in degrees without the lines that jumps from -180 to 180 would draw."""
    phase = np.degrees(np.angle(curve))
    jumps = np.flatnonzero(np.abs(np.diff(phase)) > 180.0) + 1
    return np.insert(speeds, jumps, np.nan), np.insert(phase, jumps, np.nan)


def mark_critical(axes: Any, critical: Array, label: str) -> None:
    """A line at every critical speed, the first one labelled."""
    for number, speed in enumerate(critical):
        axes.axvline(speed, color=CRITICAL, ls="--", lw=0.9, label=None if number else label)


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
