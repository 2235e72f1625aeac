"""Pictures that a scene's run cannot give are refused before it."""

from __future__ import annotations

from ...scene import Scene
from ..schedule import end_time
from .motion import with_weights
from .orders import SHORTEST, TRACKED, refuse_few
from .settling import first_weights

_WINDOWS = {"waterfall": SHORTEST, "orders": TRACKED, "polar": TRACKED}  # revolutions


def refuse_impossible(scene: Scene, kind: str) -> None:
    """Refuse a picture, by the name of the result's `plot_` that draws it, where the scene tells.

    Raises:
        UserError: what it shows is not in the scene, or the run is too short for it.
    """
    if kind in ("weights", "weights_over_speed"):
        with_weights(scene)
    elif kind == "settling":
        first_weights(scene)
    elif kind in _WINDOWS:
        profile, end = scene.profile(), end_time(scene)
        part = profile.sweep if profile.changes else (0.0, end)
        begin, last = (profile.angle(min(time, end)) for time in part)
        refuse_few(last - begin, _WINDOWS[kind])
