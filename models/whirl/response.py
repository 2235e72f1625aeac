"""What a moment that turns with the rotor does to it, harmonic by harmonic.

In the rotor's frame a steady whirl repeats every half revolution: with beta the rotor's angle,

    p(beta) = sum_k p_k e^{2 i k beta},   k = -H .. H-1,   N = 2 H points beta_j = pi j/N,

which fixed axes see as the odd harmonics 1 + 2 k.  There the rotor is linear: x and y answer the
pull -(d/dt)^2 of the moment p e^{i beta}, and anisotropy ties k to -1 - k, forward to backward.  An
isotropic rotor ties nothing, and two points hold its constant motion.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..rotor import LinearRotor

Complex = NDArray[np.complex128]


def points(count: int) -> Array:
    """Angles beta_j of the rotor (N,) over half a revolution [rad]."""
    return math.pi * np.arange(count) / count


def wave_numbers(count: int) -> NDArray[np.int_]:
    """k of the harmonics e^{2 i k beta} (N,), in the order of NumPy's transform."""
    return np.rint(np.fft.fftfreq(count, 1.0 / count)).astype(int)


def series(coefficients: Complex, beta: Array) -> Complex:
    """Values (b, ...) at angles (b,) of a series with coefficients (N, ...)."""
    k = wave_numbers(len(coefficients))
    return np.tensordot(np.exp(2j * np.outer(beta, k)), coefficients, 1)


@dataclass(frozen=True, eq=False)
class Response:
    """Displacement of every station by the moment's harmonics, both in the rotor's frame.

    z_k = direct[k] p_k + crossed[k] conj(p_{-1-k}).

    Attributes:
        direct, crossed: (N, n, n) [1/kg], k in the order of NumPy's transform.
        speed: w [rad/s].
    """

    direct: Complex
    crossed: Complex
    speed: float

    @classmethod
    def of(cls, rotor: LinearRotor, speed: float, count: int) -> Response:
        """Of a rotor with its balancers' added masses, with N = `count` points.

        Raises:
            ValueError: an undamped rotor turns at a speed that a harmonic makes a critical one.
        """
        n, order = rotor.stations, 1 + 2 * wave_numbers(count)
        direct = np.zeros((count, n, n), complex)
        crossed = np.zeros((count, n, n), complex)
        mass, damping, stiffness = rotor.real_coefficients(speed)
        # x, y = Re(turn [p_m; conj p_-m] e^{i m beta}) for m > 0
        turn = np.kron(np.array([[1.0, 1.0], [-1j, 1j]]), np.eye(n))
        back = np.conj(turn.T) / 2.0
        for k in np.flatnonzero(order > 0).tolist():
            rate = speed * float(order[k])
            dynamic = stiffness - rate**2 * mass + 1j * rate * damping
            try:
                both = back @ np.linalg.solve(dynamic, rate**2 * turn)
            except np.linalg.LinAlgError:
                raise ValueError(
                    f"speed = {speed:g} rad/s: an undamped rotor has no bounded response there"
                ) from None
            direct[k], crossed[k] = both[:n, :n], both[:n, n:]
            partner = -1 - k  # the index from the end: k = 0, 1, .. first, -1, -2, .. last
            direct[partner], crossed[partner] = np.conj(both[n:, n:]), np.conj(both[n:, :n])
        return cls(direct, crossed, speed)

    def displacement(self, moment: Complex) -> Complex:
        """Coefficients (N, n) [m] by those of the moment on the stations, (N, n) [kg m]."""
        mirrored = np.conj(moment[::-1])  # p_{-1-k}
        return np.einsum("kij,kj->ki", self.direct, moment) + np.einsum(
            "kij,kj->ki", self.crossed, mirrored
        )

    def rates(self) -> Array:
        """(1 + 2 k) w, (N,) [rad/s]: what a harmonic turns with in fixed axes."""
        return np.asarray(self.speed * (1.0 + 2.0 * wave_numbers(len(self.direct))), float)

    def at_points(self, rows: Array) -> tuple[Complex, Complex]:
        """Acceleration of planes, A m + B conj(m), by the planes' moments m, point by point.

        Args:
            rows: (p, n), of the planes.

        Returns:
            A, B, (N, p, N, p): acceleration at point i of plane a by the moment at j of b [1/s^2
            per kg, rotor's frame].
        """
        count = len(self.direct)
        beta, k = points(count), wave_numbers(count)
        swift = -(self.rates()[:, None, None] ** 2) / count
        direct, crossed = (swift * (rows @ part @ rows.T) for part in (self.direct, self.crossed))
        ahead = np.exp(2j * np.outer(beta, k))
        mirror = np.exp(-2j * np.outer(k + 1, beta))
        a = np.einsum("ik,kab,kj->iajb", ahead, direct, np.conj(ahead.T), optimize=True)
        b = np.einsum("ik,kab,kj->iajb", ahead, crossed, mirror, optimize=True)
        return a, b
