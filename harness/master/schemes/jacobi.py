"""Jacobi: all units step side by side on extrapolated signals, as most FMI tools do.

Order: 1 (held), 2 (linear), 3 (cubic: the first step has no past to extrapolate; rarely stable).
Stability: the loop gain must be below 1 whatever the step, since a force acts one step late; with
cubic signals below 1/169 = (1/13)^2, since force and acceleration are both extrapolated.
"""

from __future__ import annotations

from ..system import System
from .explicit import Explicit


class Jacobi(Explicit):
    """Explicit scheme without order among the units."""

    name = "jacobi"
    extrapolations = 2

    def advance(self, system: System, time: float, step: float, jump: bool = False) -> None:
        """One step, at a jump of the drive as anywhere."""
        forces = system.forces.predicted(system.order)
        accelerations = system.accelerations.predicted(system.order)
        motion = system.rotor_pass(forces, time, step)
        answers = system.balancer_pass(accelerations, time, step)
        accelerations = system.accelerations.to(motion, step)
        forces = system.forces.to(answers, step)
        system.accept((accelerations, motion), (forces, answers), time, step)
