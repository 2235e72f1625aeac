"""Receptance of a loaded rotor for forces that turn at another speed than the rotor does.

A force F e^{i w t} that turns at a plane, while the rotor turns at Om, moves the stations by

    q(t) = Re(H(i w; Om) f F e^{i w t}),   f = (1, -i) at the plane,
    H(s; Om) = (M s^2 + D(Om) s + K(Om))^{-1}

with the matrices of `LinearRotor`, which hold gyroscopic and internal damping at the speed Om of
the rotor.  The part of q that turns with such a force at plane a, for one at plane b, is

    g_ab(w; Om) = f_a^H H f_b/2,

for a rotor whose axes are alike the complex receptance of z = x + i y.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..arrays import Array, Complex
from ..rotor import LinearRotor

_STILL = 1e-6  # |Im|/|lambda| below it does not oscillate


class Poles(NamedTuple):
    """Free motions of a rotor that oscillate, by rising frequency; m of them.

    Attributes:
        frequency: (m,) at which they turn or swing [rad/s].
        decay: (m,) rate [1/s]; negative where the rotor is unstable.
        shapes: (m, p) forward part of the planes' motion, complex.
    """

    frequency: Array
    decay: Array
    shapes: Complex


class Receptance:
    """Of a rotor that carries its balancers.

    Args:
        rotor: n stations, p planes.
    """

    def __init__(self, rotor: LinearRotor) -> None:
        self.rotor = rotor
        self.follows_speed = bool(rotor.gyroscopic.any() or rotor.internal_damping.any())
        self._mass, self._damping, self._stiffness = rotor.coefficients(0.0)
        _, damping, stiffness = rotor.coefficients(1.0)
        self._damping_by_speed = damping - self._damping
        self._stiffness_by_speed = stiffness - self._stiffness
        planes = rotor.planes.astype(complex)
        self._forces = planes.T if rotor.isotropic else np.vstack([planes.T, -1j * planes.T])
        self._share = 1.0 if rotor.isotropic else 0.5

    def between_planes(self, frequency: Array, speed: float | Array) -> Complex:
        """g (b, p, p) at frequencies (b,) while the rotor turns at `speed`, one or (b,) [m/N]."""
        moved = np.linalg.solve(self._dynamic(frequency, speed), self._forces[None])
        return self._share * (self._forces.conj().T @ moved)

    def displacements(self, frequency: Array, speed: float, forces: Complex) -> Complex:
        """x, y = Re(found e^{i w t}), (b, 2, n) [m], for forces (b, p) that turn at (b,) [N]."""
        acting = (self._forces @ forces[..., None])[..., 0]
        found = np.linalg.solve(self._dynamic(frequency, speed), acting[..., None])[..., 0]
        if self.rotor.isotropic:
            return np.stack([found, -1j * found], axis=1)
        return found.reshape(len(found), 2, -1)

    def poles(self, speed: float) -> Poles:
        """Natural frequencies at a speed of the rotor."""
        values, vectors = np.linalg.eig(self.rotor.first_order(speed))
        vectors = vectors[: len(vectors) // 2].T
        found = values.imag > _STILL * np.abs(values)
        order = np.flatnonzero(found)[np.argsort(values[found].imag)]
        shapes = vectors[order] @ self._forces.conj()
        return Poles(values[order].imag, -values[order].real, shapes)

    def rates(self, speeds: Array) -> Complex:
        """Eigenvalues (b, m) of the free motion at speeds (b,) of the rotor [1/s]."""
        om, size = speeds[:, None, None], len(self._mass)
        inverse = np.linalg.inv(self._mass)
        matrix = np.zeros((len(speeds), 2 * size, 2 * size), self._mass.dtype)
        matrix[:, :size, size:] = np.eye(size)
        matrix[:, size:, :size] = -inverse @ (self._stiffness + om * self._stiffness_by_speed)
        matrix[:, size:, size:] = -inverse @ (self._damping + om * self._damping_by_speed)
        return np.linalg.eigvals(matrix).astype(complex)

    def _dynamic(self, frequency: Array, speed: float | Array) -> Complex:
        w, om = frequency[:, None, None], np.reshape(speed, (-1, 1, 1))
        damping = self._damping + om * self._damping_by_speed
        stiffness = self._stiffness + om * self._stiffness_by_speed
        return stiffness - w * w * self._mass + 1j * w * damping
