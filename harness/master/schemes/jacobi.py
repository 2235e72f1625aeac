"""Jacobi: all units step side by side on extrapolated signals, as most FMI tools do.

Order: 1 (held), 2 (linear), 3 (cubic: the first step has no past to extrapolate; rarely stable).
Stability: the loop gain must be below 1 whatever the step, since a force acts one step late; with
cubic signals below 1/169 = (1/13)^2, since force and acceleration are both extrapolated.  With
`loop`, any gain but 1, see `Scheme.agreed`.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..system import System
from .explicit import Scheme, extrapolated


class Jacobi(Scheme):
    """Explicit scheme without order among the units."""

    @classmethod
    def amplification(cls, eigenvalues: Sequence[complex], order: int) -> float:
        """Two extrapolations on the way round the loop: each passes the eigenvalue's root."""
        return extrapolated([complex(j) ** 0.5 for j in eigenvalues], order)

    def step(self, system: System, time: float, step: float, jump: bool = False) -> float:
        """One step, at a jump of the drive as anywhere."""
        forces = system.forces.predicted(system.order)
        accelerations = system.accelerations.predicted(system.order)
        motion = system.rotor_pass(forces, time, step)
        answers = system.balancer_pass(accelerations, time, step)
        system.accept(motion, self.agreed(system, forces, answers, step), time, step)
        return 0.0
