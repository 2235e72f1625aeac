"""Radau IIA collocation of any number of stages: L-stable, of order 2 s - 1.

Hairer & Wanner 1996, IV.5.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def radau(stages: int) -> tuple[NDArray, NDArray]:
    """Nodes c (s,) and matrix a (s, s) of Radau IIA on [0, 1]; the weights are a's last row."""
    polynomial = np.zeros(stages + 1)
    polynomial[-2:] = -1.0, 1.0  # P_s - P_{s-1}: the last node is 1
    points = np.sort(np.polynomial.legendre.legroots(polynomial).real)
    # the roots are eigenvalues, right to some digits less than Newton's method makes of them
    points -= np.polynomial.legendre.legval(points, polynomial) / np.polynomial.legendre.legval(
        points, np.polynomial.legendre.legder(polynomial)
    )
    points[-1] = 1.0
    # a_ij = integral of the j-th Lagrange polynomial to c_i, in the well-conditioned Legendre basis
    basis = np.polynomial.legendre.legvander(points, stages - 1)
    integrals = np.empty((stages, stages))
    for k in range(stages):
        integral = np.polynomial.legendre.legint(np.eye(stages)[k], lbnd=-1)
        integrals[:, k] = np.polynomial.legendre.legval(points, integral) / 2.0
    return (points + 1.0) / 2.0, integrals @ np.linalg.inv(basis)
