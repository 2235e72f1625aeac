"""What the explicit schemes share: when extrapolation is stable.

With a loop eigenvalue J (force answered per force assumed) an exchange of held signals repeats a
disturbance of the force J-fold, whatever the step.  The cubic Hermite extrapolation amplifies it
first: values and slopes of two steps, taken to the end of the next, follow
e(n+1) = J (NOW e(n) + BEFORE e(n-1)), stable for J between -0.0873 and 1/13.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ....models.constants import JUMP_PARTS
from ..system import System

# value and slope at t = 2 of the cubic through values and slopes at t = 0 (BEFORE) and 1 (NOW)
NOW = np.array([[-4.0, 4.0], [-12.0, 8.0]])
BEFORE = np.array([[5.0, 2.0], [12.0, 5.0]])


class Explicit:
    """No rollback; forces are assumed for a step and answered at its end."""

    name = "explicit"
    startup_halvings = 0
    miss_per_error = 4.0  # the prediction itself is stepped on: its miss over its mean error
    extrapolations = 1  # that a force passes through on its way round the loop

    def advance(self, system: System, time: float, step: float, jump: bool = False) -> None:
        """Take one step; `jump`: over a jump of the drive."""
        raise NotImplementedError

    def step(self, system: System, time: float, step: float) -> float:
        """One step; without a second pass there is no residual."""
        self.advance(system, time, step)
        return 0.0

    def cross_jump(self, system: System, time: float, step: float) -> None:
        """A negligible step at a jump of the drive, in parts that settle force and acceleration.

        Each part takes from its predecessor's answer what the loop returns of the jump; after one
        alone a share of the size of the loop gain would be left.
        """
        part = step / JUMP_PARTS
        for number in range(JUMP_PARTS):
            self.advance(system, time + number * part, part, jump=True)
            system.drop_past()

    def after_start(self, system: System, time: float, step: float) -> None:
        """Nothing: no Jacobian is used."""

    def check_agreement(self, system: System, time: float, residual: float) -> bool:
        """Always converged: there is nothing to iterate."""
        return True

    @classmethod
    def amplification(cls, eigenvalues: Sequence[complex], order: int) -> float:
        """Largest factor by which a short step repeats a disturbance; stable up to 1."""
        roots = [complex(j) ** (1.0 / cls.extrapolations) for j in eigenvalues]
        if order < 3:
            return max(map(abs, roots), default=0.0)
        return max((_hermite_amplification(root) for root in roots), default=0.0)


def _hermite_amplification(eigenvalue: complex) -> float:
    companion = np.block([[eigenvalue * NOW, eigenvalue * BEFORE], [np.eye(2), np.zeros((2, 2))]])
    return float(np.abs(np.linalg.eigvals(companion)).max())
