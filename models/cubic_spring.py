"""A disc on a support whose spring hardens with the cube of the displacement: closed forms.

Radial spring, f = -(k + k3 |z|^2) z.  A circular whirl z = A e^{i (w t - phi)} under an unbalance U
is an exact motion of the disc, with

    ((k - M w^2) A + k3 A^3)^2 + (c w A)^2 = (U w^2)^2,

a cubic in A^2: one motion, or three between two speeds.  A small disturbance u of it, z = (A + u)
e^{i (w t - phi)}, follows

    M (u'' + 2 i w u') + c u' + (k - M w^2 + i c w + 2 k3 A^2) u + k3 A^2 conj(u) = 0.

Along one axis, f = -(k x + k3 x^3), free motion of amplitude A has the period 4 K(m)/W with the
complete elliptic integral K of the parameter m = e/(2 (1 + e)), e = k3 A^2/k, W^2 = (1 + e) k/M.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.special import ellipk

from .arrays import Numbers

_REAL = 1e-9  # of the largest root: an imaginary part that is rounding


@dataclass(frozen=True)
class CubicDisc:
    """A disc on a radial cubic spring.

    Attributes:
        mass, stiffness, damping: [kg, N/m, N s/m].
        cubic_stiffness: k3 [N/m^3]; below 0 for a spring that softens.
    """

    mass: float
    stiffness: float
    damping: float
    cubic_stiffness: float

    def amplitudes(self, unbalance: float, speed: float) -> Numbers:
        """Amplitudes of all circular whirls, ascending: one or three [m].

        Args:
            unbalance: static moment U [kg m].
            speed: of the rotor w [rad/s].
        """
        left = self.stiffness - self.mass * speed**2
        damped = (self.damping * speed) ** 2
        k3 = self.cubic_stiffness
        roots = np.roots([k3**2, 2.0 * k3 * left, left**2 + damped, -((unbalance * speed**2) ** 2)])
        size = float(np.abs(roots).max()) if len(roots) else 0.0
        real = roots[(np.abs(roots.imag) <= _REAL * size) & (roots.real >= 0.0)].real
        return np.asarray(np.sort(np.sqrt(real)))

    def growth_rate(self, amplitude: float, speed: float) -> float:
        """Of the fastest growing disturbance of a circular whirl [1/s]; below 0: it is stable."""
        m, c, k3 = self.mass, self.damping, self.cubic_stiffness
        along = self.stiffness - m * speed**2 + 2.0 * k3 * amplitude**2
        across = k3 * amplitude**2
        stiffness = np.array([[along + across, -c * speed], [c * speed, along - across]])
        damping = np.array([[c, -2.0 * m * speed], [2.0 * m * speed, c]])
        rows = [[np.zeros((2, 2)), np.eye(2)], [-stiffness / m, -damping / m]]
        return float(np.linalg.eigvals(np.block(rows)).real.max())

    def backbone(self, amplitude: float) -> float:
        """Speed at which the undamped disc whirls freely with an amplitude [rad/s]."""
        return math.sqrt((self.stiffness + self.cubic_stiffness * amplitude**2) / self.mass)


def free_period(mass: float, stiffness: float, cubic_stiffness: float, amplitude: float) -> float:
    """Period of free undamped motion along one axis [s].

    Args:
        mass, stiffness: [kg, N/m].
        cubic_stiffness: k3 along this axis, not below 0 [N/m^3].
        amplitude: of the motion [m].

    Raises:
        ValueError: the spring softens.
    """
    ratio = cubic_stiffness * amplitude**2 / stiffness
    if ratio < 0.0:
        raise ValueError(f"cubic_stiffness = {cubic_stiffness:g} N/m^3: must not be below 0 here")
    parameter = ratio / (2.0 * (1.0 + ratio))
    return float(4.0 * ellipk(parameter) / math.sqrt(stiffness / mass * (1.0 + ratio)))
