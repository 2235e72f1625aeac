"""Gauss-Seidel: the rotor steps first on extrapolated forces, the balancers on what it did.

Order: 1 (held), 2 (linear), 3 (cubic: the first step has no past to extrapolate); accelerations are
interpolated.
Stability: the loop gain must be below 1 whatever the step, as for Jacobi; with linear signals below
1/3 where force opposes acceleration, with cubic ones below 1/13.  The error of the accelerations is
gone.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..master.signals import end_of, extrapolated, hermite, interpolated
from ..master.system import System
from .explicit import Explicit


class GaussSeidel(Explicit):
    """Explicit scheme, rotor before balancers."""

    name = "gauss-seidel"

    @classmethod
    def amplification(cls, eigenvalues: Sequence[complex], order: int) -> float:
        """Largest factor by which a short step repeats a disturbance; stable up to 1."""
        if order != 1:
            return super().amplification(eigenvalues, order)
        # the balancers see the straight line between accelerations and answer with its slope
        repeated = [np.array([[j, j], [j - 1.0, j]]) for j in eigenvalues]
        return float(max((np.abs(np.linalg.eigvals(m)).max() for m in repeated), default=0.0))

    def cross(self, system: System, time: float, step: float) -> None:
        """A step over a jump of the drive: a line from before it to after it says nothing."""
        self._advance(system, time, step, jump=True)

    def step(self, system: System, time: float, step: float) -> float:
        """One step; an explicit scheme has no residual and returns 0."""
        self._advance(system, time, step)
        return 0.0

    def _advance(self, system: System, time: float, step: float, jump: bool = False) -> None:
        order = system.order
        forces = [extrapolated(f.now, f.last, f.last_step, order) for f in system.forces]
        acceleration_ends = system.rotor_pass(forces, time, step)
        accelerations = [
            (*end, 0j, 0j) if jump else interpolated(track.now, end, step, order)
            for track, end in zip(system.accelerations, acceleration_ends, strict=True)
        ]
        force_ends = system.balancer_pass(accelerations, time, step)
        assumed = [end_of(cubic, step) for cubic in forces]
        self.watch(system, assumed, force_ends, time, step)
        # the next extrapolation starts from what the balancers really did
        done = [hermite(f.now, end, step) for f, end in zip(system.forces, force_ends, strict=True)]
        system.accept(
            list(zip(accelerations, acceleration_ends, strict=True)),
            list(zip(done, force_ends, strict=True)),
            time,
            step,
        )
