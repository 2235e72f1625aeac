"""Where a run begins: `run.initial`, and the steady motion of a machine that nothing holds."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...models.arrays import Array
from ...models.assembly import Start

if TYPE_CHECKING:
    from .scene import Scene


def free_motion(scene: Scene) -> Array:
    """x, y, vx and vy (4, n) by which a free machine moves steadily at the start [m, m/s].

    From rest it would drift for ever, at i U w/M.  Zero where something holds it.
    """
    rotor, speed = scene.assembly().loaded_rotor, scene.operation.start_speed
    if not speed or not scene.rotor.is_free:
        return np.zeros((4, rotor.stations))
    from ...models.papers.influence import influence  # loads SciPy, which few runs need

    motion = influence(rotor, speed, np.eye(rotor.stations)) @ rotor.unbalance
    turned = motion * np.exp(1j * scene.run.initial.angle)
    return np.concatenate([turned.real, (1j * speed * turned).real])


def motion_at_start(scene: Scene) -> Start:
    """Motion of the rotor at time 0, for the models."""
    initial = scene.run.initial
    if not scene.rotor.is_free:
        return initial.motion()
    own = np.array([initial.x, initial.y, initial.vx, initial.vy])[:, None]
    x, y, vx, vy = (own + free_motion(scene)).tolist()
    return Start(x, y, vx, vy, initial.angle)
