"""Where a run begins: `run.initial`, and the steady motion of a machine that nothing holds."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...models.arrays import Array
from ...models.assembly import Start
from ...models.supports import SHAFT

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


def begins_apart(scene: Scene) -> bool:
    """Whether some points of the rotor begin otherwise than `run.initial` says of every station."""
    initial = scene.run.initial
    moves = initial.x or initial.y or initial.vx or initial.vy
    return scene.rotor.is_free or bool(moves and scene.assembly().rotor.inner)


def motion_of_points(scene: Scene) -> Array:
    """x, y, vx and vy (4, n) of the rotor's points at time 0, without the sag [m, m/s].

    Rubber begins relaxed: its inner displacements, the last points, stand where it is and do not
    move; those of the shaft turn with it.
    """
    initial, rotor = scene.run.initial, scene.assembly().rotor
    own = np.array([initial.x, initial.y, initial.vx, initial.vy])[:, None]
    found = np.repeat(own, rotor.stations, axis=1)
    found[2:, rotor.stations - rotor.inner :] = 0.0
    if turning := sum(len(one.rows) // 2 for one in rotor.supports if one.name == SHAFT):
        speed = scene.operation.start_speed
        found[2:, -turning:] = -speed * found[1, -turning:], speed * found[0, -turning:]
    return found + free_motion(scene)[:, : rotor.stations]


def motion_at_start(scene: Scene) -> Start:
    """Motion of the rotor at time 0, for the models."""
    initial = scene.run.initial
    if not begins_apart(scene):
        return initial.motion()
    x, y, vx, vy = motion_of_points(scene).tolist()
    return Start(x, y, vx, vy, initial.angle)
