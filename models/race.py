"""The path of weights' centres on a race that is not round.

The centre of a weight at the angle th in the rotor is at e + rho e^{i th} from that of its plane,

    rho(th) = R + sum eps_n cos n(th - th_n):

e is the offset of a race that is off centre, exactly; n = 1 the same to first order, n = 2 an oval,
n = 3 and more lobes.  Along the path it moves by l = |rho' + i rho| for each radian.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .arrays import Array

MOST_LOBES = 1000  # around a race


@dataclass(frozen=True)
class Lobes:
    """A harmonic of a race.

    Attributes:
        order: n, number of lobes.
        amplitude: eps, half of the peak-to-valley of that order [m].
        angle: of a lobe in the rotor [rad].
    """

    order: int
    amplitude: float
    angle: float = 0.0

    @property
    def bend(self) -> float:
        """What it takes from the curvature of a circle, times the radius squared: of all lobes
        together less than the radius, or the race bends inwards [m]."""
        return max(self.order**2 - 1, 1) * self.amplitude


def path(radius: float, lobes: Sequence[Lobes], angles: Array) -> tuple[Array, Array, Array, Array]:
    """rho and its first three derivatives at `angles` [m], each of their shape."""
    rho = np.full_like(angles, radius, dtype=float)
    first, second, third = np.zeros_like(rho), np.zeros_like(rho), np.zeros_like(rho)
    for one in lobes:
        n, size = one.order, one.amplitude
        at = n * (angles - one.angle)
        cosine, sine = size * np.cos(at), size * np.sin(at)
        rho = rho + cosine
        first = first - n * sine
        second = second - n * n * cosine
        third = third + n**3 * sine
    return rho, first, second, third
