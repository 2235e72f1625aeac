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

from ..arrays import Array, Complex, Indices
from ..rotor import LinearRotor
from .coefficients import Coefficients

_STILL = 1e-6  # |Im|/|lambda| below it does not oscillate
_ON_ONE_THREAD = 50_000  # multiplications of a product of matrices
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
    """Of a rotor that carries its balancers, between the planes of its weights.

    The displacements (x, y) of the planes are written as a forward and a backward part,
    F (1, -i) + B (1, i): a force that turns acts on the forward part alone, and weights that turn
    with the rotor act on each part by itself.  Where both axes are alike the forward part is all
    there is.  q = p such parts there, otherwise q = 2p, the forward ones first.

    Args:
        rotor: n stations.
        planes: indices of p of its planes; default: all.
    """

    def __init__(self, rotor: LinearRotor, planes: Indices | None = None) -> None:
        self.rotor = rotor
        self.coefficients = Coefficients(rotor)
        self._mass = self.coefficients.mass
        self._inverse = np.linalg.inv(self._mass)
        self.follows_speed = self.coefficients.follow_speed
        used = (rotor.planes if planes is None else rotor.planes[planes]).astype(complex)
        self.plane_count = len(used)
        one = np.eye(len(used))
        turning = np.block([[one, one], [-1j * one, 1j * one]])
        both = used if rotor.isotropic else np.kron(np.eye(2), used)
        self._out = both if rotor.isotropic else 0.5 * turning.conj().T @ both
        self._into = both.T if rotor.isotropic else both.T @ turning
        self._forces = self._into[:, : len(used)]
        # (q q, 4): by the elements of the inverse of a dynamic stiffness
        self._around = np.kron(self._out, self._into.T) if len(self._mass) == 2 else self._out
        self.parts = 1 if rotor.isotropic else 2
        self._motion: tuple[float, Complex, Complex] | None = None
        self._kept: tuple[float, tuple[Complex, Complex] | None] | None = None

    def of_planes(self, frequency: Array, speed: float | Array) -> Complex:
        """Receptance (q, q, r, j) of the parts of the planes' displacements [m/N].

        Args:
            frequency: w (r, j).
            speed: of the rotor, one or (r,).
        """
        shape = len(self._out), len(self._out), *frequency.shape
        one = 0.0 if not self.follows_speed else float(speed) if np.ndim(speed) == 0 else None
        if one is not None and (parts := self._parts(one)) is not None:
            rates, residues = parts
            apart = 1j * frequency.reshape(-1) - rates[:, None]
            apart[apart == 0.0] = np.finfo(float).tiny  # at a natural frequency without damping
            return _in_parts(residues, 1.0 / apart).reshape(shape)
        speeds = np.broadcast_to(np.reshape(speed, (-1, 1)), frequency.shape)
        dynamic = self._dynamic(frequency.reshape(-1), speeds.reshape(-1))
        if len(self._mass) == 2:
            return np.asarray(self._around @ inverse_of_two(dynamic)).reshape(shape)
        moved = self._out @ np.linalg.solve(dynamic, self._into[None])
        return np.ascontiguousarray(np.moveaxis(moved, 0, -1)).reshape(shape)

    def _parts(self, speed: float) -> tuple[Complex, Complex] | None:
        """Eigenvalues (m,) [1/s] and residues (q q, m) of the receptance, None where they fail.

        Kept for one speed: many frequencies are looked at while the rotor turns at one.
        """
        if self._kept is None or self._kept[0] != speed:
            self._kept = speed, self._find_parts(speed)
        return self._kept[1]

    def _find_parts(self, speed: float) -> tuple[Complex, Complex] | None:
        size = len(self._mass)
        rates, vectors = self._free(speed)
        if np.linalg.cond(vectors) > _WORST_VECTORS:
            return None
        acting = np.zeros((2 * size, len(self._out)), complex)
        acting[size:] = np.linalg.solve(self._mass, self._into)
        left = np.linalg.solve(vectors, acting)
        residues = np.einsum("pm,mq->pqm", self._out @ vectors[:size], left)
        return rates.astype(complex), residues.reshape(-1, len(rates))

    def _free(self, speed: float) -> tuple[Complex, Complex]:
        """Eigenvalues (m,) and eigenvectors (m, m) of the free motion, kept for one speed."""
        if self._motion is None or self._motion[0] != speed:
            self._motion = speed, *np.linalg.eig(self._first_order(np.array([speed]))[0])
        return self._motion[1:]

    def between_planes(self, planes: Complex, others: Complex) -> Complex:
        """g (p, p, r, j) from `of_planes`, with weights that turn with the rotor.

        Args:
            others: (q, r, j) force that such weights exert for each part of a plane's motion,
                beyond that of their mass [N/m].
        """
        count = self.plane_count
        if not others.any():
            return planes[:count, :count]
        if len(planes) == 2:
            return _with_two(planes, others)
        system = np.empty((len(planes), count + len(planes), *others.shape[1:]), complex)
        system[:, :count] = planes[:, :count]
        np.multiply(planes, -others, out=system[:, count:])
        for k in range(len(planes)):
            system[k, count + k] += 1.0
        return solve_first(system)

    def displacements(
        self, frequency: Array, speed: float, forces: Complex, others: Complex
    ) -> Complex:
        """x, y = Re(found e^{i w t}), (b, 2, n) [m], for forces (b, p) that turn at (b,) [N].

        Args:
            others: (q, b), as in `between_planes`.
        """
        acting = (self._forces @ forces[..., None])[..., 0]
        own = (self._into * others.T[:, None, :]) @ self._out
        dynamic = self._dynamic(frequency, np.full(len(frequency), speed)) - own
        found = np.linalg.solve(dynamic, acting[..., None])[..., 0]
        if self.rotor.isotropic:
            return np.stack([found, -1j * found], axis=1)
        return found.reshape(len(found), 2, -1)

    def poles(self, speed: float) -> Poles:
        """Natural frequencies at a speed of the rotor."""
        values, vectors = self._free(speed)
        vectors = vectors[: len(vectors) // 2].T
        found = values.imag > _STILL * np.abs(values)
        order = np.flatnonzero(found)[np.argsort(values[found].imag)]
        modes, (damping, _) = vectors[order], self.coefficients.at(np.array([speed]))
        inertia = -2.0 * values[order].imag[:, None, None] * self._mass + 1j * damping
        slopes = np.einsum("mi,mij,mj->m", modes.conj(), inertia, modes)
        shapes = modes @ self._forces.conj()
        frequency, decay = values[order].imag.astype(float), -values[order].real.astype(float)
        return Poles(frequency, decay, shapes, slopes)

    def moved(self, poles: Poles, forward: Complex) -> Poles:
        """Natural frequencies with a force per forward displacement of the planes (p, m) [N/m]."""
        work = (forward * (np.abs(poles.shapes) ** 2).T).sum(axis=0) / self.parts
        step = work / poles.slopes
        return poles._replace(frequency=poles.frequency + step.real, decay=poles.decay + step.imag)

    def rates(self, speeds: Array) -> Complex:
        """Eigenvalues (b, m) of the free motion at speeds (b,) of the rotor [1/s]."""
        return np.linalg.eigvals(self._first_order(speeds)).astype(complex)

    def _first_order(self, speeds: Array) -> Complex:
        """Matrices (b, m, m) of displacements and velocities."""
        size, inverse = len(self._mass), self._inverse
        damping, stiffness = self.coefficients.at(speeds)
        matrix = np.zeros((len(speeds), 2 * size, 2 * size), np.result_type(self._mass, damping))
        matrix[:, :size, size:] = np.eye(size)
        matrix[:, size:, :size], matrix[:, size:, size:] = -inverse @ stiffness, -inverse @ damping
        return matrix

    def _dynamic(self, frequency: Array, speed: Array) -> Complex:
        """Dynamic stiffness (b, n, n) at frequencies and speeds (b,)."""
        w, (damping, stiffness) = frequency[:, None, None], self.coefficients.at(speed)
        return np.asarray(stiffness - w * w * self._mass + 1j * w * damping)


def _in_parts(matrix: Complex, values: Complex) -> Complex:
    """A matrix (k, m) times values (m, j), a part of the columns at a time.

    BLAS shares a larger product among threads, which wait for each other longer than it takes.
    """
    columns = max(_ON_ONE_THREAD // matrix.size, 1)
    if values.shape[1] <= columns:
        return matrix @ values
    found = np.empty((len(matrix), values.shape[1]), complex)
    for first in range(0, values.shape[1], columns):
        part = slice(first, first + columns)
        np.matmul(matrix, values[:, part], out=found[:, part])
    return found


def _with_two(g: Complex, others: Complex) -> Complex:
    """(1 - g diag(others))^-1 g of two parts."""
    (a, b), (c, d) = g
    first, second = others
    across = b * c
    left = a * d - across
    found = np.empty_like(g)
    scale = 1.0 / ((1.0 - a * first) * (1.0 - d * second) - across * first * second)
    found[0, 0], found[1, 1] = a - second * left, d - first * left
    found[0, 1], found[1, 0] = b, c
    found *= scale
    return found


def inverse_of_two(matrices: Complex) -> Complex:
    """Inverses of matrices (b, 2, 2) as rows (4, b): the adjugate divided by the determinant."""
    a, b, c, d = (np.ascontiguousarray(each) for each in matrices.reshape(-1, 4).T)
    return np.stack([d, -b, -c, a]) / (a * d - b * c)


def solve_first(system: Complex) -> Complex:
    """The first p unknowns (p, p, ...) of many small systems (q, p + q, ...).

    A system has its p right sides first, then its matrix, and is overwritten.  Gauss without
    pivoting, element by element: for a handful of unknowns several times as fast as LAPACK one by
    one.
    """
    count = len(system)
    wanted = system.shape[1] - count
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for k in range(count - 1, -1, -1):
            row, column = system[k, : wanted + k], system[:, wanted + k]
            row *= 1.0 / column[k]
            rows = max(k, wanted)
            factors = column[:rows].copy()
            if k < wanted:
                factors[k] = 0.0  # the row itself stays
            system[:rows, : wanted + k] -= factors[:, None] * row
    return system[:wanted, :wanted]
