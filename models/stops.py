"""A body between elastic stops: closed forms.

A stop lies a gap g away from rest.  It pushes back by ks (r - g) + cs r' where r > g and that is
above 0, and never pulls: it lets go where its force has fallen to 0, with a damper before r = g.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from .arrays import Numbers

_AT_WALL = 1e-12  # of the gap: a whirl that just reaches the ring, but for rounding


@dataclass(frozen=True)
class FreeBetweenStops:
    """Free undamped motion along one axis, through the middle, between two equal stops.

    Attributes:
        period: [s].
        amplitude: [m].
    """

    period: float
    amplitude: float

    @classmethod
    def of(
        cls, mass: float, stiffness: float, stop_stiffness: float, gap: float, speed: float
    ) -> FreeBetweenStops:
        """The motion that passes the middle at a speed [m/s].

        Args:
            mass, stiffness: of the body and its spring [kg, N/m]; a stiffness of 0: no spring.
            stop_stiffness, gap: ks and g of both stops [N/m, m].

        Raises:
            ValueError: the motion does not reach the stops.
        """
        free, touching = stiffness / mass, (stiffness + stop_stiffness) / mass
        square = speed**2 - free * gap**2  # of the speed at the stop
        if square < 0.0 or speed <= 0.0:
            raise ValueError(f"speed = {speed:g} m/s: too slow to reach the stops")
        reach = math.sqrt(square)
        rest = stop_stiffness * gap / (stiffness + stop_stiffness)  # of spring and stop together
        root = math.sqrt(touching)
        within = gap / speed
        if free:
            within = math.asin(math.sqrt(free) * gap / speed) / math.sqrt(free)
        beyond = math.atan2(reach, root * (gap - rest)) / root
        return cls(4.0 * (within + beyond), rest + math.hypot(gap - rest, reach / root))


def restitution(mass: float, stiffness: float, damping: float) -> float:
    """Speed after over speed before the contact of a free body with one damped stop.

    With zeta = cs/(2 sqrt(ks m)), b = zeta ws and wd = ws sqrt(1 - zeta^2) the contact ends where
    the force has fallen to 0, after t = atan2(2 b wd, b^2 - wd^2)/wd, and e = e^{-b t}.

    Args:
        mass, stiffness, damping: of the body and the stop [kg, N/m, N s/m].

    Raises:
        ValueError: the damping is critical or more.
    """
    natural = math.sqrt(stiffness / mass)
    decay = damping / (2.0 * mass)
    if decay >= natural:
        raise ValueError(f"damping = {damping:g} N s/m: must be below the critical one")
    turning = math.sqrt(natural**2 - decay**2)
    contact = math.atan2(2.0 * decay * turning, decay**2 - turning**2) / turning
    return math.exp(-decay * contact)


@dataclass(frozen=True)
class DiscInRing:
    """A disc on equal springs within a ring-shaped stop without damping and friction.

    A circular whirl of amplitude A is an exact motion, with

        ((k - M w^2) A + ks max(A - g, 0))^2 + (c w A)^2 = (U w^2)^2.

    Attributes:
        mass, stiffness, damping: of disc and springs [kg, N/m, N s/m].
        stop_stiffness, gap: ks and g of the ring [N/m, m].
    """

    mass: float
    stiffness: float
    damping: float
    stop_stiffness: float
    gap: float

    def amplitudes(self, unbalance: float, speed: float) -> Numbers:
        """Amplitudes of all circular whirls, ascending: one or three [m].

        Args:
            unbalance: static moment U [kg m].
            speed: of the rotor w [rad/s].
        """
        left, damped = self.stiffness - self.mass * speed**2, self.damping * speed
        pull = unbalance * speed**2
        found = [pull / math.hypot(left, damped)] if left or damped else []
        wall = self.gap * (1.0 + _AT_WALL)
        found = [a for a in found if a <= wall]
        # beyond the gap a parabola: (left + ks) A - ks g, c w A
        stiff, offset = left + self.stop_stiffness, self.stop_stiffness * self.gap
        roots = np.roots([stiff**2 + damped**2, -2.0 * stiff * offset, offset**2 - pull**2])
        found += [float(a.real) for a in roots if a.imag == 0.0 and a.real > wall]
        return np.sort(np.array(found))

    def slowest_contact(self, unbalance: float, high: float, low: float = 0.0) -> float:
        """Speed between two at which the whirl without contact just reaches the ring [rad/s].

        Raises:
            ValueError: it is inside the ring, or outside, at both.
        """

        def beyond(speed: float) -> float:
            left, damped = self.stiffness - self.mass * speed**2, self.damping * speed
            return unbalance * speed**2 - self.gap * math.hypot(left, damped)

        if beyond(low) * beyond(high) > 0.0:
            raise ValueError("the whirl reaches the ring at none or both of the speeds")
        return float(brentq(beyond, low, high, xtol=1e-13 * high))
