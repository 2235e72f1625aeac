"""A motor of limited power: its torque depends on the speed, and what is left over turns the rotor.

    I w' = L(w) + tau

with L the motor's characteristic, tau the torque of all that sits on the shaft, and I the moment of
inertia of all that turns, unbalance included.  L runs in straight lines between points and goes on
beyond the outer ones.  Sommerfeld 1902; Kononenko 1969.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise


@dataclass(frozen=True)
class Drive:
    """A motor on the rotor's shaft.

    Attributes:
        inertia: I, of all that turns [kg m^2].
        speeds, torques: points of the characteristic, speeds ascending, two or more
            [rad/s, N m].
    """

    inertia: float
    speeds: tuple[float, ...]
    torques: tuple[float, ...]

    @property
    def top_speed(self) -> float:
        """Largest speed at which the motor does not brake [rad/s]; 0: it brakes at any above."""
        points = list(zip(self.speeds, self.torques, strict=True))
        for (low, pull), (high, brake) in reversed(list(pairwise(points))):
            if pull > 0.0 >= brake:
                return low + (high - low) * pull / (pull - brake)
        return 0.0


@dataclass(frozen=True)
class MotorDriven:
    """A speed that a motor of limited power makes, from `start` on [rad/s]."""

    motor: Drive
    start: float = 0.0

    @property
    def end(self) -> float:
        """Without load [rad/s]."""
        return self.motor.top_speed

    @property
    def top(self) -> float:
        """Highest speed that a load leaves [rad/s]."""
        return max(abs(self.start), self.end)
