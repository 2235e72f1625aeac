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

from .assembly import Assembly
from .boundaries import Crossing


@dataclass(frozen=True)
class Criterion:
    """Criterion of a planar rotor in dimensional form.

    Attributes:
        w_x, w_y: undamped natural frequencies sqrt(k/M) with the balancers' mass in M [rad/s].
        b_x, b_y: damping over mass c/M [1/s].
    """

    w_x: float
    w_y: float
    b_x: float = 0.0
    b_y: float = 0.0

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
    def critical_speeds(self) -> tuple[float, ...]:
        """Positive roots of P(w) [rad/s], ascending; each lies between w_x and w_y (29)."""
        from scipy.optimize import brentq  # loaded only where they are asked for

        (low, b_low), (high, b_high) = sorted(((self.w_x, self.b_x), (self.w_y, self.b_y)))
        span = (high - low) * (high + low)
        if span == 0.0:
            return (low,)
        # with W = low^2 + span t nothing cancels near either end
        floor, near, far = low * low / span, b_low**2 / span, b_high**2 / span

        def scaled(t: float) -> float:
            """P(w) of (19) over span^3, at w^2 = low^2 + span t."""
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
