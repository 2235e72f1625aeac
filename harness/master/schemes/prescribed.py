"""Prescribed: the communication points of an earlier run, with others between them.

The same step as with a tolerance, solved as far, but of given length: two runs that meet at common
points differ by their errors alone.  Signals are held over steps longer than `longest`, as there:
all is at rest.  A step whose loop cannot be solved is halved: where a support turns round in it so
near its end that the forces decide whether it does, the acceleration jumps with them.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..system import System
from .iterated import MAX_PASSES, Iterated
from .own_steps import OwnSteps

LONG = 1.01  # times the longest step where anything moves; at rest they are twice as long or more
SLIVER = 1e-12  # of a time: rounding, not a step
HALVINGS = 20  # of a step: shorter ones do not help either


class Prescribed(OwnSteps):
    """Steps from one of the given points [s] to the next.

    Args:
        iterated: the scheme that takes a step.
        points: ascending.
        residual: of the largest force, that may stay in the loop.
    """

    def __init__(self, iterated: Iterated, points: Sequence[float], residual: float) -> None:
        super().__init__(iterated)
        self.points = points
        iterated.allow(residual)
        self._next = 0

    def judge(self, system: System, time: float, residual: float) -> bool:
        """Whether the loop has converged, as `Iterated.judge`."""
        return self.iterated.judge(system, time, residual)

    def step(self, system: System, time: float, step: float, longest: float) -> tuple[float, float]:
        """One step to the next point, or as far as is left (`step`)."""
        while self._next < len(self.points) and self.points[self._next] <= time * (1.0 + SLIVER):
            self._next += 1
        if self._next < len(self.points):
            step = min(step, self.points[self._next] - time)
        measured, met, held, halved = False, False, step > LONG * longest, 0
        while step:
            with system.saved() as states:
                trial, step = self.iterated.try_step(system, states, time, step, MAX_PASSES, held)
                if trial and (halved == HALVINGS or trial.residual <= self.iterated.tolerance):
                    return self.iterated.go_on(system, trial, met)
                if trial:
                    system.restore(states)
            if not trial:
                met = True
                continue
            if measured:
                step, halved, met = 0.5 * step, halved + 1, False
            # what passes have made of the loop's Jacobian leads nowhere
            self.iterated.after_start(system, time, step)
            measured = True
        return self.iterated.strike(system, time)
