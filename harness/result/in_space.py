"""Pictures along a shaft: orbits of its stations, and mode shapes with their whirl."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...models.linear.modes import modes
from ..errors import UserError
from ..output.picture import GREY, Line, Panel, Picture, PlotAxis, colour
from ..output.plot import metres
from ..scene import Scene
from ..units import si_number
from .motion import Motion, Place, places

_WHIRLS = {"forward": colour(0), "backward": colour(1), "planar": colour(2)}
_PHASES = np.linspace(0.0, 0.9 * math.tau, 91)  # of a mode: the gap shows the sense
_MOST_MODES = 12


def orbits(motion: Motion, revolutions: float = 2.0) -> Picture:
    """Orbits over the last revolutions, along the shaft; the shaft as it is bent at the end."""
    revolutions = si_number(revolutions, "", "revolutions =")
    if not revolutions > 0.0:
        raise UserError(f"revolutions = {revolutions:g}: must be above 0")
    begin = motion.angle[-1] - math.tau * revolutions * (1.0 + 1e-9)
    last = motion.displacement[motion.angle >= begin]
    factor, unit = metres(float(np.hypot(last[:, 0], last[:, 1]).max()))
    along = places(motion.scene)
    rows = np.array([row for _, _, row in along])
    moved = factor * np.einsum("tan,pn->tap", last, rows)
    lines = []
    for j, (z, name, _) in enumerate(along):
        x, y = moved[:, 0, j], moved[:, 1, j]
        label = f"{name}, 0-peak {np.hypot(x, y).max():.3g} {unit}"
        lines.append(Line(_at(z, x, y, along), label, colour(j)))
    title = f"{motion.scene.heading}\norbits over the last {revolutions:g} revolutions"
    lines += _shaft(moved[-1], along)
    panel = _panel(lines, along, unit, float(np.abs(moved).max()))
    return Picture(f"{title}; the marks: where each ends", [panel], height=6.0, width=9.5)


def mode_shapes(scene: Scene, speed: float | None = None) -> Picture:
    """Mode shapes of the rotor without balancers; colours tell the sense of whirl.

    Args:
        speed: [rad/s]; by default the scene's.
    """
    speed = scene.profile().end if speed is None else speed
    eigen = modes(scene.assembly().rotor, speed)
    along = places(scene)
    rows = np.array([row for _, _, row in along])
    panels = []
    for number in range(min(len(eigen.eigenvalues), _MOST_MODES)):
        sense = eigen.directions[number]
        moved = np.real(np.einsum("t,an,pn->tap", np.exp(1j * _PHASES), eigen.shapes[number], rows))
        lines = [
            Line(_at(z, moved[:, 0, j], moved[:, 1, j], along), "", _WHIRLS[sense])
            for j, (z, _, _) in enumerate(along)
        ]
        lines += _shaft(moved[0], along)
        frequency, damping = eigen.natural_frequencies[number], eigen.damping_ratios[number]
        title = f"{number + 1}: {frequency / math.tau:.4g} Hz, damping {damping:.3g}, {sense}"
        panels.append(_panel(lines, along, "", float(np.abs(moved).max()), title))
    title = f"{scene.heading}\nmodes of the rotor alone at {speed:g} rad/s, from the marks onwards"
    return Picture(title, panels, columns=2, height=3.4, width=5.6)


def _at(z: float, x: Any, y: Any, along: list[Place]) -> tuple[Any, ...]:
    """A curve at a place along the shaft; of a disc alone, in its plane."""
    return (np.full_like(x, z), x, y) if len(along) > 1 else (x, y)


def _shaft(moved: Any, along: list[Place]) -> list[Line]:
    """The shaft through its places (2, p), and its axis at rest."""
    z = np.array([place for place, _, _ in along])
    if len(z) == 1:
        return [Line((moved[0], moved[1]), "", "#000000", "marks")]
    still = np.zeros(2)
    return [
        Line((z[[0, -1]], still, still), "", GREY, "dotted"),
        Line((z, moved[0], moved[1]), "", "#000000"),
        Line((z, moved[0], moved[1]), "", "#000000", "marks"),
    ]


def _panel(
    lines: list[Line], along: list[Place], unit: str, reach: float, title: str = ""
) -> Panel:
    limits = (-1.1 * reach, 1.1 * reach) if reach > 0.0 else None
    ticks = None if unit else (-1.0, 0.0, 1.0)
    names = "xy" if unit else ("x, relative", "y, relative")
    across = [PlotAxis(name, unit, ticks, limits=limits) for name in names]
    if len(along) == 1:
        return Panel(tuple(across), lines, title=title, equal=True)
    return Panel((PlotAxis("along the shaft", "m"), *across), lines, title=title, kind="space")
