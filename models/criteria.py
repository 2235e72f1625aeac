"""The empirical criterion of Filimonikhina 2017: where weights balance, in closed form.

The weights balance where the rotor's centre moves, on the average of a revolution, against an
elementary unbalance: P(w) < 0 (19).  The criterion knows neither the weights' mass nor their drag;
`stability` tells where it holds.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from .assembly import Assembly
from .linear.boundaries import Crossing


@dataclass(frozen=True)
class Criterion:
    """Criterion of a planar rotor in dimensional form.

    Attributes:
        w_x, w_y: undamped natural frequencies sqrt(k/M) with the balancers' mass in M [rad/s].
        b_x, b_y: damping over mass c/M [1/s].

    Raises:
        ValueError: a value is not finite or out of its range.
    """

    w_x: float
    w_y: float
    b_x: float = 0.0
    b_y: float = 0.0

    def __post_init__(self) -> None:
        for name in ("w_x", "w_y"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0.0):
                raise ValueError(f"{name} = {value!r} rad/s: must be a positive finite number")
        for name in ("b_x", "b_y"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                raise ValueError(f"{name} = {value!r} 1/s: must be a finite number, 0 or more")

    @classmethod
    def of(cls, assembly: Assembly) -> Criterion:
        """The criterion of a planar assembly.

        Raises:
            ValueError: the rotor has several stations or internal damping: no criterion is known.
        """
        rotor = assembly.loaded_rotor
        if rotor.stations != 1:
            raise ValueError(f"the criterion is for a planar rotor, not {rotor.stations} stations")
        if rotor.internal_damping.any():
            raise ValueError("the criterion is for a rotor without internal damping")
        mass = float(rotor.mass[0, 0])
        return cls(
            w_x=math.sqrt(float(rotor.stiffness_x[0, 0]) / mass),
            w_y=math.sqrt(float(rotor.stiffness_y[0, 0]) / mass),
            b_x=float(rotor.damping_x[0, 0]) / mass,
            b_y=float(rotor.damping_y[0, 0]) / mass,
        )

    def value(self, speed: float | NDArray) -> float | NDArray:
        """P(w) (19) [rad^6/s^6]: negative where weights balance."""
        w = np.square(speed)
        x, y = self.w_x**2 - w, self.w_y**2 - w
        return x * y * (x + y) + w * (x * self.b_y**2 + y * self.b_x**2)

    @property
    def coefficients(self) -> tuple[float, float, float, float]:
        """(c0, c1, c2, c3) of P = c0 W^3 + c1 W^2 + c2 W + c3, W = w^2 (30), (31)."""
        x, y, b_x, b_y = self.w_x**2, self.w_y**2, self.b_x**2, self.b_y**2
        return (
            -2.0,
            3.0 * (x + y) - b_x - b_y,
            -((x + y) ** 2 + 2.0 * x * y - (x * b_y + y * b_x)),
            x * y * (x + y),
        )

    @property
    def discriminant(self) -> float:
        """Of the cubic, over (w_x w_y)^6 (32): positive when it has three different real roots."""
        scale = self.w_x * self.w_y
        c0, c1, c2, c3 = (c / scale**k for k, c in enumerate(self.coefficients))
        return (
            -4.0 * c1**3 * c3
            + c1**2 * c2**2
            - 4.0 * c0 * c2**3
            + 18.0 * c0 * c1 * c2 * c3
            - 27.0 * c0**2 * c3**2
        )

    @property
    def positive_roots(self) -> int:
        """Number of critical speeds by (32), (33): three or one.

        With equal stiffness it is one (22).  (33) beyond (32) reads: coefficients of alternating
        signs; three real roots are then all positive.
        """
        _, c1, c2, _ = self.coefficients
        three = self.w_x != self.w_y and self.discriminant > 0.0 and c1 > 0.0 and c2 < 0.0
        return 3 if three else 1

    @property
    def critical_speeds(self) -> tuple[float, ...]:
        """Positive roots of P(w) [rad/s], ascending; each lies between w_x and w_y (29)."""
        (low, b_low), (high, b_high) = sorted(((self.w_x, self.b_x), (self.w_y, self.b_y)))
        span = (high - low) * (high + low)
        if span == 0.0:
            return (low,)
        # with W = low^2 + span t nothing cancels near either end
        floor, near, far = low * low / span, b_low**2 / span, b_high**2 / span

        def scaled(t: float) -> float:
            return -t * (1.0 - t) * (1.0 - 2.0 * t) + (floor + t) * ((1.0 - t) * near - t * far)

        both = near + far
        slope = np.polynomial.Polynomial(
            [-1.0 + near - floor * both, 2.0 * (3.0 - both), -6.0]
        ).roots()
        turns = [t for t in np.sort(slope.real) if 0.0 < t < 1.0 and np.isreal(slope).all()]
        nodes = [0.0, *turns, 1.0]
        values = [scaled(t) for t in nodes]
        roots = [t for t, v in ((0.0, values[0]), (1.0, values[-1])) if v == 0.0]
        for i in range(len(nodes) - 1):
            if values[i] * values[i + 1] < 0.0:
                # to the last digit of however small a root
                roots.append(brentq(scaled, nodes[i], nodes[i + 1], xtol=1e-300, rtol=1e-15))
        return tuple(math.sqrt(low * low + span * t) for t in sorted(roots))

    @property
    def crossings(self) -> list[Crossing]:
        """The critical speeds and what the criterion says just above each."""
        speeds = self.critical_speeds
        return [
            Crossing(speed, "unstable" if len(speeds) == 3 and i == 1 else "stable")
            for i, speed in enumerate(speeds)
        ]

    @property
    def small_damping(self) -> tuple[float | None, float | None, float | None]:
        """Approximation (28) of the three roots for b << |w_y - w_x| [rad/s], softer axis first.

        None where the formula has no real value, or with equal stiffness.
        """
        (low, b_low), (high, b_high) = sorted(((self.w_x, self.b_x), (self.w_y, self.b_y)))
        span = (high - low) * (high + low)
        if span == 0.0:
            return None, None, None
        squares = (
            low**2 * (1.0 + b_low**2 / span),
            0.5 * (low**2 + high**2) * (1.0 + (b_high**2 - b_low**2) / span),
            high**2 * (1.0 - b_high**2 / span),
        )
        first, second, third = (math.sqrt(s) if s > 0.0 else None for s in squares)
        return first, second, third

    @property
    def large_damping(self) -> float | None:
        """Approximation (35) of the only root for large damping [rad/s]; None without damping."""
        total = self.b_x**2 + self.b_y**2
        if total == 0.0:
            return None
        return math.sqrt(((self.w_x * self.b_y) ** 2 + (self.w_y * self.b_x) ** 2) / total)
