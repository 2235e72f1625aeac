"""How large forces can be in a scene: what is left far below that is rounding, or cancellation."""

from __future__ import annotations

import math

import numpy as np

from ...models.weights import Weights
from ..scene import Scene

STILL = 1e-9  # of the largest motion there can be: a rotor that moves less stands still


def largest_force(scene: Scene) -> float:
    """What the balancers can pull at most [N], by the weights, the unbalance and the start values.

    Weights that turn pull by their own motion; every balancer also answers the rotor's
    acceleration, which the same pull, the unbalance and displaced supports give it.
    """
    assembly, profile, start = scene.assembly(), scene.profile(), scene.run.initial
    rotor = assembly.rotor.at_top
    speed, spin_up = profile.top, profile.steepest
    own = carried = 0.0
    for mounted in assembly.balancers:
        device = mounted.device
        carried += device.added_mass
        if isinstance(device, Weights):
            rate = speed + max(map(abs, mounted.speeds), default=0.0)
            own += device.point_capacity * (rate * rate + spin_up)
    pushed = assembly.largest_unbalance * (speed * speed + spin_up)
    out, motion = math.hypot(start.x, start.y), math.hypot(start.vx, start.vy)
    pushed += out * _largest_row(rotor.stiffness_x, rotor.stiffness_y)
    pushed += motion * _largest_row(rotor.damping_x, rotor.damping_y)
    mass = float(rotor.mass.sum())
    pushed += mass * abs(rotor.gravity)
    return own + carried * (own + pushed) / mass


def least_motion(scene: Scene) -> dict[str, float]:
    """By unit of measurement, values below which a signal is cancellation, not motion."""
    profile, mass = scene.profile(), float(scene.assembly().loaded_rotor.mass.sum())
    speed, acceleration = profile.top, STILL * largest_force(scene) / mass
    least = {"m": acceleration / speed**2, "m/s": acceleration / speed, "m/s^2": acceleration}
    # an angle's error counts in rad
    return {**least, "kg m": STILL * scene.assembly().capacity, "rad": 1.0, "rad/s": STILL * speed}


def _largest_row(*matrices: np.ndarray) -> float:
    """Largest force on a station where all move alike by one."""
    return max(float(np.abs(matrix.sum(axis=1)).max()) for matrix in matrices)
