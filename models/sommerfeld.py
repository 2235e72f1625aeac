"""The Sommerfeld effect: a motor of limited power before the resonance of a planar isotropic rotor.

At a steady speed w the rotor whirls with a constant amplitude, and the supports' damping c takes
the power c w^2 |z|^2; so the motor must give the torque R(w) = c w |z|^2.  R has a peak at the
resonance: where the motor's line meets its rising flank the rotor is caught.  Sommerfeld 1902;
Kononenko 1969.

Free point weights on a centred track rest relative to the rotor where the track's acceleration is
radial: all of them on the side the rotor is bent to.  With D = k - m w^2 + i c w and s = N m R,

    D z = w^2 (U e^{i g} + s z/|z|),   so   | D |z| - s w^2 | = U w^2.

Internal damping turns with the shaft and takes nothing of such a whirl.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq, minimize_scalar

from .assembly import Assembly

_GRID = 20_000  # speeds among which the peak is looked for first


@dataclass(frozen=True)
class Resonance:
    """A planar isotropic rotor with its balancers, before a motor of no-load speed `top`.

    Attributes:
        mass, stiffness, damping: loaded rotor, supports [kg, N/m, N s/m].
        unbalance: static moment of the rotor [kg m].
        weights: static moment of all weights on one side [kg m].
        top: no-load speed of the motor, at which its torque is 0 [rad/s].
    """

    mass: float
    stiffness: float
    damping: float
    unbalance: float
    weights: float
    top: float

    @classmethod
    def of(cls, assembly: Assembly, top: float) -> Resonance:
        """That of an assembly.

        Raises:
            ValueError: the rotor is not planar and isotropic, or a track is off its centre.
        """
        rotor = assembly.loaded_rotor
        if rotor.stations != 1 or not rotor.isotropic or any(m.offset for m in assembly.weights):
            raise ValueError(
                "needs a planar rotor with equal stiffness and damping in x and y, and centred "
                "tracks"
            )
        numbers = rotor.mass, rotor.stiffness_x, rotor.damping_x, abs(rotor.unbalance)
        mass, stiffness, damping, unbalance = (float(n.item()) for n in numbers)
        return cls(mass, stiffness, damping, unbalance, assembly.capacity, top)

    def amplitude(self, speed: ArrayLike) -> NDArray[np.float64]:
        """|z| of the steady whirl [m]."""
        w = np.asarray(speed, float)
        direct, damped = self.stiffness - self.mass * w * w, self.damping * w
        size, moved = direct**2 + damped**2, self.weights * w * w
        root = np.sqrt((self.unbalance * w * w) ** 2 * size - (moved * damped) ** 2)
        return (moved * direct + root) / size

    def resistance(self, speed: ArrayLike) -> NDArray[np.float64]:
        """R(w), the torque that keeps the speed [N m]."""
        return self.damping * np.asarray(speed, float) * self.amplitude(speed) ** 2

    def stall_torque(self, speed: ArrayLike) -> NDArray[np.float64]:
        """Of the motor whose line meets the resistance at a speed [N m]."""
        return self.resistance(speed) / (1.0 - np.asarray(speed, float) / self.top)

    def limit(self) -> tuple[float, float]:
        """Stall torque above which a motor passes however slowly, and the speed of its touch.

        Raises:
            ValueError: the resistance has no peak below the motor's no-load speed.
        """
        speeds = np.linspace(0.0, self.top, _GRID + 2)[1:-1]
        needed = self.stall_torque(speeds)
        falling = np.flatnonzero(np.diff(needed) < 0.0)
        if not falling.size:
            raise ValueError(
                "has no resonance below the motor's no-load speed: needs unbalance, damping and a "
                "natural frequency below it"
            )
        around = speeds[max(0, falling[0] - 1)], speeds[falling[0] + 1]
        found = minimize_scalar(lambda w: -float(self.stall_torque(w)), bounds=around,
                                method="bounded", options={"xatol": 1e-12})  # fmt: skip
        return -float(found.fun), float(found.x)

    def caught_at(self, stall_torque: float) -> float:
        """Speed at which a weaker motor stays below the resonance [rad/s]."""
        return float(
            brentq(lambda w: self.stall_torque(w) - stall_torque, 1e-6 * self.top, self.limit()[1])
        )
