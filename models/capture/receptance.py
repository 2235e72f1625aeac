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

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Complex
from ..rotor import LinearRotor

_STILL = 1e-6  # |Im|/|lambda| below it does not oscillate
_WORST_VECTORS = 1e7  # condition of the eigenvectors up to which a receptance is a sum over them


class Poles(NamedTuple):
    """Free motions of a rotor that oscillate, by rising frequency; m of them.

    Attributes:
        frequency: (m,) at which they turn or swing [rad/s].
        decay: (m,) rate [1/s]; negative where the rotor is unstable.
        shapes: (m, p) forward part of the planes' motion, complex.
        slopes: (m,) of the dynamic stiffness over the frequency, by the mode [N s/m].
    """

    frequency: Array
    decay: Array
    shapes: Complex
    slopes: Complex

    def select(self, rows: NDArray[Any]) -> Poles:
        """Some of them, or some several times."""
        return Poles(*(values[rows] for values in self))


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
        planes, p = rotor.planes.astype(complex), rotor.plane_count
        self._planes = planes if rotor.isotropic else np.kron(np.eye(2), planes)
        turning = np.eye(p) if rotor.isotropic else np.vstack([np.eye(p), -1j * np.eye(p)])
        self._turning = turning.astype(complex)
        self._forces = self._planes.T @ self._turning
        self._share = 1.0 if rotor.isotropic else 0.5
        self._kept: tuple[float, tuple[Complex, Complex] | None] | None = None

    def of_planes(self, frequency: Array, speed: float | Array) -> Complex:
        """Receptance of the planes' displacements, (b, p, p) or, of x and y, (b, 2p, 2p) [m/N].

        Args:
            frequency: w (b,).
            speed: of the rotor, one or (b,).
        """
        one = 0.0 if not self.follows_speed else float(speed) if np.ndim(speed) == 0 else None
        if one is not None and (parts := self._parts(one)) is not None:
            rates, residues = parts
            apart = 1j * frequency[:, None] - rates
            apart[apart == 0.0] = np.finfo(float).tiny  # at a natural frequency without damping
            found = (1.0 / apart) @ residues
            return np.asarray(found.reshape(len(frequency), *(len(self._planes),) * 2))
        moved = np.linalg.solve(self._dynamic(frequency, speed), self._planes.T[None])
        return np.asarray(self._planes @ moved)

    def _parts(self, speed: float) -> tuple[Complex, Complex] | None:
        """Eigenvalues (m,) [1/s] and residues (m, p p) of the receptance, None where they fail.

        Kept for one speed: many frequencies are looked at while the rotor turns at one.
        """
        if self._kept is None or self._kept[0] != speed:
            self._kept = speed, self._find_parts(speed)
        return self._kept[1]

    def _find_parts(self, speed: float) -> tuple[Complex, Complex] | None:
        size = len(self._mass)
        rates, vectors = np.linalg.eig(self._first_order(np.array([speed]))[0])
        if np.linalg.cond(vectors) > _WORST_VECTORS:
            return None
        acting = np.zeros((2 * size, len(self._planes)), complex)
        acting[size:] = np.linalg.solve(self._mass, self._planes.T)
        left = np.linalg.solve(vectors, acting)
        residues = np.einsum("pm,mq->mpq", self._planes @ vectors[:size], left)
        return rates.astype(complex), residues.reshape(len(rates), -1)

    def between_planes(self, planes: Complex, forward: Complex, backward: Complex) -> Complex:
        """g (b, p, p) from `of_planes`, with weights that turn with the rotor.

        Args:
            forward, backward: (b, p) force that such weights exert for the forward and the
                backward part of a plane's motion, beyond that of their mass [N/m].
        """
        found = planes
        if forward.any():
            own = self._as_matrix(forward, backward)
            found = np.linalg.solve(np.eye(planes.shape[-1]) - planes @ own, planes)
        return self._share * (self._turning.conj().T @ found @ self._turning)

    def displacements(
        self,
        frequency: Array,
        speed: float,
        forces: Complex,
        forward: Complex,
        backward: Complex,
    ) -> Complex:
        """x, y = Re(found e^{i w t}), (b, 2, n) [m], for forces (b, p) that turn at (b,) [N]."""
        acting = (self._forces @ forces[..., None])[..., 0]
        own = self._planes.T @ self._as_matrix(forward, backward) @ self._planes
        dynamic = self._dynamic(frequency, speed) - own
        found = np.linalg.solve(dynamic, acting[..., None])[..., 0]
        if self.rotor.isotropic:
            return np.stack([found, -1j * found], axis=1)
        return found.reshape(len(found), 2, -1)

    def poles(self, speed: float) -> Poles:
        """Natural frequencies at a speed of the rotor."""
        values, vectors = np.linalg.eig(self.rotor.first_order(speed))
        vectors = vectors[: len(vectors) // 2].T
        found = values.imag > _STILL * np.abs(values)
        order = np.flatnonzero(found)[np.argsort(values[found].imag)]
        modes, damping = vectors[order], self._damping + speed * self._damping_by_speed
        inertia = -2.0 * values[order].imag[:, None, None] * self._mass + 1j * damping
        slopes = np.einsum("mi,mij,mj->m", modes.conj(), inertia, modes)
        shapes = modes @ self._forces.conj()
        return Poles(values[order].imag, -values[order].real, shapes, slopes)

    def moved(self, poles: Poles, forward: Complex) -> Poles:
        """Natural frequencies with a force per forward displacement of the planes (m, p) [N/m]."""
        work = self._share * (forward * np.abs(poles.shapes) ** 2).sum(axis=1)
        step = work / poles.slopes
        found = poles._replace(frequency=poles.frequency + step.real, decay=poles.decay + step.imag)
        return found

    def _as_matrix(self, forward: Complex, backward: Complex) -> Complex:
        """Forces of the planes by their displacements, shaped as `of_planes`."""
        count = forward.shape[1]
        if self.rotor.isotropic:
            found = np.zeros((len(forward), count, count), complex)
            found[:, range(count), range(count)] = forward
            return found
        back = backward.conj()
        same, across = 0.5 * (forward + back), 0.5j * (forward - back)
        found = np.zeros((len(forward), 2 * count, 2 * count), complex)
        x, y = np.arange(count), np.arange(count) + count
        found[:, x, x] = found[:, y, y] = same
        found[:, x, y], found[:, y, x] = across, -across
        return found

    def rates(self, speeds: Array) -> Complex:
        """Eigenvalues (b, m) of the free motion at speeds (b,) of the rotor [1/s]."""
        return np.linalg.eigvals(self._first_order(speeds)).astype(complex)

    def _first_order(self, speeds: Array) -> Complex:
        """Matrices (b, m, m) of displacements and velocities."""
        om, size = speeds[:, None, None], len(self._mass)
        inverse = np.linalg.inv(self._mass)
        matrix = np.zeros((len(speeds), 2 * size, 2 * size), self._mass.dtype)
        matrix[:, :size, size:] = np.eye(size)
        matrix[:, size:, :size] = -inverse @ (self._stiffness + om * self._stiffness_by_speed)
        matrix[:, size:, size:] = -inverse @ (self._damping + om * self._damping_by_speed)
        return matrix

    def _dynamic(self, frequency: Array, speed: float | Array) -> Complex:
        w, om = frequency[:, None, None], np.reshape(speed, (-1, 1, 1))
        damping = self._damping + om * self._damping_by_speed
        stiffness = self._stiffness + om * self._stiffness_by_speed
        return stiffness - w * w * self._mass + 1j * w * damping
