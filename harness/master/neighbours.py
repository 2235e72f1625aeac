"""Neighbouring motions: a scene whose weights start a little elsewhere.

A method resolves angles to `RESOLVED`: bounces that rise less end in contact.  Where collisions
amplify such a difference, or where it decides which of two simultaneous impacts comes first, nobody
knows the motion that a run has computed.  Two neighbours on opposite sides show it.
"""

from __future__ import annotations

import math

from ..errors import UserError
from ..scene import Scene

# rad: ten times LOWEST_BOUNCE of the units, for a run has many bounces that end in contact
RESOLVED = 1e-8
GOLDEN = math.pi * (3.0 - math.sqrt(5.0))  # its multiples are spread evenly over a turn


def turned(scene: Scene, turn: float) -> Scene | None:
    """The scene with every weight that can collide turned by another part of `turn` [rad].

    None where no start so near is allowed: weights would overlap.
    """
    changes = {}
    for mounted in scene.assembly().weights:
        if mounted.half_angle:
            parts = [math.sin(1.0 + GOLDEN * k) for k in range(len(mounted.angles))]
            pairs = zip(mounted.angles, parts, strict=True)
            changes[f"{mounted.name}.angles"] = [angle + turn * part for angle, part in pairs]
    try:
        return scene.replace(changes)
    except UserError:
        return None
