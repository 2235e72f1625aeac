"""Equal point weights at one angle: whether a difference between them grows.

A turn of one that another undoes changes no moment, so the rotor does not answer it.  With the mean
acceleration a of the track's centre in the rotor's frame it obeys

    kappa R (delta'' + d delta') = Re(a e^{-i theta}) delta.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..assembly import Assembly
from ..linear.balanced import WeightTable
from .response import Response
from .search import moment_without_weights


def difference_growth(assembly: Assembly, speed: float, angles: Array) -> Array:
    """Growth rate (K,) [1/s] of a difference between each weight and an equal one beside it.

    Args:
        speed: of the rotor [rad/s].
        angles: (K,) of all weights, at rest in the rotor [rad].

    Raises:
        ValueError: the rotor has dry friction, or no bounded response at this speed.
    """
    rotor, table = assembly.loaded_rotor, WeightTable.of(assembly)
    rotor.refuse_sliders("the response to weights that stand together")
    moment = moment_without_weights(assembly)
    moment += (table.moment * np.exp(1j * angles)) @ rotor.planes[table.plane]
    centre = rotor.planes[table.plane] @ Response.of(rotor, speed, 2).direct[0] @ moment
    centre += [m.offset for m in assembly.weights for _ in m.angles]
    pull = -(speed**2) * (centre * np.exp(-1j * angles)).real / table.kappa_radius
    half = table.damping_rate / 2.0
    return np.asarray(np.sqrt(half**2 + pull + 0j).real - half)
