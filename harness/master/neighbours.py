"""Neighbouring motions: a scene whose weights start a little elsewhere.

A method resolves angles to `RESOLVED`: bounces that rise less end in contact.  Where collisions
amplify such a difference, or where it decides which of two simultaneous impacts comes first, nobody
knows the motion that a run has computed.  Two neighbours on opposite sides show it.
"""

from __future__ import annotations

import math

from ..scene import Scene
from ..scene.balancer import WeightBalancer

# rad: ten times LOWEST_BOUNCE of the units, for a run has many bounces that end in contact
RESOLVED = 1e-8
GOLDEN = math.pi * (3.0 - math.sqrt(5.0))  # its multiples are spread evenly over a turn


def turned_angles(scene: Scene, turn: float) -> dict[str, list[float]] | None:
    """Start angles of every weight that can collide, turned by another part of `turn` [rad].

    By balancer.  None where no start so near is allowed: weights would overlap.
    """
    found = {}
    for balancer in scene.balancer:
        if isinstance(balancer, WeightBalancer) and balancer.half_angle:
            parts = [math.sin(1.0 + GOLDEN * k) for k in range(balancer.count)]
            pairs = zip(balancer.angles, parts, strict=True)
            angles = [angle + turn * part for angle, part in pairs]
            if balancer.overlapping(angles):
                return None
            found[balancer.label] = angles
    return found


def turned(scene: Scene, turn: float) -> Scene | None:
    """The scene with weights that start at `turned_angles`, or None."""
    angles = turned_angles(scene, turn)
    changes = {f"{name}.angles": each for name, each in (angles or {}).items()}
    return None if angles is None else scene.replace(changes)
