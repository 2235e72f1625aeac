"""What the weights hold at the end of a stretch, and which share of their capacity that is."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ....models.arrays import Array
from ...scene import Scene
from ...scene.balancer import WeightBalancer
from ...scene.grade import moments

TURN_POINTS = 96  # at which the mean over one revolution is taken


def held_at_end(
    scene: Scene, signals: Mapping[str, Array], angle: Array, *, steady: bool
) -> dict[str, float] | None:
    """What the weights hold, by its signals [kg m]; None where it is not known.

    Weights that gravity swings once per revolution hold their mean: what swings with the
    revolution shakes at 0 and twice the rotor's frequency.  While the speed changes it is that of
    the last moment.

    Args:
        signals: (T,) each, by name, up to the end of the stretch.
        angle: of the rotor (T,) [rad].
        steady: whether the speed stays.
    """
    names = moments(scene)
    if names is None or any(name not in signals for name in names):
        return None
    whole = bool(angle[-1] - angle[0] > math.tau)
    if not (scene.operation.gravity and steady and whole):
        return {name: float(signals[name][-1]) for name in names}
    turn = angle[-1] - math.tau * np.linspace(0.0, 1.0, TURN_POINTS, endpoint=False)
    return {name: float(np.interp(turn, angle, signals[name]).mean()) for name in names}


def shares_used(scene: Scene, held: Mapping[str, float]) -> tuple[tuple[str, float, float], ...]:
    """Of each balancer: share of its capacity, and that; without the mass of a track off centre."""
    used = []
    for one in scene.balancer:
        assert isinstance(one, WeightBalancer)
        moment = complex(*(held[f"{one.label}.moment_{axis}"] for axis in ("xi", "eta")))
        about_track = abs(moment - one.device.added_mass * one.offset)
        used.append((one.label, about_track / one.capacity, one.capacity))
    return tuple(used)
