"""Where a liquid balancer helps: the closed forms of Dubovik 2006.

A disc of mass m1 on a flexible shaft carries a chamber with liquid, m = m1 + r m2 in motion.
Steady bending (6), lower limit (11) from which the liquid lessens it, upper limit (10) of
stability, and the exact roots of the disturbed motion (7).
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..assembly import Assembly
from ..liquid import Liquid

OPEN_END = 5.0  # times the lower limit: a window that ends above is not followed to its end


@dataclass(frozen=True)
class LiquidWindow:
    """Rotor on a flexible isotropic shaft with one liquid balancer, Dubovik 2006 (5).

    Attributes:
        rotor_mass: disc and chamber m1, without liquid [kg].
        stiffness: c [N/m].
        external_damping: chi, of the supports and the air [N s/m].
        internal_damping: p, of the rotating shaft [N s/m].
        unbalance: static moment m1 e [kg m].
        liquid: the balancer.
    """

    rotor_mass: float
    stiffness: float
    external_damping: float
    internal_damping: float
    unbalance: float
    liquid: Liquid

    @classmethod
    def of(cls, assembly: Assembly) -> LiquidWindow:
        """The window of a planar isotropic rotor with one liquid balancer and nothing else.

        Raises:
            ValueError: the assembly is another one; the message says in what.
        """
        rotor, balancers = assembly.rotor, assembly.balancers
        if rotor.stations != 1 or not rotor.isotropic:
            raise ValueError("Dubovik's window is for a planar rotor, equal stiffness in x and y")
        if len(balancers) != 1 or not isinstance(balancers[0].device, Liquid):
            raise ValueError("Dubovik's window is for exactly one balancer, a liquid one")
        return cls(
            rotor_mass=float(rotor.mass[0, 0]),
            stiffness=float(rotor.stiffness_x[0, 0]),
            external_damping=float(rotor.damping_x[0, 0]),
            internal_damping=float(rotor.internal_damping[0, 0]),
            unbalance=abs(complex(rotor.unbalance[0])),
            liquid=balancers[0].device,
        )

    @property
    def moving_mass(self) -> float:
        """m = m1 + r m2 [kg]."""
        return self.rotor_mass + self.liquid.added_mass

    @property
    def mu(self) -> float:
        """m / m1, always above 1."""
        return self.moving_mass / self.rotor_mass

    @property
    def lower(self) -> float:
        """w_* (11) [rad/s]: above it the liquid lessens the bending, whatever the damping."""
        return math.sqrt(2.0 * self.stiffness / (self.rotor_mass + self.moving_mass))

    @property
    def upper(self) -> float | None:
        """w^* (10) [rad/s]: below it rotation is stable; None without internal damping, no limit.

        Without damping of either kind nothing decays and nothing grows: None too.
        """
        if self.internal_damping == 0.0:
            return None
        ratio = 1.0 + self.external_damping / self.internal_damping
        limit = ratio * math.sqrt(self.stiffness / self.moving_mass)
        return limit if math.isfinite(limit) else None

    @property
    def empty(self) -> bool:
        """True when no speed is in the window: (1 + chi/p)^2 <= 2 mu / (1 + mu)."""
        return self.upper is not None and self.upper <= self.lower

    def _response(self, speed: float | NDArray, mass: float) -> Any:
        return self.stiffness - mass * speed * speed + 1j * self.external_damping * speed

    def bending(self, speed: float | NDArray) -> Any:
        """Steady bending A (6) [m], of the shape of `speed` [rad/s]."""
        return self.unbalance * speed * speed / abs(self._response(speed, self.moving_mass))

    def bending_without(self, speed: float | NDArray) -> Any:
        """Steady bending of the rotor without liquid [m]: (6) with m = m1."""
        return self.unbalance * speed * speed / abs(self._response(speed, self.rotor_mass))

    def phase(self, speed: float | NDArray) -> Any:
        """Angle gamma (6) from unbalance to deflection, -pi to 0 [rad]."""
        return -np.angle(self._response(speed, self.moving_mass))

    def roots(self, speed: float) -> tuple[complex, complex]:
        """Roots of the disturbed motion (7), m s^2 + (p + chi) s + c - i p w = 0 [1/s].

        In z = x + i y; those of (8) are these two and their conjugates.  The one with the larger
        growth rate first.
        """
        damping = self.external_damping + self.internal_damping
        constant = complex(self.stiffness, -self.internal_damping * speed)
        root = cmath.sqrt(damping * damping - 4.0 * self.moving_mass * constant)
        # the principal root has no negative real part: nothing cancels in the sum
        fast = -(damping + root) / (2.0 * self.moving_mass)
        slow = constant / (self.moving_mass * fast)
        return slow, fast

    def touching_speeds(self) -> list[tuple[float, float | None]]:
        """Intervals of speed [rad/s] in which steady bending exceeds the gap: the float touches.

        Between them the model is valid.  The end None means: at every higher speed (bending tends
        to m1 e / m).
        """
        # with V = c/(m w^2), A > gap reads V^2 - q1 V - q2 < 0, whose leading term cannot vanish
        reach = self.unbalance / (self.moving_mass * self.liquid.gap)
        damping = self.external_damping**2 / (self.stiffness * self.moving_mass)
        q2, q1 = (reach - 1.0) * (reach + 1.0), 2.0 - damping
        natural = math.sqrt(self.stiffness / self.moving_mass)
        discriminant = q1 * q1 + 4.0 * q2
        if discriminant <= 0.0:
            return []
        half = (abs(q1) + math.sqrt(discriminant)) / 2.0
        first, second = (half, -q2 / half) if q1 >= 0.0 else (q2 / half, -half)
        high, low = max(first, second), min(first, second)
        if high <= 0.0:
            return []
        return [(natural / math.sqrt(high), natural / math.sqrt(low) if low > 0.0 else None)]
