"""How the rotor turns within a step: its speed, and an angular acceleration that is a cubic."""

from __future__ import annotations

from typing import NamedTuple

Rates = tuple[float, float, float]
STEADY: Rates = (0.0, 0.0, 0.0)


class Drift(NamedTuple):
    """What a changing angular acceleration adds to what a constant one would have led to.

    Attributes:
        angle, speed: [rad, rad/s].
        acceleration: w' [rad/s^2].
        slope: w'' itself [rad/s^3].
    """

    angle: float
    speed: float
    acceleration: float
    slope: float


_NONE = Drift(0.0, 0.0, 0.0, 0.0)


def drift(rates: Rates, time: float) -> Drift:
    """The drift `time` after the start of a step [s].

    Args:
        rates: derivatives of the angular acceleration of order 1 to 3 there [rad/s^3, ...].
    """
    if rates == STEADY:
        return _NONE
    first, second, third = rates
    return Drift(
        time**3 * (first / 6.0 + time * (second / 24.0 + time * third / 120.0)),
        time**2 * (first / 2.0 + time * (second / 6.0 + time * third / 24.0)),
        time * (first + time * (second / 2.0 + time * third / 6.0)),
        first + time * (second + time * third / 2.0),
    )


def spin_at(angular_acceleration: float, rates: Rates, time: float) -> Rates:
    """Angular acceleration and its derivatives of order 1 and 2, `time` after the start of a step.

    Args:
        angular_acceleration, rates: of order 0, and 1 to 3, at the start.
    """
    moved = drift(rates, time)
    return angular_acceleration + moved.acceleration, moved.slope, rates[1] + time * rates[2]
