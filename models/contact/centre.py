"""Motion of the track's centre and of the rotor within a communication step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ..cubic import at
from ..spin import STEADY, Rates


class Instant(NamedTuple):
    """What drives the weights at one time.

    Attributes:
        acceleration, slope: of the track's centre, rotor frame [m/s^2, m/s^3].
        rotor_speed, angular_acceleration: w and w' [rad/s, rad/s^2].
    """

    acceleration: complex
    slope: complex
    rotor_speed: float
    angular_acceleration: float


class CentreMotion(NamedTuple):
    """Acceleration of the track's centre as a cubic of time, and a uniformly accelerated rotor.

    Attributes:
        signal: (4,) acceleration at the start of the step and its derivatives of order 1 to 3,
            rotor frame [m/s^2, m/s^3, ...].
        rotor_speed, angular_acceleration: w at the start of the step, and w' [rad/s, rad/s^2].
    """

    signal: Sequence[complex]
    rotor_speed: float
    angular_acceleration: float


def instant(motion: CentreMotion, time: float) -> Instant:
    """What drives the weights `time` after the start of the step [s]."""
    speed = motion.rotor_speed + motion.angular_acceleration * time
    return Instant(*at(motion.signal, time), speed, motion.angular_acceleration)


def turned(motion: CentreMotion, time: float) -> float:
    """Angle by which the rotor has turned `time` after the start of the step [rad]."""
    return time * (motion.rotor_speed + 0.5 * motion.angular_acceleration * time)


def shifted(
    signal: Sequence[complex],
    offset: complex,
    rotor_speed: float,
    angular_acceleration: float,
    rates: Rates = STEADY,
) -> tuple[complex, ...]:
    """Signal of the track's centre from that of the plane's: (i w' - w^2) e, exact for linear w.

    Args:
        signal: (4,) or (6,) acceleration and its derivatives at the start of the step, rotor frame.
        offset: of the track's centre in the rotor frame, e [m].
        rotor_speed, angular_acceleration, rates: w, w' and the derivatives of w' of order 1 to 3
            at the start of the step [rad/s, rad/s^2, ...].
    """
    a0, a1, a2, a3, *higher = signal
    if rates != STEADY:
        j1, j2, j3 = rates
        a1 += 1j * j1 * offset
        a2 += (1j * j2 - 2.0 * rotor_speed * j1) * offset
        a3 += (1j * j3 - 6.0 * angular_acceleration * j1 - 2.0 * rotor_speed * j2) * offset
        whirls = (
            2.0 * rotor_speed * j3 + 8.0 * angular_acceleration * j2 + 6.0 * j1 * j1,
            10.0 * angular_acceleration * j3 + 20.0 * j1 * j2,
        )
        higher = [a - whirl * offset for a, whirl in zip(higher, whirls, strict=False)]
    return (
        a0 + (1j * angular_acceleration - rotor_speed * rotor_speed) * offset,
        a1 - 2.0 * rotor_speed * angular_acceleration * offset,
        a2 - 2.0 * angular_acceleration * angular_acceleration * offset,
        a3,
        *higher,
    )
