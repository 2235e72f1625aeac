"""Equal point weights at one angle: whether a difference between them grows.

A turn of one that another undoes changes no moment, so the rotor does not answer it.  With the mean
acceleration a of the track's centre in the rotor's frame it obeys

    kappa R (delta'' + d delta') = Re(a e^{-i theta}) delta.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arrays import Array
from ..assembly import Assembly
from ..harmonic_balance import unbalance_response
from .weight_table import WeightTable


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
    moment = rotor.unbalance + (table.moment * np.exp(1j * angles)) @ rotor.planes[table.plane]
    for mounted in assembly.weights:  # added masses on tracks that are off centre
        mass = mounted.device.added_mass
        moment = moment + mass * mounted.offset * rotor.planes[mounted.plane]
    x, y = unbalance_response(replace(rotor, unbalance=moment), [speed])[0]
    centre = rotor.planes[table.plane] @ (x + 1j * y) / 2.0  # the mean in the rotor's frame
    centre += [m.offset for m in assembly.weights for _ in m.angles]
    pull = -(speed**2) * (centre * np.exp(-1j * angles)).real / table.kappa_radius
    half = table.damping_rate / 2.0
    return np.asarray(np.sqrt(half**2 + pull + 0j).real - half)
