"""Corrections as masses at the angles at which a rotor can take them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...models.arrays import Complex
from ..errors import UserError

_NOTHING = 1e-9  # of the largest correction: a mass that rounding makes


@dataclass(frozen=True)
class Piece:
    """A mass at an angle [g, rad] in a plane, by its name."""

    plane: str
    mass: float
    angle: float


def split(
    planes: Sequence[str], exact: Complex, angles: Sequence[Sequence[float]]
) -> tuple[Piece, ...]:
    """Corrections as masses at allowed angles [rad]: in each plane at the two on either side.

    Raises:
        UserError: there are lists for another number of planes, or a correction lies between angles
            that are half a turn or more apart.
    """
    named = list(zip(planes, exact.tolist(), strict=True))
    if not angles:
        return tuple(Piece(plane, abs(w), float(np.angle(w))) for plane, w in named)
    if len(angles) not in (1, len(planes)):
        raise UserError(
            f"allowed angles of {len(angles)} planes: must be of all at once, or of each of the "
            f"{len(planes)}"
        )
    lists = list(angles) * (len(planes) if len(angles) == 1 else 1)
    pieces = [p for (plane, w), own in zip(named, lists, strict=True) for p in _two(plane, w, own)]
    least = _NOTHING * float(np.abs(exact).max())
    return tuple(piece for piece in pieces if piece.mass > least)


def _two(plane: str, needed: complex, allowed: Sequence[float]) -> list[Piece]:
    """Masses at the allowed angles on either side of a correction."""
    turn, angle = 2.0 * math.pi, float(np.angle(needed))
    behind = min(allowed, key=lambda a: (angle - a) % turn)
    ahead = min(allowed, key=lambda a: (a - angle) % turn)
    if behind == ahead and abs(math.remainder(angle - behind, turn)) < _NOTHING:
        return [Piece(plane, abs(needed), behind)]
    gap, part = (ahead - behind) % turn, (angle - behind) % turn
    if behind == ahead or not gap < math.pi - _NOTHING:
        raise UserError(
            f"plane {plane}: the correction at {math.degrees(angle) % 360.0:.1f} deg has no two "
            "allowed angles less than half a turn apart on either side: allow more angles"
        )
    sizes = math.sin(gap - part), math.sin(part)
    return [
        Piece(plane, abs(needed) * size / math.sin(gap), place)
        for size, place in zip(sizes, (behind, ahead), strict=True)
    ]
