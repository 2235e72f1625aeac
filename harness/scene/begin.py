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


def motion_of_points(scene: Scene) -> Array:
    """x, y, vx and vy (4, n) of the rotor's points at time 0, without the sag [m, m/s].

    Rubber begins relaxed: its inner displacements, the last points, stand where it is and do not
    move.
    """
    initial, rotor = scene.run.initial, scene.assembly().rotor
    own = np.array([initial.x, initial.y, initial.vx, initial.vy])[:, None]
    found = np.repeat(own, rotor.stations, axis=1)
    found[2:, rotor.stations - rotor.inner :] = 0.0
    return found + free_motion(scene)[:, : rotor.stations]


def motion_at_start(scene: Scene) -> Start:
    """Motion of the rotor at time 0, for the models."""
    initial = scene.run.initial
    if not (scene.rotor.is_free or initial.vx or initial.vy):
        return initial.motion()
    x, y, vx, vy = motion_of_points(scene).tolist()
    return Start(x, y, vx, vy, initial.angle)
