"""What a scheme is, and when extrapolation is stable.

With a loop eigenvalue J (force answered per force assumed) an exchange of held signals repeats a
disturbance of the force J-fold, whatever the step.  The cubic Hermite extrapolation amplifies it
first: values and slopes of two steps, taken to the end of the next, follow
e(n+1) = J (NOW e(n) + BEFORE e(n-1)), stable for J between -0.0873 and 1/13.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from ..limits import JUMP_PARTS
from ..loop import QuasiNewton, pack, unpack
from ..signals import Cubics, Knots
from ..system import System

# value and slope at t = 2 of the cubic through values and slopes at t = 0 (BEFORE) and 1 (NOW)
NOW = np.array([[-4.0, 4.0], [-12.0, 8.0]])
BEFORE = np.array([[5.0, 2.0], [12.0, 5.0]])


class Scheme:
    """An explicit scheme: forces are assumed for a step and answered at its end, no rollback.

    Attributes:
        startup_halvings: of the first step, in any case.
        loop: solves the loop, where forces that were assumed are to be made consistent at the end
            of a step, see `agreed`; else None.
    """

    startup_halvings = 0
    loop: QuasiNewton | None = None

    def step(self, system: System, time: float, step: float, jump: bool = False) -> float:
        """Take one step; `jump`: over a jump of the drive.

        Returns:
            Residual of the forces over the largest so far; 0 without a second pass.
        """
        raise NotImplementedError

    def agreed(self, system: System, assumed: Cubics, answers: Knots, step: float) -> Knots:
        """Forces at the end of a step that would have answered themselves.

        With an assumed end u and its answer G(u) these are u + (1 - J)^-1 (G(u) - u), J the loop's
        Jacobian (Sicklinger et al. 2014).  They do not depend on u where the loop is linear: what
        the next step extrapolates from has no error that the loop could multiply, whatever its
        gain.  Without `loop`, the answers.
        """
        if self.loop is None:
            return answers
        self.loop.rescale(step)
        ends = system.forces.ends(assumed, step)
        gap = pack(answers, step) - pack(ends, step)
        return ends + unpack(self.loop.correction(gap), step)

    def cross_jump(self, system: System, time: float, step: float) -> None:
        """A negligible step at a jump of the drive, in parts that settle force and acceleration.

        Each part takes from its predecessor's answer what the loop returns of the jump; after one
        alone a share of the size of the loop gain would be left.
        """
        part = step / JUMP_PARTS
        for number in range(JUMP_PARTS):
            self.step(system, time + number * part, part, jump=True)
            system.drop_past()

    def after_start(self, system: System, time: float, step: float) -> None:
        """Nothing: no Jacobian is used."""

    def agrees(self, residual: float) -> bool:
        """Whether a step left no more than what the scheme iterates to."""
        return True

    def check_agreement(self, system: System, time: float, residual: float) -> bool:
        """Always converged: there is nothing to iterate."""
        return True

    @classmethod
    def amplification(cls, eigenvalues: Sequence[complex], order: int) -> float:
        """Largest factor by which a short step repeats a disturbance, stable up to 1.

        0 where the loop is solved, whatever its gain.
        """
        return 0.0


def spectral_radius(matrices: Iterable[np.ndarray]) -> float:
    """Largest modulus of the eigenvalues of any of the matrices."""
    return float(max((np.abs(np.linalg.eigvals(m)).max() for m in matrices), default=0.0))


def extrapolated(eigenvalues: Sequence[complex], order: int) -> float:
    """Amplification of a loop with one extrapolation, by its eigenvalues."""
    if order < 3:
        return max(map(abs, eigenvalues), default=0.0)
    below = [np.eye(2), np.zeros((2, 2))]
    return spectral_radius(np.block([[j * NOW, j * BEFORE], below]) for j in eigenvalues)
