"""Gauss-Seidel: the rotor steps first on extrapolated forces, the balancers on what it did.

Order: 1 (held), 2 (linear), 3 (cubic: the first step has no past to extrapolate); accelerations are
interpolated.
Stability: the loop gain must be below 1 whatever the step, as for Jacobi; with linear signals below
1/3 where force opposes acceleration, with cubic ones below 1/13.  The error of the accelerations is
gone.  With `loop`, any gain but 1, see `Scheme.agreed`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..signals import cubics_from_start
from ..system import System
from .explicit import Scheme, extrapolated, spectral_radius


class GaussSeidel(Scheme):
    """Explicit scheme, rotor before balancers."""

    @classmethod
    def amplification(cls, eigenvalues: Sequence[complex], order: int) -> float:
        """One extrapolation on the way round the loop."""
        if order != 1:
            return extrapolated(eigenvalues, order)
        # the balancers see the straight line between accelerations and answer with its slope
        return spectral_radius(np.array([[j, j], [j - 1.0, j]]) for j in eigenvalues)

    def step(self, system: System, time: float, step: float, jump: bool = False) -> float:
        """One step; over a jump of the drive a line from before it to after it says nothing."""
        forces = system.forces.predicted(system.order)
        motion = system.rotor_pass(forces, time, step)
        accelerations = cubics_from_start(motion)
        if not jump:
            accelerations = system.accelerations.to(motion, step, system.order)
        answers = system.balancer_pass(accelerations, time, step)
        # the next extrapolation starts from what the balancers really did
        system.accept(motion, self.agreed(system, forces, answers, step), time, step)
        return 0.0
