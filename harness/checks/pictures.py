"""Pictures that belong to a scene's checks, measured from the coupled units."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ...models.papers.window import OPEN_END
from ..master.revolution import Revolution
from ..output.plot import metres, save
from ..scene import Scene
from ..scene.check import LiquidWindowCheck, SommerfeldCheck
from .liquid_window import steady_displacement, window_of
from .rig_picture import plot_rig
from .sommerfeld import run_with, variants_of

CURVE_POINTS = 600
MEASURED_POINTS = 24
WITH, WITHOUT, LIMIT = "tab:blue", "tab:gray", "tab:red"
BELOW, ABOVE = 0.5, 1.1  # how far the picture reaches beyond the window, times its limits


def draw_pictures(scene: Scene, directory: Path, name: str | None = None) -> list[Path]:
    """One picture for every check that has one, in `directory`, called `name` or as the scene.

    Raises:
        UserError: a file cannot be written.
        SimulationError: a run for it cannot be completed.
    """
    return [
        _PICTURES[check.kind](scene, check, directory / f"{name or scene.name}_{check.kind}.png")
        for check in scene.checks
        if check.kind in _PICTURES
    ]


def measured_bending(scene: Scene, speeds: NDArray[np.float64]) -> NDArray[np.float64]:
    """Steady bending of the coupled units at (k,) speeds [m]."""
    with Revolution(scene, separate=True) as units:
        return np.array([abs(steady_displacement(units, float(speed))) for speed in speeds])


def plot_liquid_window(scene: Scene, check: LiquidWindowCheck, path: Path) -> Path:
    """Bending against speed, with and without the balancer; the window shaded.

    Lines are the theory of Dubovik 2006 (6), points the co-simulation.
    """
    window = window_of(scene)
    lower, upper, gap = window.lower, window.upper, window.liquid.gap
    limits = [limit for limit in (lower, upper) if limit is not None]
    start = BELOW * min(limits)
    end = ABOVE * max(limits) if upper is not None else check.up_to or OPEN_END * lower
    speeds = np.linspace(start, end, CURVE_POINTS)
    points = np.sort([*np.linspace(start, end, MEASURED_POINTS), *limits])
    bending = np.asarray(window.bending(speeds))
    figure = Figure(figsize=(9.0, 5.5), layout="constrained")
    axes = figure.subplots()
    factor, unit = metres(max(gap, float(np.median(bending))))
    for variant, curve, colour, name in (
        (scene, bending, WITH, "with liquid"),
        (scene.without_balancers(), window.bending_without(speeds), WITHOUT, "without"),
    ):
        measured = measured_bending(variant, points) * factor
        axes.plot(speeds, curve * factor, color=colour, label=f"{name}, theory (6)")
        axes.plot(points, measured, "o", color=colour, ms=4, label=f"{name}, measured")
    axes.axvline(lower, color="tab:green", ls="--", label=f"$w_*$ = {lower:.5g} rad/s")
    if upper is not None:
        axes.axvline(upper, color=LIMIT, ls="--", label=f"$w^*$ = {upper:.5g} rad/s")
    if upper is None or upper > lower:
        note = "window" if upper is not None else "window, no upper limit"
        axes.axvspan(lower, upper or end, color="tab:green", alpha=0.12, label=note)
    else:
        axes.plot([], [], " ", label="window empty: $w^* \\leq w_*$")
    axes.axhline(gap * factor, color="black", ls=":", label=f"gap {gap * factor:.4g} {unit}")
    touching = bending > gap
    if touching.any():
        axes.fill_between(
            speeds,
            0.0,
            1.0,
            where=touching,
            transform=axes.get_xaxis_transform(),
            facecolor="none",
            edgecolor=LIMIT,
            hatch="//",
            alpha=0.35,
            label="float touches the wall: model not valid",
        )
    axes.set(yscale="log", xlim=(start, end))
    axes.yaxis.set_major_formatter("{x:g}")
    axes.set(xlabel="speed [rad/s]", ylabel=f"steady bending, 0-peak [{unit}]")
    axes.grid(which="both", alpha=0.25)
    axes.legend(fontsize="small")
    axes.set_title(scene.heading)
    return save(figure, path)


def plot_sommerfeld(scene: Scene, check: SommerfeldCheck, path: Path) -> Path:
    """Speed against time for motors below and above the limit, and what they have to overcome.

    Right: the torque that keeps a speed, closed form, and the motors' lines.
    """
    figure = Figure(figsize=(11.0, 5.0), layout="constrained")
    course, torques = figure.subplots(1, 2)
    for (name, variant, resonance), colour in zip(
        variants_of(scene), (WITHOUT, WITH), strict=False
    ):
        limit, peak = resonance.limit()
        speeds = np.linspace(0.8 * peak, min(1.3 * peak, resonance.top), CURVE_POINTS)
        torques.plot(speeds, resonance.resistance(speeds), color=colour, label=f"{name}: needed")
        for sign, line in ((-1.0, "-"), (1.0, "--")):
            share = 1.0 + sign * check.within
            result, _ = run_with(variant, share * limit)
            label = f"{name}, {share:g} of {limit:.4g} N m"
            course.plot(result.time, result["motor.speed"], line, color=colour, label=label)
        torques.plot(speeds, limit * (1.0 - speeds / resonance.top), ":", color=colour,
                     label=f"{name}: motor at the limit")  # fmt: skip
    course.set(xlabel="time [s]", ylabel="speed [rad/s]")
    torques.set(xlabel="speed [rad/s]", ylabel="torque [N m]")
    for axes in (course, torques):
        axes.grid(alpha=0.25)
        axes.legend(fontsize="small")
    figure.suptitle(scene.heading)
    return save(figure, path)


_PICTURES: dict[str, Callable[[Scene, Any, Path], Path]] = {
    "liquid_window": plot_liquid_window,
    "rig": plot_rig,
    "sommerfeld": plot_sommerfeld,
}
