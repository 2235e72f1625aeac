"""The steady whirl: every weight periodic in the rotor, by harmonic balance on points of a turn.

With theta_k(beta) of period half a revolution the moments are known, the rotor's answer follows
from `Response`, and what is left are the weights' equations (Filimonikhina 2017 (4)) at N points,

    w^2 theta'' + d w theta' + Im(a e^{-i theta})/(kappa R) = 0,    ' = d/d beta,

a the acceleration of the track's centre in the rotor's frame.  Newton's method on all of them; on
an isotropic rotor the weights stand still in it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..assembly import Assembly
from ..linear.balanced import WeightTable
from .response import Complex, Response, points, series, wave_numbers

_CONVERGED = 1e-9  # rad: Newton's last turn; it squares the error
_NEWTON = 40  # iterations: quadratic near the end, half a radian a step before it
_LONGEST_TURN = 0.5  # rad per iteration: a longer one leaves the neighbourhood of the start
_BALANCED = 1e-9  # of w^2: what is left of a weight's equation; rounding leaves 1e-13
_RANK = 1e-9  # turns of weights on a plane that rests change nothing: least turns among them
_UNFELT = 1e-9  # smaller singular values of the moments by the angles are rounding
_RESOLVED = 1e-9  # rad: the highest harmonics of the weights' angles
FEWEST, MOST = 16, 128  # points over half a revolution


class NoWhirl(ValueError):
    """No steady whirl was found."""


@dataclass(frozen=True, eq=False)
class Whirl:
    """A motion that repeats every half revolution in the rotor's frame.

    Attributes:
        assembly: whose; weights that touch are one there.
        speed: w [rad/s].
        theta: (N, K) angles of the weights in the rotor at `response.points` [rad].
        z: (N, n) coefficients of the stations' displacement, rotor's frame [m].
        acceleration: (N, K) of the centres of the weights' tracks at the points, the same [m/s^2].
        family: (K, m) orthonormal turns along which the weights drift among positions of the same
            moments, and were held.
        drift: how fast they do [rad/s].
    """

    assembly: Assembly
    speed: float
    theta: Array
    z: Complex
    acceleration: Complex
    family: Array
    drift: float

    @property
    def angles(self) -> Array:
        """Mean angles of the weights in the rotor (K,) [rad]."""
        return self.theta.mean(axis=0)

    @cached_property
    def amplitude(self) -> Array:
        """Largest distance of each station from its middle (n,) [m]."""
        beta = math.pi * np.arange(_ORBIT) / _ORBIT
        return np.abs(series(self.z, beta)).max(axis=0)

    def rotor_at(self, beta: float) -> tuple[Complex, Complex]:
        """Displacement and velocity x + i y of the stations in fixed axes, (n,) [m, m/s]."""
        k = wave_numbers(len(self.z))
        rates = 1j * self.speed * (1 + 2 * k)
        turned = self.z * np.exp(1j * (1 + 2 * k) * beta)[:, None]
        return turned.sum(axis=0), rates @ turned

    def weights_at(self, beta: Array) -> tuple[Array, Array, Array]:
        """Angle, rate and acceleration of the weights in the rotor (b, K) [rad, rad/s, rad/s^2]."""
        coefficients = np.fft.fft(self.theta, axis=0) / len(self.theta)
        slopes = _slopes(len(self.theta))[:, None]
        parts = [coefficients * (self.speed * slopes) ** power for power in range(3)]
        theta, rate, change = (series(part, beta).real for part in parts)
        return theta, rate, change


_ORBIT = 180  # points of an orbit: its largest radius is then known to 2e-4 of its flattening


def _slopes(count: int) -> Complex:
    """d/d beta of the harmonics (N,); the highest has no sine and counts as constant."""
    k = wave_numbers(count)
    return np.where(2 * np.abs(k) == count, 0.0, 2j * k)


class _Equations:
    """Residual and Jacobian of all weights' equations at N points."""

    def __init__(self, assembly: Assembly, speed: float, count: int, planes: Sequence[int]) -> None:
        self.assembly, self.speed, self.count = assembly, speed, count
        self.table = table = WeightTable.of(assembly)
        self.drifting = np.isin(table.plane, planes)
        self.rotor = rotor = assembly.loaded_rotor
        self.response = response = Response.of(rotor, speed, count)
        self.rows = rotor.planes[table.plane]  # (K, n): of each weight
        self.fixed = np.zeros((count, rotor.stations), complex)
        offsets = [m for m in assembly.weights if m.offset]
        self.fixed[0] = rotor.unbalance + sum(
            m.device.added_mass * m.offset * rotor.planes[m.plane] for m in offsets
        )
        self.offset = np.array([m.offset for m in assembly.weights for _ in m.angles], complex)
        swift = -(response.rates()[:, None] ** 2)
        given = np.fft.ifft(swift * response.displacement(self.fixed), axis=0, norm="forward")
        # what acts on a weight whatever the weights do, (N, K)
        self.given = given @ self.rows.T - speed**2 * self.offset
        self.a, self.b = response.at_points(self.rows)
        unit = np.fft.fft(np.eye(count), axis=0)
        curves = -4.0 * wave_numbers(count) ** 2
        first, second = (
            np.fft.ifft(factor[:, None] * unit, axis=0).real for factor in (_slopes(count), curves)
        )
        drag = np.array(table.damping_rate)
        self.inertia = speed**2 * second[:, :, None] + speed * first[:, :, None] * drag

    def acceleration(self, theta: Array) -> Complex:
        """Of every weight's centre of track at the points (N, K)."""
        moments = self.table.moment * np.exp(1j * theta)
        moved = np.tensordot(self.a, moments, 2) + np.tensordot(self.b, np.conj(moments), 2)
        return self.given + moved

    def __call__(self, theta: Array) -> tuple[Array, Array]:
        """Residual (N K,) and Jacobian (N K, N K) [rad/s^2]."""
        back = np.exp(-1j * theta)
        across = self.acceleration(theta) * back / self.table.kappa_radius
        residual = np.einsum("ijk,jk->ik", self.inertia, theta - theta[0]) + across.imag
        turned = 1j * self.table.moment * np.exp(1j * theta)
        moved = self.a * turned + self.b * np.conj(turned)
        jacobian = (moved * (back / self.table.kappa_radius)[:, :, None, None]).imag
        here = np.arange(self.count)
        for k in range(theta.shape[1]):
            jacobian[:, k, :, k] += self.inertia[:, :, k]
            jacobian[here, k, here, k] -= across[:, k].real
        return residual.ravel(), jacobian.reshape(theta.size, theta.size)

    def family(self, theta: Array) -> Array:
        """Turns (K, m), orthonormal, of weights that may drift: they change no mean moment."""
        return unfelt_turns(self.table, self.rows, theta.mean(axis=0), self.drifting)

    def neutral_turns(self, theta: Array) -> Array:
        """The same as turns at all points (N K, m), orthonormal."""
        everywhere = np.full((self.count, 1), 1.0 / math.sqrt(self.count))
        return np.kron(everywhere, self.family(theta)).astype(float)

    def whirl(self, theta: Array) -> Whirl:
        """The motion with the weights there."""
        moments = self.fixed + np.fft.fft(
            (self.table.moment * np.exp(1j * theta)) @ self.rows, axis=0, norm="forward"
        )
        z = self.response.displacement(moments)
        family = self.family(theta)
        pushed = family @ (family.T @ self(theta)[0].reshape(theta.shape).mean(axis=0))
        drift = np.abs(pushed) / np.maximum(self.table.damping_rate, np.finfo(float).tiny)
        largest = float(drift.max(initial=0.0))
        return Whirl(self.assembly, self.speed, theta, z, self.acceleration(theta), family, largest)


def unfelt_turns(table: WeightTable, rows: Array, angles: Array, which: NDArray) -> Array:
    """Turns (K, m), orthonormal, of some weights (K,) that change the moment of no station.

    Args:
        rows: (K, n), of each weight's plane.
        angles: of the weights (K,) [rad].
    """
    on = np.flatnonzero(which)
    if not len(on):
        return np.zeros((len(angles), 0))
    moments = (1j * np.exp(1j * angles[on]) * table.moment[on])[:, None] * rows[on]
    _, values, turns = np.linalg.svd(np.vstack([moments.real.T, moments.imag.T]))
    rank = int((values > _UNFELT * values.max()).sum())
    turning = np.zeros((len(angles), len(on) - rank))
    turning[on] = turns[rank:].T
    return turning


def whirl_near(
    assembly: Assembly, speed: float, theta: Array, drifting: Sequence[int] = ()
) -> Whirl:
    """The whirl that Newton's method finds from angles of the weights.

    Args:
        speed: w [rad/s].
        theta: (K,) [rad], or (N, K) at the points of another whirl.
        drifting: planes whose weights are held where they would drift among positions of the same
            moment.

    Raises:
        NoWhirl: it does not converge, or its harmonics need more than `MOST` points.
        ValueError: an undamped rotor has no bounded response.
    """
    count = FEWEST if not assembly.rotor.isotropic else 2
    while count <= MOST:
        equations = _Equations(assembly, speed, count, drifting)
        solution = _newton(equations, _resampled(np.atleast_2d(theta), count))
        if solution is None:
            raise NoWhirl(f"no steady whirl found at {speed:g} rad/s from these angles")
        theta = solution
        highest = np.abs(np.fft.fft(theta, axis=0, norm="forward")[count // 2])
        if count == 2 or highest.max(initial=0.0) <= _RESOLVED:
            return equations.whirl(theta)
        count *= 2
    raise NoWhirl(f"at {speed:g} rad/s the weights' motion needs more than {MOST} harmonics")


def _newton(equations: _Equations, theta: Array) -> Array | None:
    for _ in range(_NEWTON):
        residual, jacobian = equations(theta)
        if equations.drifting.any():
            neutral_turns = equations.neutral_turns(theta)
            residual = residual - neutral_turns @ (neutral_turns.T @ residual)
            jacobian = jacobian - neutral_turns @ (neutral_turns.T @ jacobian)
            jacobian = jacobian - (jacobian @ neutral_turns) @ neutral_turns.T
        turn = np.linalg.lstsq(jacobian, -residual, rcond=_RANK)[0].reshape(theta.shape)
        longest = float(np.abs(turn).max(initial=0.0))
        theta = theta + turn * min(1.0, _LONGEST_TURN / longest if longest > 0.0 else 1.0)
        if longest <= _CONVERGED:
            left, neutral_turns = equations(theta)[0], equations.neutral_turns(theta)
            left = np.abs(left - neutral_turns @ (neutral_turns.T @ left)).max()
            return theta if left <= _BALANCED * equations.speed**2 else None
    return None


def _resampled(theta: Array, count: int) -> Array:
    """Angles at N points of a motion given at others, (N, K)."""
    if len(theta) == count:
        return theta
    coefficients = np.fft.fft(theta, axis=0, norm="forward")
    coefficients[2 * np.abs(wave_numbers(len(theta))) == len(theta)] = 0.0
    return series(coefficients, points(count)).real
