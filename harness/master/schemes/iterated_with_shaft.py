"""Iterated where a motor drives the rotor: forces, and the shaft's acceleration for itself.

Order and stability are those of `Iterated`.  A motor accelerates a shaft at rest by far more than
the forces do: measured by it, the loop would stop at forces that are still wrong.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..limits import JACOBIAN_CHANGE
from ..loop import Vector, size
from .iterated import Iterated

SHAFT = slice(-2, None)  # of a vector: value and slope of the last row
FLOOR = (
    1e-3  # of the forces: a smaller acceleration of the shaft, counted as a force, moves nothing
)


class IteratedWithShaft(Iterated):
    """Implicit scheme with rollback for a rotor before a motor; arguments as of `Iterated`."""

    def _least(self, force: float) -> NDArray[np.float64]:
        return np.array([force, 0.0])

    def _grown(self, answers: Vector) -> NDArray[np.float64]:
        return np.asarray(np.maximum(self.largest, _sizes(answers)))

    def _share(self, residual: Vector, largest: Any) -> float:
        scale = np.array([largest[0], max(largest[1], FLOOR * largest[0])])
        apart = _sizes(residual)
        shares = np.divide(apart, scale, out=np.zeros(2), where=scale > 0.0)
        return float(shares.max())

    def _disturbance(self, u: Vector, g_u: Vector) -> NDArray[np.float64]:
        forces, shaft = np.maximum(np.maximum(_sizes(u), _sizes(g_u)), self.largest).tolist()
        either = forces or shaft
        change = np.full(2 * len(u), JACOBIAN_CHANGE * either)
        change[2 * len(u) - 4 :] = JACOBIAN_CHANGE * (shaft or either)
        return change


def _sizes(vector: Vector) -> NDArray[np.float64]:
    """Largest modulus of the forces, and of the shaft's acceleration."""
    return np.array([size(vector[: SHAFT.start]), size(vector[SHAFT])])
