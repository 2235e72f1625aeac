"""A motor of limited power: its torque depends on the speed, and what is left over turns the rotor.

    I w' = L(w) + tau

with L the motor's characteristic, tau the torque of all that sits on the shaft, and I the moment of
inertia of all that turns, unbalance included.  L runs in straight lines between points and goes on
beyond the outer ones.  Sommerfeld 1902; Kononenko 1969.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

from .ranges import demand


@dataclass(frozen=True)
class Drive:
    """A motor on the rotor's shaft.

    Attributes:
        inertia: I, of all that turns [kg m^2].
        speeds, torques: points of the characteristic, speeds ascending, two or more
            [rad/s, N m].

    Raises:
        ValueError: a value is not finite or out of its range, or the speeds do not ascend.
    """

    inertia: float
    speeds: tuple[float, ...]
    torques: tuple[float, ...]

    def __post_init__(self) -> None:
        demand("inertia", self.inertia)
        for name in ("speeds", "torques"):
            if not all(map(math.isfinite, getattr(self, name))):
                raise ValueError(f"{name} = {list(getattr(self, name))}: must be finite numbers")
        if len(self.speeds) < 2 or len(self.speeds) != len(self.torques):
            raise ValueError("a characteristic needs two points or more, each with a torque")
        if any(later <= speed for speed, later in pairwise(self.speeds)):
            raise ValueError(f"speeds = {list(self.speeds)}: must ascend")

    @classmethod
    def straight(cls, inertia: float, stall_torque: float, no_load_speed: float) -> Drive:
        """The motor whose torque falls in one line from standstill to the no-load speed."""
        return cls(inertia, (0.0, no_load_speed), (stall_torque, 0.0))

    @property
    def top_speed(self) -> float:
        """Largest speed at which the motor does not brake [rad/s]; 0: it brakes at any above."""
        points = list(zip(self.speeds, self.torques, strict=True))
        for (low, pull), (high, brake) in reversed(list(pairwise(points))):
            if pull > 0.0 >= brake:
                return low + (high - low) * pull / (pull - brake)
        return 0.0
