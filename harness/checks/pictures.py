"""Pictures that belong to a scene's checks, co-simulated by the coupled units."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...models.papers.window import OPEN_END
from ..output.picture import GREY, Line, Panel, Picture, PlotAxis, Style, colour
from ..output.plot import metres
from ..scene import Scene
from ..stability.revolution import Revolution
from .liquid_window import steady_displacement, window_of
from .rig_picture import plot_rig
from .sommerfeld import WITHIN, run_with, variants_of

CURVE_POINTS = 600
MEASURED_POINTS = 24
WRONG, BLACK = "#D62728", "#000000"
BELOW, ABOVE = 0.5, 1.1  # how far the picture reaches beyond the window, times its limits


def draw_pictures(scene: Scene, directory: Path, name: str | None = None) -> list[Path]:
    """One picture for every check that has one, in `directory`, called `name` or as the scene.

    Raises:
        UserError: a file cannot be written.
        SimulationError: a run for it cannot be completed.
    """
    return [
        _PICTURES[check.kind](scene).save(directory / f"{name or scene.name}_{check.kind}.png")
        for check in scene.checks
        if check.kind in _PICTURES
    ]


def cosimulated_bending(scene: Scene, speeds: NDArray[np.float64]) -> NDArray[np.float64]:
    """Steady bending of the coupled units at (k,) speeds [m]."""
    with Revolution(scene, separate=True) as units:
        return np.array([abs(steady_displacement(units, float(speed))) for speed in speeds])


def plot_liquid_window(scene: Scene) -> Picture:
    """Bending against speed, with and without the balancer, and the limits of the window.

    Lines are the theory of Dubovik 2006 (6), points the co-simulation.
    """
    window = window_of(scene)
    lower, upper, gap = window.lower, window.upper, window.liquid.gap
    limits = {"lower limit": lower}
    if upper is not None:
        limits["upper limit"] = upper
    end = OPEN_END * lower if upper is None else ABOVE * max(limits.values())
    speeds = np.linspace(BELOW * min(limits.values()), end, CURVE_POINTS)
    points = np.sort([*np.linspace(speeds[0], end, MEASURED_POINTS), *limits.values()])
    bending, without = window.bending(speeds), window.bending_without(speeds)
    factor, unit = metres(max(gap, float(np.median(bending))))
    lines = []
    for number, (variant, curve, name) in enumerate(
        ((scene, bending, "with liquid"), (scene.without_balancers(), without, "without"))
    ):
        lines.append(Line((speeds, curve * factor), f"{name}, theory (6)", colour(number)))
        measured = cosimulated_bending(variant, points) * factor
        lines.append(Line((points, measured), f"{name}, co-simulated", colour(number), "marks"))
    low, high = (factor * float(size) for size in (min(bending), max(*bending, *without, gap)))
    for name, speed in limits.items():
        edge = np.array([speed, speed]), np.array([low, high])
        lines.append(Line(edge, f"{name}, {speed:.5g} rad/s", GREY, "dashed"))
    state = "from the lower limit on" if upper is None else "from the lower to the upper limit"
    flat = np.full_like(speeds, gap * factor)
    lines.append(Line((speeds, flat), f"gap {gap * factor:.4g} {unit}", BLACK, "dotted"))
    touching = np.where(bending > gap, bending * factor, np.nan)
    if np.isfinite(touching).any():
        label = "float touches the wall: model not valid"
        lines.append(Line((speeds, touching), label, WRONG, "dotted", 3.0))
    axes = PlotAxis("speed", "rad/s"), PlotAxis("steady bending, 0-peak", unit, log=True)
    title = f"{scene.heading}\nwindow: {'empty' if window.empty else state}"
    return Picture(title, [Panel(axes, lines)], height=4.6)


def plot_sommerfeld(scene: Scene) -> Picture:
    """Speed against time for motors below and above the limit, and what they have to overcome.

    Right: the torque that keeps a speed, closed form, and the motors' lines.
    """
    course, torques = [], []
    for number, (name, variant, resonance) in enumerate(variants_of(scene)):
        limit, peak = resonance.limit()
        speeds = np.linspace(0.8 * peak, min(1.3 * peak, resonance.top), CURVE_POINTS)
        needed = speeds, resonance.resistance(speeds)
        torques.append(Line(needed, f"{name}: needed", colour(number)))
        motor = speeds, limit * (1.0 - speeds / resonance.top)
        torques.append(Line(motor, f"{name}: motor at the limit", colour(number), "dotted"))
        for share in (1.0 - WITHIN, 1.0 + WITHIN):
            result, _ = run_with(variant, share * limit)
            label = f"{name}, {share:g} of {limit:.4g} N m"
            style: Style = "solid" if share < 1.0 else "dashed"
            points = result.time, result["motor.speed"]
            course.append(Line(points, label, colour(number), style))
    time, speed, torque = (
        PlotAxis("time", "s"),
        PlotAxis("speed", "rad/s"),
        PlotAxis("torque", "N m"),
    )
    panels = [Panel((time, speed), course), Panel((speed, torque), torques)]
    return Picture(scene.heading, panels, columns=2, height=4.5, width=6.0)


_PICTURES: dict[str, Callable[[Scene], Picture]] = {
    "liquid_window": plot_liquid_window,
    "rig": plot_rig,
    "sommerfeld": plot_sommerfeld,
}
