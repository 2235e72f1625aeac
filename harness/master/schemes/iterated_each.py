"""Iterated for signals that measure different things: each is compared with its own largest value.

Order and stability are those of `Iterated`.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import LoopError
from ..limits import GAIN_ROUNDING, JACOBIAN_CHANGE
from ..loop import QuasiNewton, Vector
from ..system import System
from .iterated import Iterated

FLOOR = 1e-12  # of the largest of all signals: what is smaller is what sums leave of larger parts
CONVERGED = 1e-9  # residual over the largest value so far: solvers inside units are no better
LEFT = 1e-4  # residual that is reported; one beyond ends the run
UNKNOWN = 1e-3  # disturbance of a signal that has been zero so far, in its own unit


class IteratedEach(Iterated):
    """Implicit scheme with rollback for units of any origin.

    Args:
        count: of rows, see `network.rows`.
        step: [s].
        corrections: corrector passes of every step, or None to go on until converged.
    """

    def __init__(self, count: int, step: float, corrections: int | None = None) -> None:
        super().__init__(np.zeros((4 * count, 4 * count)), step, 3, corrections)
        self.largest = np.zeros(2 * count)
        self.tolerance = max(CONVERGED, GAIN_ROUNDING * self.newton.gain)

    def check_agreement(self, system: System, time: float, residual: float) -> bool:
        """Whether the signals agree well enough.

        Raises:
            LoopError: they do not agree.
        """
        if not residual > (self.tolerance if self.corrections is None else LEFT):
            return True
        if not residual <= (LEFT if self.corrections is None else 1.0):
            raise LoopError(
                f"the loop did not converge at t = {time:g} s: {', '.join(system.force_names[:4])} "
                f"still changes by {residual:.2g} of its largest value; use smaller steps, or more "
                "corrections"
            )
        return False

    def _solver(self, step: float) -> QuasiNewton:
        return self.newton

    def _grown(self, answers: Vector) -> NDArray[np.float64]:
        return np.asarray(np.maximum(self.largest, _parts(answers)))

    def _share(self, residual: Vector, largest: Any) -> float:
        scale = np.maximum(largest, FLOOR * largest.max(initial=0.0))
        apart = _parts(residual)
        shares = np.divide(apart, scale, out=np.zeros_like(apart), where=scale > 0.0)
        return float(shares.max(initial=0.0))

    def _disturbance(self, u: Vector, g_u: Vector) -> NDArray[np.float64]:
        sizes = np.maximum(np.maximum(_parts(u), _parts(g_u)), self.largest)
        sizes = np.maximum(sizes, FLOOR * sizes.max(initial=0.0))
        change = np.where(sizes > 0.0, JACOBIAN_CHANGE * sizes, UNKNOWN)
        return np.asarray(np.repeat(change.reshape(-1, 1, 2), 2, axis=1).ravel())


def _parts(vector: Vector) -> NDArray[np.float64]:
    """(2 rows,) moduli of the real signals, of value or slope times the step the larger one."""
    return np.asarray(np.abs(vector.view(float)).reshape(-1, 2, 2).max(axis=1).ravel())
