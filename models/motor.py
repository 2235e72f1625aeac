"""A motor of limited power: its torque depends on the speed, and what is left over turns the rotor.

    I w' = L(w) + tau

with L the motor's characteristic, tau the torque of all that sits on the shaft, and I the moment of
inertia of all that turns, unbalance included.  L runs in straight lines between points and goes on
beyond the outer ones; between two points the equation is linear and is solved exactly for a cubic
tau.  Sommerfeld 1902; Kononenko 1969.
"""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from .contact.roots import crossing
from .cubic import at
from .ranges import demand
from .weights import quadrature

MOST_CROSSINGS = 1000  # of points of the characteristic, in a step
LOOKS = 8  # in a step, for a speed that leaves its line and comes back
_BRACKET = 1e-15  # of a step: where a point is crossed


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

    def piece(self, speed: float) -> int:
        """The line a speed lies on: that from point `piece` to the next, or its continuation."""
        return min(max(bisect_right(self.speeds, speed) - 1, 0), len(self.speeds) - 2)

    def slope(self, piece: int) -> float:
        """dL/dw on a line [N m s/rad]."""
        rise = self.torques[piece + 1] - self.torques[piece]
        return rise / (self.speeds[piece + 1] - self.speeds[piece])

    def torque(self, speed: float) -> float:
        """L(w) [N m]."""
        piece = self.piece(speed)
        return self.torques[piece] + self.slope(piece) * (speed - self.speeds[piece])

    def acceleration(self, speed: float, torque: float, torque_slope: float) -> tuple[float, float]:
        """w' and w'' under a torque on the shaft and its slope [rad/s^2, rad/s^3]."""
        rate = (self.torque(speed) + torque) / self.inertia
        return rate, (self.slope(self.piece(speed)) * rate + torque_slope) / self.inertia


def advance(
    motor: Drive, speed: float, torque: Sequence[float], step: float
) -> tuple[float, float]:
    """Speed after a step, and the angle turned in it [rad/s, rad].

    Args:
        speed: at the start [rad/s].
        torque: on the shaft at the start, and its derivatives of order 1 to 3 [N m, ...].
        step: [s].

    Raises:
        ArithmeticError: the input is not finite, or points are crossed again and again.
    """
    if not math.isfinite(speed + sum(torque)):
        raise ArithmeticError(f"the motor's speed {speed!r} rad/s or the torque is not finite")
    angle = begin = 0.0
    piece, looks = motor.piece(speed), LOOKS if len(motor.speeds) > 2 else 1
    for _ in range(MOST_CROSSINGS):
        here, left = _later(torque, begin), step - begin
        for look in range(1, looks + 1):
            until = left * look / looks
            end, turned = _on_line(motor, piece, speed, here, until)
            beyond = _left(motor, piece, end)
            if beyond:
                break
        else:
            return end, angle + turned
        bound = motor.speeds[piece + max(beyond, 0)]
        part = _until(motor, piece, speed, here, until, bound, beyond)
        angle += _on_line(motor, piece, speed, here, part)[1]
        begin, speed, piece = begin + part, bound, piece + beyond
    raise ArithmeticError(
        f"the motor's speed crosses {speed:g} rad/s again and again within a step of {step:g} s"
    )


def _left(motor: Drive, piece: int, speed: float) -> int:
    """1 or -1 where a speed is above or below a line that others join; 0 on it."""
    if piece < len(motor.speeds) - 2 and speed > motor.speeds[piece + 1]:
        return 1
    return -1 if piece > 0 and speed < motor.speeds[piece] else 0


def _later(torque: Sequence[float], time: float) -> tuple[float, float, float, float]:
    """The cubic as it is told from a later start."""
    value, slope = at(torque, time)
    return value, slope, torque[2] + time * torque[3], torque[3]


def _on_line(
    motor: Drive, piece: int, speed: float, torque: Sequence[float], time: float
) -> tuple[float, float]:
    """Speed and angle turned after `time`, all of it on one line: exact."""
    rate = motor.slope(piece) / motor.inertia
    e, s0, s1, s2, s3, t, t0, t1, t2, t3 = quadrature(-rate, time)
    first = (motor.torques[piece] + torque[0]) / motor.inertia - rate * motor.speeds[piece]
    g1, g2, g3 = (value / motor.inertia for value in torque[1:])
    return (
        e * speed + s0 * first + s1 * g1 + s2 * g2 + s3 * g3,
        t * speed + t0 * first + t1 * g1 + t2 * g2 + t3 * g3,
    )


def _until(
    motor: Drive,
    piece: int,
    speed: float,
    torque: Sequence[float],
    time: float,
    bound: float,
    beyond: int,
) -> float:
    """Time until the speed passes a point of the characteristic."""

    def short_of(_: None, moment: float) -> float:
        return beyond * (bound - _on_line(motor, piece, speed, torque, moment)[0])

    return crossing(short_of, None, max(0.0, beyond * (bound - speed)), time, _BRACKET * time)
