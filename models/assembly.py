"""A rotor with its balancers and the way it is driven: what monolith and stability share."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from .liquid import Liquid
from .rotor import LinearRotor
from .weights import Weights


@dataclass(frozen=True)
class Mounted:
    """One balancer on a plane.

    Attributes:
        name: what the scene calls it.
        device: liquid or weights.
        plane: index of the correction plane, from 0.
        angles, speeds: weights' angles in the rotor [rad] and their rates [rad/s] at the start;
            empty for a liquid.
        offset: of the weights' track from the plane's centre, rotor frame, xi + i eta [m].
        half_angle: half the angle between weights that touch [rad]; 0 where they pass; of unequal
            ones that of the mean radius.
        restitution: of two weights that collide on the free rotor.
        rolling_resistance: over load; 0: none.
    """

    name: str
    device: Liquid | Weights
    plane: int = 0
    angles: tuple[float, ...] = ()
    speeds: tuple[float, ...] = ()
    offset: complex = 0j
    half_angle: float = 0.0
    restitution: float = 0.0
    rolling_resistance: float = 0.0


def weights_of(mounted: Mounted) -> Weights:
    """What is mounted, where it is known to be weights."""
    assert isinstance(mounted.device, Weights)
    return mounted.device


@dataclass(frozen=True)
class Assembly:
    """A rotor and the balancers mounted on it, in order."""

    rotor: LinearRotor
    balancers: tuple[Mounted, ...] = ()

    @cached_property
    def added_mass(self) -> NDArray[np.float64]:
        """Mass that the balancers add at each plane, (p,) [kg]."""
        added = np.zeros(self.rotor.plane_count)
        for mounted in self.balancers:
            added[mounted.plane] += mounted.device.added_mass
        return added

    @cached_property
    def loaded_rotor(self) -> LinearRotor:
        """The rotor with every balancer's added mass at its plane."""
        return self.rotor.with_added_mass(self.added_mass)

    @property
    def capacity(self) -> float:
        """Unbalance that all weights together can balance, the sum of N m R [kg m]."""
        devices = [m.device for m in self.balancers]
        return sum(device.point_capacity for device in devices if isinstance(device, Weights))

    @property
    def weights(self) -> tuple[Mounted, ...]:
        """Only the balancers with weights."""
        return tuple(m for m in self.balancers if isinstance(m.device, Weights))


@dataclass(frozen=True)
class SpeedProfile:
    """Speed that rises linearly from `start` to `end` [rad/s] within `seconds`, then stays.

    A constant speed has `start == end`.
    """

    start: float
    end: float
    seconds: float = 0.0

    @classmethod
    def constant(cls, speed: float) -> SpeedProfile:
        """The same speed throughout [rad/s]."""
        return cls(speed, speed)

    @property
    def rises(self) -> bool:
        """Whether the speed changes."""
        return self.start != self.end

    def acceleration(self, time: float) -> float:
        """Angular acceleration just after `time` [rad/s^2]."""
        if self.start == self.end or time >= self.seconds:
            return 0.0
        return (self.end - self.start) / self.seconds

    def speed(self, time: float) -> float:
        """Speed [rad/s]."""
        if self.start == self.end or time >= self.seconds:
            return self.end
        return self.start + (self.end - self.start) * time / self.seconds

    def angle(self, time: float) -> float:
        """Angle turned since time 0 [rad]."""
        if self.start == self.end:
            return self.end * time
        ramp = min(time, self.seconds)
        turned = ramp * (self.start + self.speed(ramp)) / 2.0
        return turned + self.end * max(0.0, time - self.seconds)
