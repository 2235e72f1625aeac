"""Contacts met: a step ends where weights collide, so that no signal jumps within a step.

A collision changes the weights' speeds and with them the force, and its impulse reaches the rotor
as a pulse over the two steps after it (`models.contact.pulse`).  Units that end a step at the first
collision tell where it is: the step before it ends a moment earlier, the collision and its pulse
are taken in steps so brief that what they err is lost in rounding, and what follows starts without
a past.
"""

from __future__ import annotations

from copy import copy
from typing import TYPE_CHECKING

from ...errors import SimulationError
from ..fmu import EndedEarly
from ..system import System

if TYPE_CHECKING:
    from .iterated import Iterated, Trial

BRIEF = 1e-6  # of a communication step
CALM = 4  # brief steps without another: the two of a pulse, one for what it does, one to spare
BEYOND = 1.0 + 5e-7  # of the way to a collision: it is then met at the end of the step
MOST = 1000  # brief steps at once; weights that bounce ever faster come to rest in their unit


class Contacts:
    """Meets the collisions of one run.

    Args:
        step: usual length of a communication step [s].
    """

    def __init__(self, step: float) -> None:
        self.brief = BRIEF * step

    def before(self, ahead: float) -> float:
        """Step [s] that ends before a collision so far ahead [s]; 0: it is here."""
        return ahead - 0.5 * self.brief if ahead > 2.0 * self.brief else 0.0

    def strike(
        self, scheme: Iterated, system: System, time: float, passes: int
    ) -> tuple[float, float]:
        """Go behind a collision that is here; time taken [s] and the largest residual.

        Args:
            passes: allowed in every brief step.

        Raises:
            SimulationError: one collision follows another without end.
        """
        signals = [*system.forces, *system.accelerations]
        sizes, largest = [signal.largest for signal in signals], scheme.largest
        learned = copy(scheme.newton)
        step, calm, residual, now = self.brief, 0, 0.0, time
        for _ in range(MOST):
            trial = _attempted(scheme, system, now, step, passes)
            if isinstance(trial, float):
                step, calm = BEYOND * trial, 0
                continue
            trial.accept(system)
            # a pulse is no measure of what forces may err by, nor of how the loop answers them
            scheme.largest, scheme.newton = largest, copy(learned)
            residual = max(residual, trial.residual)
            now, calm = now + step, calm + (step == self.brief)
            if calm == CALM:
                break
            step = self.brief
        else:
            raise SimulationError(f"weights collide without end at t = {now:g} s")
        for signal, size in zip(signals, sizes, strict=True):
            signal.largest, signal.prediction_error = max(size, abs(signal.now[0])), 0.0
        system.drop_past()
        return now - time, residual


def _attempted(
    scheme: Iterated, system: System, time: float, step: float, passes: int
) -> Trial | float:
    """A trial, or the time to a collision within the step [s], the units as before it."""
    with system.saved() as states:
        try:
            return scheme.attempt(system, states, time, step, passes)
        except EndedEarly as early:
            system.restore(states)
            return early.length
