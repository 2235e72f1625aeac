"""Speeds of a sweep that are held until both ways have settled.

A speed that moves shows weights that balance slowly as it shows weights that do not: only two
settled motions at one speed are a hysteresis.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from ...models.arrays import Array, Indices
from ..capture.captured import captured_or_none
from ..errors import UserError
from .kinds import Kind, Motion, motion_of
from .settle import settle
from .starts import Job, length

DIFFERENT = 1.5  # ratio of vibrations at one speed that differ
WORTH = 0.05  # of the vibration without balancers, which one of both exceeds
_SPEEDS, _HALVINGS = 9, 4  # held at first, and how often the speed between two is held


@dataclass(frozen=True)
class Settled:
    """What a way has come to at a speed: its motion, and the vibration [m]."""

    motion: Motion
    vibration: float


@dataclass(frozen=True)
class Held:
    """A speed that was held.

    Attributes:
        speed: of the rotor [rad/s].
        rising, falling: from below and from above.
        alone: vibration without balancers [m].
    """

    speed: float
    rising: Settled
    falling: Settled
    alone: float

    @property
    def is_settled(self) -> bool:
        """Whether both ways have settled."""
        return Kind.UNDECIDED not in (self.rising.motion.kind, self.falling.motion.kind)

    @property
    def differs(self) -> bool:
        """Whether they have settled to vibrations that differ."""
        one, other, alone = np.array(
            [[self.rising.vibration], [self.falling.vibration], [self.alone]]
        )
        return self.is_settled and bool(differ(one, other, alone)[0])

    def as_json(self) -> dict[str, Any]:
        """Everything."""
        ways = {"rising": self.rising, "falling": self.falling}
        return {
            "speed": self.speed,
            "settled": self.is_settled,
            "differs": self.differs,
            **{
                name: {"motion": way.motion.name, "vibration": way.vibration}
                for name, way in ways.items()
            },
        }


def differ(one: Array, other: Array, alone: Array) -> np.ndarray:
    """Where vibrations (k,) differ that are worth it [m]."""
    most, least = np.maximum(one, other), np.minimum(one, other)
    return np.asarray((most > DIFFERENT * least) & ~(most <= WORTH * alone))


def held_at(sweeping: Job, speed: float, moving: float) -> Settled:
    """Hold a speed that a run, `sweeping` to it, reaches after some seconds.

    Raises:
        UserError: the run fails.
    """
    scene, settled = sweeping.scene, length(sweeping.scene, speed)
    corners = [c for c in scene.operation.profile if c[0] < moving]
    driven = scene.replace({"operation.profile": [*corners, [moving, speed]]})
    whole = replace(sweeping, scene=driven, speed=speed, seconds=moving + settled, settled=settled)
    found, reasons, _ = settle(driven, whole)
    if reasons[0]:
        raise UserError(f"the speed {speed:.4g} rad/s could not be held: {reasons[0]}")
    closed = captured_or_none(driven, speed)
    row = (found.kind[0], found.weights[0], found.frequency[0])
    return Settled(motion_of(*row, closed.found if closed else None), float(found.vibration[0]))


def hold(rows: Indices, at: Callable[[int], Held]) -> tuple[Held, ...]:
    """Some of the rows (k,) at which a sweep differs, and more where both ways begin to agree."""
    if not len(rows):
        return ()
    places = np.unique(np.linspace(0, len(rows) - 1, _SPEEDS).round().astype(int)).tolist()
    found = {place: at(int(rows[place])) for place in places}
    for _ in range(_HALVINGS):
        places = sorted(found)
        for low, high in pairwise(places):
            if found[low].differs != found[high].differs and high - low > 1:
                middle = (low + high) // 2
                found[middle] = at(int(rows[middle]))
    return tuple(found[place] for place in sorted(found))
