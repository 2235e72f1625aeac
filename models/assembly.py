"""A rotor with its balancers and the way it is driven: what monolith and stability share."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import accumulate, pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .ring import Ring
from .rotor import LinearRotor
from .weights import Weights

if TYPE_CHECKING:
    from .liquid import Liquid


@dataclass(frozen=True)
class Mounted:
    """One balancer on a plane.

    Attributes:
        name: what the scene calls it.
        device: liquid, ring part filled with liquid, or weights.
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
    device: Liquid | Ring | Weights
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
    """A rotor and the balancers mounted on it, in order.

    Attributes:
        rotor: as it is at the start.
        balancers: mounted on it.
        later: times [s], ascending, and the rotor from then on: its unbalance changes.
    """

    rotor: LinearRotor
    balancers: tuple[Mounted, ...] = ()
    later: tuple[tuple[float, LinearRotor], ...] = ()

    def at(self, time: float) -> Assembly:
        """The assembly with the unbalance that it has from `time` [s] on."""
        passed = [rotor for start, rotor in self.later if start <= time]
        return replace(self, rotor=passed[-1], later=()) if passed else self

    def at_speed(self, speed: float) -> Assembly:
        """The assembly with the bearings that it has at a speed [rad/s].

        Raises:
            ValueError: a table of a bearing does not hold the speed.
        """
        if not self.rotor.varies:
            return self
        later = tuple((time, rotor.at(speed)) for time, rotor in self.later)
        return replace(self, rotor=self.rotor.at(speed), later=later)

    @property
    def largest_unbalance(self) -> float:
        """Largest sum of the rotor's generalised unbalances at any time [kg m]."""
        rotors = [self.rotor, *(rotor for _, rotor in self.later)]
        return max(float(np.abs(rotor.unbalance).sum()) for rotor in rotors)

    @cached_property
    def added_mass(self) -> NDArray[np.float64]:
        """Mass that the balancers add at each plane, (p,) [kg]."""
        added = np.zeros(self.rotor.plane_count)
        for mounted in self.balancers:
            added[mounted.plane] += mounted.device.added_mass
        return added

    @cached_property
    def loaded_rotor(self) -> LinearRotor:
        """The rotor with every balancer's added mass at its plane; waves of rings are stations."""
        added = np.zeros(self.rotor.plane_count)
        for mounted in self.balancers:
            if not isinstance(mounted.device, Ring):
                added[mounted.plane] += mounted.device.added_mass
        return self.with_waves(self.rotor.with_added_mass(added))

    @cached_property
    def resting_rotor(self) -> LinearRotor:
        """The rotor with every balancer's mass fixed to its plane, of rings all their liquid: for
        natural frequencies at standstill."""
        if not self.rings:
            return self.loaded_rotor
        added = np.zeros(self.rotor.plane_count)
        for mounted in self.balancers:
            device = mounted.device
            mass = device.liquid_mass if isinstance(device, Ring) else device.added_mass
            added[mounted.plane] += mass
        return self.rotor.with_added_mass(added)

    def with_waves(self, rotor: LinearRotor) -> LinearRotor:
        """A rotor with the waves of the rings as further stations, and their liquid."""
        for mounted in self.balancers:
            if isinstance(mounted.device, Ring):
                rotor = rotor.with_ring(mounted.device, mounted.plane)
        return rotor

    @property
    def rings(self) -> tuple[Mounted, ...]:
        """Only the rings part filled with liquid."""
        return tuple(m for m in self.balancers if isinstance(m.device, Ring))

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
    """Speed on straight lines between corners, and as at the outer ones beyond them.

    A constant speed has one corner, a run-up two.

    Attributes:
        times: of the corners, ascending [s]; the angle is counted from the first.
        speeds: at the corners, 0 or more [rad/s].
    """

    times: tuple[float, ...]
    speeds: tuple[float, ...]

    @classmethod
    def constant(cls, speed: float) -> SpeedProfile:
        """The same speed throughout [rad/s]."""
        return cls((0.0,), (speed,))

    @classmethod
    def run_up(cls, start: float, end: float, seconds: float) -> SpeedProfile:
        """From `start` to `end` [rad/s] within `seconds`."""
        return cls((0.0, seconds), (start, end))

    @property
    def start(self) -> float:
        """First speed [rad/s]."""
        return self.speeds[0]

    @property
    def end(self) -> float:
        """Speed of steady operation: the last one, or the highest where the rotor stops [rad/s]."""
        return self.speeds[-1] or self.top

    @property
    def top(self) -> float:
        """Highest speed [rad/s]."""
        return max(self.speeds)

    @property
    def seconds(self) -> float:
        """Time of the last corner [s]."""
        return self.times[-1]

    @property
    def changes(self) -> bool:
        """Whether the speed does."""
        return len(set(self.speeds)) > 1

    @property
    def sweep(self) -> tuple[float, float]:
        """Begin and end of the part in which the speed rises, or falls, by most [s]."""
        found, begin = (0.0, 0.0, 0.0), 0
        for k, (low, high) in enumerate(pairwise(self.speeds), start=1):
            if (high - low) * (low - self.speeds[begin]) < 0.0 or low == self.speeds[begin]:
                begin = k - 1
            change = abs(high - self.speeds[begin])
            if change > found[0]:
                found = change, self.times[begin], self.times[k]
        return found[1:]

    @property
    def steepest(self) -> float:
        """Largest modulus of the angular acceleration [rad/s^2]."""
        return max(abs(self.acceleration(time)) for time in self.times)

    def acceleration(self, time: float) -> float:
        """Angular acceleration just after `time` [rad/s^2]."""
        k = bisect_right(self.times, time)
        if not 0 < k < len(self.times):
            return 0.0
        return (self.speeds[k] - self.speeds[k - 1]) / (self.times[k] - self.times[k - 1])

    def speed(self, time: float) -> float:
        """Speed [rad/s]."""
        k = bisect_right(self.times, time)
        if not 0 < k < len(self.times):
            return self.speeds[min(k, len(self.times) - 1)]
        (begin, end), (low, high) = self.times[k - 1 : k + 1], self.speeds[k - 1 : k + 1]
        return low + (high - low) * (time - begin) / (end - begin)

    def angle(self, time: float) -> float:
        """Angle turned since the first corner [rad]."""
        k = max(1, bisect_right(self.times, time))
        begin, last = self.times[k - 1], self.speeds[k - 1]
        return self._turned[k - 1] + (time - begin) * (last + self.speed(time)) / 2.0

    def speeds_at(self, times: NDArray) -> NDArray:
        """`speed` at each time [rad/s]."""
        return np.interp(times, self.times, self.speeds)

    def angles_at(self, times: NDArray) -> NDArray:
        """`angle` at each time [rad]."""
        k = np.maximum(np.searchsorted(self.times, times, side="right"), 1) - 1
        last, passed = np.take(self.speeds, k), times - np.take(self.times, k)
        return np.take(self._turned, k) + passed * (last + self.speeds_at(times)) / 2.0

    def time_of(self, angle: float) -> float:
        """When the rotor has turned by `angle` [rad] since the first corner; infinite: never."""
        k = max(1, bisect_right(self._turned, angle))
        begin, low, left = self.times[k - 1], self.speeds[k - 1], angle - self._turned[k - 1]
        # low t + a t^2/2 in the form that does not cancel
        if left <= 0.0:
            return begin
        root = math.sqrt(max(0.0, low * low + 2.0 * self.acceleration(begin) * left))
        return begin + 2.0 * left / (low + root) if low + root else math.inf

    @cached_property
    def _turned(self) -> list[float]:
        """Angle turned at every corner [rad]."""
        lines = zip(pairwise(self.times), pairwise(self.speeds), strict=True)
        parts = [(end - begin) * (low + high) / 2.0 for (begin, end), (low, high) in lines]
        return [0.0, *accumulate(parts)]


@dataclass(frozen=True)
class Start:
    """Motion at time 0: displacements and velocities per station (or of all), angle of the rotor.

    `x`, `y` [m], under gravity from the sag, `vx`, `vy` [m/s], `angle` [rad].  The weights' start
    is in their `Mounted`.
    """

    x: float | Sequence[float] = 0.0
    y: float | Sequence[float] = 0.0
    vx: float | Sequence[float] = 0.0
    vy: float | Sequence[float] = 0.0
    angle: float = 0.0
