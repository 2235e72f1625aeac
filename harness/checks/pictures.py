"""Pictures that belong to a scene's checks, measured from the coupled units."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..output.plot import metres, save
from ..scene import Scene
from ..scene.check import LiquidWindowCheck
from ..stability.revolution import Revolution
from .liquid_window import OPEN_END, steady_displacement, window_of

CURVE_POINTS = 600
MEASURED_POINTS = 24
WITH, WITHOUT, LIMIT = "tab:blue", "tab:gray", "tab:red"
BELOW, ABOVE = 0.5, 1.1  # how far the picture reaches beyond the window, times its limits


@dataclass(frozen=True)
class WindowCurves:
    """Bending against speed with and without a liquid balancer.

    Attributes:
        title: of the picture.
        speeds, bending, bending_without: (S,) theory, Dubovik 2006 (6) [rad/s, m].
        points, measured, measured_without: (P,) from the co-simulation [rad/s, m].
        lower: w_* [rad/s].
        upper: w^* [rad/s]; None: no upper limit.
        gap: clearance between float and wall [m].
    """

    title: str
    speeds: NDArray[np.float64]
    bending: NDArray[np.float64]
    bending_without: NDArray[np.float64]
    points: NDArray[np.float64]
    measured: NDArray[np.float64]
    measured_without: NDArray[np.float64]
    lower: float
    upper: float | None
    gap: float


def unique_names(scenes: Sequence[Scene]) -> list[str]:
    """A name for the files of every scene: its own, numbered where others share it."""
    taken: dict[str, list[Path | None]] = {}
    names = []
    for scene in scenes:
        place = scene.path.resolve() if scene.path else None
        places = taken.setdefault(scene.name, [])
        if place not in places:
            places.append(place)
        number = places.index(place) + 1
        names.append(scene.name if number == 1 else f"{scene.name}-{number}")
    return names


def draw_pictures(scene: Scene, directory: Path, name: str | None = None) -> list[Path]:
    """One picture for every check that has one, in `directory`, called `name` or as the scene.

    Raises:
        UserError: a file cannot be written.
        SimulationError: a run for it cannot be completed.
    """
    return [
        plot_liquid_window(
            window_curves(scene, check), directory / f"{name or scene.name}_{check.kind}.png"
        )
        for check in scene.check
        if isinstance(check, LiquidWindowCheck)
    ]


def window_curves(scene: Scene, check: LiquidWindowCheck) -> WindowCurves:
    """Curves of the theory, and points of the coupled units with and without the balancer."""
    window = window_of(scene)
    lower, upper = window.lower, window.upper
    end = ABOVE * max(lower, upper) if upper is not None else check.up_to or OPEN_END * lower
    start = BELOW * (lower if upper is None else min(lower, upper))
    speeds = np.linspace(start, end, CURVE_POINTS)
    limits = [limit for limit in (lower, upper) if limit is not None]
    points = np.sort(np.concatenate([np.linspace(start, end, MEASURED_POINTS), limits]))
    measured = []
    for variant in (scene, scene.without_balancers()):
        with Revolution(variant) as units:
            measured.append([abs(steady_displacement(units, float(speed))) for speed in points])
    return WindowCurves(
        title=scene.heading,
        speeds=speeds,
        bending=np.asarray(window.bending(speeds)),
        bending_without=np.asarray(window.bending_without(speeds)),
        points=points,
        measured=np.array(measured[0]),
        measured_without=np.array(measured[1]),
        lower=lower,
        upper=upper,
        gap=window.liquid.gap,
    )


def plot_liquid_window(data: WindowCurves, path: Path) -> Path:
    """Bending against speed: theory as lines, co-simulation as points, the window shaded.

    Raises:
        UserError: the file cannot be written.
    """
    figure = Figure(figsize=(9.0, 5.5), layout="constrained")
    axes = figure.subplots()
    factor, unit = metres(max(data.gap, float(np.median(data.bending))))
    for curve, points, colour, name in (
        (data.bending, data.measured, WITH, "with liquid"),
        (data.bending_without, data.measured_without, WITHOUT, "without"),
    ):
        axes.plot(data.speeds, curve * factor, color=colour, label=f"{name}, theory (6)")
        axes.plot(data.points, points * factor, "o", color=colour, ms=4, label=f"{name}, measured")
    end = float(data.speeds[-1])
    axes.axvline(data.lower, color="tab:green", ls="--", label=f"$w_*$ = {data.lower:.5g} rad/s")
    if data.upper is not None:
        axes.axvline(data.upper, color=LIMIT, ls="--", label=f"$w^*$ = {data.upper:.5g} rad/s")
    if data.upper is None or data.upper > data.lower:
        note = "window" if data.upper is not None else "window, no upper limit"
        axes.axvspan(data.lower, data.upper or end, color="tab:green", alpha=0.12, label=note)
    else:
        axes.plot([], [], " ", label="window empty: $w^* \\leq w_*$")
    axes.axhline(
        data.gap * factor, color="black", ls=":", label=f"gap {data.gap * factor:.4g} {unit}"
    )
    touching = data.bending > data.gap
    if touching.any():
        axes.fill_between(
            data.speeds,
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
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.set_xlim(float(data.speeds[0]), end)
    axes.set_xlabel("speed [rad/s]")
    axes.set_ylabel(f"steady bending, 0-peak [{unit}]")
    axes.grid(which="both", alpha=0.25)
    axes.legend(fontsize="small")
    axes.set_title(data.title)
    return save(figure, path)
