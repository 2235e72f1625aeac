"""The path of weights' centres on a race that is not round.

The centre of a weight at the angle th in the rotor is at e + rho e^{i th} from that of its plane,

    rho(th) = R + sum eps_n cos n(th - th_n):

e is the offset of a race that is off centre, exactly; n = 1 the same to first order, n = 2 an oval,
n = 3 and more lobes.  Along the path it moves by l = |rho' + i rho| for each radian.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .arrays import Array
from .weights import Lobes, Weights

MOST_LOBES = 1000  # around a race


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


def arms(weights: Weights, angles: Array) -> Array:
    """Distance of weights at `angles` [rad] from the track's centre [m], of their shape."""
    return path(weights.track_radius, weights.race, np.asarray(angles, float))[0]
