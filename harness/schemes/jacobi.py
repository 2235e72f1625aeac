"""Jacobi: all units step side by side on extrapolated signals, as most FMI tools do.

Order: 1 (held), 2 (linear), 3 (cubic: the first step has no past to extrapolate; rarely stable).
Stability: the loop gain must be below 1 whatever the step, since a force acts one step late; with
cubic signals below 1/169 = (1/13)^2, since force and acceleration are both extrapolated.
"""

from __future__ import annotations

from ..master.signals import end_of, extrapolated, hermite
from ..master.system import System
from .explicit import Explicit


class Jacobi(Explicit):
    """Explicit scheme without order among the units."""

    name = "jacobi"
    exchanges = 2

    def step(self, system: System, time: float, step: float) -> float:
        """One step; an explicit scheme has no residual and returns 0."""
        order = system.order
        forces = [extrapolated(f.now, f.last, f.last_step, order) for f in system.forces]
        accelerations = [
            extrapolated(a.now, a.last, a.last_step, order) for a in system.accelerations
        ]
        acceleration_ends = system.rotor_pass(forces, time, step)
        force_ends = system.balancer_pass(accelerations, time, step)
        assumed = [end_of(cubic, step) for cubic in forces]
        self.watch(system, assumed, force_ends, time, step)
        system.accept(
            [
                (hermite(track.now, end, step), end)
                for track, end in zip(system.accelerations, acceleration_ends, strict=True)
            ],
            [
                (hermite(f.now, end, step), end)
                for f, end in zip(system.forces, force_ends, strict=True)
            ],
            time,
            step,
        )
        return 0.0
