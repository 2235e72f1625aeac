"""The speeds at which waves in a ring of liquid make a planar rotor unstable, in closed form.

Without any damping, on supports that are alike in x and y, a whirl nu = x w obeys

    k/w^2 = kappa(x) = x^2 (M + m_L (x^2 - 4 x + 2)/((1 + f) x^2 - 4 x + 2)),

with real x at every speed but between two stationary values of kappa, where two of the four whirls
meet and become complex.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.polynomial import Polynomial

from ..assembly import Assembly
from ..ring import Ring

_REAL = 1e-9  # |Im| of a root below it is rounding


def ring_of(assembly: Assembly) -> tuple[float, float, Ring]:
    """Mass M, stiffness k and ring of a planar rotor with one ring and nothing else.

    Raises:
        ValueError: the assembly is another one; the message says in what.
    """
    rotor = assembly.rotor
    if rotor.stations != 1 or not rotor.isotropic:
        raise ValueError("the closed form is for a planar rotor, equal stiffness in x and y")
    if len(assembly.balancers) != 1 or not assembly.rings:
        raise ValueError("the closed form is for exactly one balancer, a ring of liquid")
    device = assembly.rings[0].device
    assert isinstance(device, Ring)
    return float(rotor.mass[0, 0]), float(rotor.stiffness_x[0, 0]), device


def critical_speed(mass: float, stiffness: float, ring: Ring) -> float:
    """Speed at which unbalance excites the rotor with its liquid, undamped [rad/s]."""
    return math.sqrt(stiffness / (mass + ring.liquid_mass / (1.0 - ring.hollow)))


def unstable_band(mass: float, stiffness: float, ring: Ring) -> tuple[float, float]:
    """Lowest and highest speed of the unstable band without damping [rad/s].

    Args:
        mass: of the rotor without liquid [kg].
        stiffness: of the supports [N/m].
    """
    x = Polynomial([0.0, 1.0])
    below = (1.0 + ring.hollow) * x**2 - 4.0 * x + 2.0
    above = x**2 * (mass * below + ring.liquid_mass * (x**2 - 4.0 * x + 2.0))
    roots = (above.deriv() * below - above * below.deriv()).roots()
    real = roots.real[np.abs(roots.imag) < _REAL]
    kappa = np.asarray(above(real) / below(real))
    edges = np.sqrt(stiffness / kappa[kappa > 1e-9 * mass])
    return float(edges.min()), float(edges.max())
