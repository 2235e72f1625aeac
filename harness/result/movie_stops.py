"""Stops of a rotor in its movie: the way across each one, its gap, and where it is touched.

They are seen along the axis from axes that do not turn, in true size.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from ...models.arrays import Array, Complex
from ..master.names import displacements
from ..output.picture import GREY, colour
from ..output.plot import metres
from .motion import Motion
from .stop_panel import motions_across

TRAIL = np.linspace(-1.0, 0.0, 41)  # revolutions: the way that is shown
ROOM = 1.25  # of the gap, or of the way where it is larger: half of the picture
_TOUCHED = colour(2)
_TURN = np.linspace(0.0, math.tau, 181)


@dataclass(frozen=True, eq=False)
class StopView:
    """A stop as the frames show it.

    Attributes:
        label: what it is, and where.
        kind: "ring", or "x" or "y" of a pair of stops along one axis.
        gap: [m].
        trail: (F, t) displacement across it over the last revolution [m].
    """

    label: str
    kind: str
    gap: float
    trail: Complex

    @property
    def touched(self) -> NDArray[np.bool_]:
        """Whether it is touched in every frame (F,)."""
        return np.abs(self.trail[:, -1]) > self.gap


def stop_views(motion: Motion, times: Array) -> list[StopView]:
    """Every stop of the rotor at the times (F,)."""
    scene = motion.scene
    if not scene.rotor.stops:
        return []
    names = displacements(len(scene.rotor.points))
    angle = np.interp(times, motion.time, motion.angle)
    past = angle[:, None] + math.tau * TRAIL
    found = []
    ways = motions_across(scene, {name: motion.recorded[name] for name in names})
    for stop, (x, y) in zip(scene.rotor.stops, ways, strict=True):
        # straight between records in the rotor, where most of it is slow
        slow = (x + 1j * y) * np.exp(-1j * motion.angle)
        trail = np.interp(past, motion.angle, slow) * np.exp(1j * past)
        if stop.kind != "ring":
            trail = trail.real if stop.kind == "x" else 1j * trail.imag
        found.append(StopView(stop.called, stop.kind, stop.gap, trail.astype(complex)))
    return found


def draw_stop(canvas: Any, view: StopView) -> Callable[[int], None]:
    """Draw a stop; returns what moves it to a frame."""
    reach = ROOM * max(view.gap, float(np.abs(view.trail).max()))
    factor, unit = metres(view.gap)
    canvas.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal", xticks=[], yticks=[])
    canvas.set_title(f"{view.label}\ngap {factor * view.gap:.3g} {unit}", fontsize="small")
    walls = _walls(canvas, view)
    canvas.plot(0.0, 0.0, "+", color=GREY, ms=9)
    (trail,) = canvas.plot([], [], color=colour(1), lw=1.0)
    (centre,) = canvas.plot([], [], "o", color=colour(1), ms=6)
    word = canvas.text(0.0, -0.93 * reach, "", fontsize="small", ha="center", color=_TOUCHED)
    touched = view.touched

    def move(frame: int) -> None:
        past = view.trail[frame]
        trail.set_data(past.real, past.imag)
        centre.set_data([past[-1].real], [past[-1].imag])
        touches = bool(touched[frame])
        for wall in walls:
            wall.set(color=_TOUCHED if touches else "black", linewidth=3.0 if touches else 1.6)
        word.set_text("touched" if touches else "")

    return move


def _walls(canvas: Any, view: StopView) -> list[Any]:
    if view.kind == "ring":
        return cast("list[Any]", canvas.plot(view.gap * np.cos(_TURN), view.gap * np.sin(_TURN)))
    line = canvas.axvline if view.kind == "x" else canvas.axhline
    return [line(-view.gap), line(view.gap)]
