"""Iterated: step, compare the forces with those assumed, roll back and step again.

Order: 6 with quintic Hermite signals from values, slopes and second derivatives of both ends, 4
with cubic ones from values and slopes, 2 linear, 1 held.
Stability: any loop gain, as long as no eigenvalue of the loop is 1: each corrector pass is a
quasi-Newton step with the loop's Jacobian measured at the start (fixed-point passes would need a
gain below 1).  Broyden's update refines it where the loop changes along the run.
"""

from __future__ import annotations

from collections.abc import Sequence
from ctypes import c_void_p
from dataclasses import dataclass

import numpy as np

from ...errors import LoopError
from ..fmu import EndedEarly
from ..loop import (
    SLOW,
    QuasiNewton,
    Vector,
    difference,
    jacobian,
    pack,
    size,
    unpack,
    values_in,
)
from ..signals import (
    EXACT,
    MISS_PER_ERROR,
    Cubic,
    Knot,
    begun,
    end_of,
    flat,
    interpolated,
    joined,
    leading_to,
    predicted,
)
from ..system import System
from .contacts import before, strike

CONVERGED = 1e-10  # residual of the forces relative to the largest force so far
MAX_PASSES = 30  # quasi-Newton meets CONVERGED in two to six; more means it does not converge
# per loop gain: what rounding leaves of a residual; forces err by it over the gain
ROUNDING = 1e-12
# of the residual allowed, what held signals may leave: no motion is to be kept up by it
HELD = 0.01
CHANGE = 1e-3  # of the largest force: a disturbance that shows the loop's Jacobian
LOOSE = 1e-3  # a fixed number of passes that leaves more of the force than this is reported


@dataclass
class Trial:
    """A step taken but not yet accepted.

    Attributes:
        motion, forces: cubic over the step and end, of every plane and exchange.
        residual: of the forces, relative to the largest so far.
        largest: force [N] so far, this step's included.
    """

    scheme: Iterated
    time: float
    step: float
    motion: list[tuple[Cubic, Knot]]
    forces: list[tuple[Cubic, Knot]]
    residual: float
    largest: float

    def accept(self, system: System) -> None:
        """Go on from the end of the step."""
        self.scheme.largest = self.largest
        system.accept(self.motion, self.forces, self.time, self.step)


class Iterated:
    """Implicit scheme with rollback.

    Args:
        jacobian: of the loop at the start, from `loop.consistent_start` with `step` [s].
        order: of the exchanged signals; slopes take part in the iteration only from 3 on.
        corrections: corrector passes of every step, or None to go on until converged.
        tolerance: residual, relative to the largest force so far, that counts as converged.
        rounding: of forces that cancel [N]; no smaller residual is asked for.

    Attributes:
        closed: residual, relative as `tolerance`, of a loop that is solved.
    """

    name = "iterated"
    chooses_steps = False
    startup_halvings = 0

    def __init__(
        self,
        jacobian: np.ndarray,
        step: float,
        order: int = 3,
        corrections: int | None = None,
        tolerance: float = CONVERGED,
        rounding: float = 0.0,
    ) -> None:
        self.parts = EXACT[max(3, order)] + 1
        self.with_slopes = order >= 3
        self.miss_per_error = MISS_PER_ERROR[max(3, order)]
        if not self.with_slopes:
            values = values_in(jacobian)
            jacobian = np.where(np.outer(values, values), jacobian, 0.0)
        self.newton = QuasiNewton(jacobian, step, self.parts)
        self._least = ROUNDING * self.newton.gain
        self.closed = max(CONVERGED, self._least)
        self.corrections = corrections
        self.rounding = rounding
        self.allow(tolerance)

    def allow(self, residual: float) -> None:
        """From the start on, count as converged what leaves so much of the largest force."""
        self.tolerance = max(residual, self._least)
        self.largest = self.rounding / (self.tolerance if self.corrections is None else LOOSE)

    def step(self, system: System, time: float, step: float, longest: float) -> tuple[float, float]:
        """One step, and the residual it leaves of the forces over the largest so far."""
        met = False
        while step:
            with system.saved() as states:
                trial, step = self.try_step(system, states, time, step, self._passes(system))
            if trial:
                return self.go_on(system, trial, met)
            met = True
        return self.strike(system, time)

    def try_step(
        self,
        system: System,
        states: Sequence[c_void_p],
        time: float,
        step: float,
        passes: int,
        held: bool = False,
    ) -> tuple[Trial | None, float]:
        """`attempt` and its step [s]; None and the step before an event, 0 where one is here."""
        try:
            return self.attempt(system, states, time, step, passes, held), step
        except EndedEarly as early:
            system.restore(states)
            return None, before(system, early.length)

    def go_on(self, system: System, trial: Trial, met: bool) -> tuple[float, float]:
        """Accept a step, and go behind the event that it ends at, if it does (`met`)."""
        trial.accept(system)
        if not met:
            return trial.step, trial.residual
        behind = strike(self, system, trial.time + trial.step, MAX_PASSES)
        return trial.step + behind, trial.residual

    def strike(self, system: System, time: float) -> tuple[float, float]:
        """Go behind an event that is here; time taken [s], and no residual is left."""
        return strike(self, system, time, MAX_PASSES), 0.0

    def cross_jump(self, system: System, time: float, step: float) -> None:
        """One step with as many passes as it takes, where nothing of the past can be used."""
        with system.saved() as states:
            self.attempt(system, states, time, step, MAX_PASSES, jump=True).accept(system)

    def amplification(self, eigenvalues: Sequence[complex], order: int) -> float:
        """Nothing: the loop is solved."""
        return 0.0

    def judge(self, system: System, time: float, residual: float) -> bool:
        """Whether the forces agree well enough.

        Raises:
            LoopError: they do not agree at all, or not after all the passes it may take.
        """
        allowed = self.tolerance if self.corrections is None else LOOSE
        if not residual > allowed:
            return True
        if residual >= 1.0 or self.corrections is None:
            raise LoopError(
                f"the loop did not converge at t = {time:g} s: {', '.join(system.force_names)} "
                f"still changes by {residual:.2g} of the largest force; use smaller steps or more "
                "corrections"
            )
        return False

    def attempt(
        self,
        system: System,
        states: Sequence[c_void_p],
        time: float,
        step: float,
        passes: int,
        held: bool = False,
        jump: bool = False,
    ) -> Trial:
        """Take a step with at most so many passes; it can still be taken back to `states`.

        `held`: signals are held at the values they end with, whatever the order.  `jump`: the step
        is negligible.
        """
        order = 0 if held else system.order
        tolerance = max(self._least, HELD * self.tolerance) if held else self.tolerance
        # by the unit of a negligible step second derivatives would count for nothing
        measure = self.newton.step if jump and order == 5 else step
        self.newton.rescale(measure)
        starts = [force.now for force in system.forces]
        ahead = [end_of(cubic, step) for cubic in predicted(system.forces, order)]
        u = self._pack(ahead, measure, order)
        previous: tuple[Vector, Vector, float] | None = None
        for number in range(1, passes + 1):
            accelerations, ends, answers = self._pass(system, starts, u, time, step, order, measure)
            g_u = self._pack(answers, measure, order)
            residual = difference(g_u, u)
            # of passes and steps that are taken back none counts: they can be far too large
            largest = max(self.largest, size(g_u))
            error = size(residual) / largest if largest else 0.0
            if previous and error > max(tolerance, SLOW * previous[2]):
                self.newton.learn(previous[0], previous[1], residual)
            if number == passes or not error > tolerance:
                break
            du = self.newton.correction(residual)
            previous = (du, residual, error)
            u = [a + b for a, b in zip(u, du, strict=True)]
            if held:
                u = [0j if k % self.parts else a for k, a in enumerate(u)]
            system.restore(states)
        motion = list(zip(accelerations, ends, strict=True))
        if held:
            motion = joined(system.accelerations, ends, step)
        forces = joined(system.forces, answers, step)
        return Trial(self, time, step, motion, forces, error, largest)

    def after_start(self, system: System, time: float, step: float) -> None:
        """Take the loop's Jacobian from steps of this length, all of them taken back.

        At the start the units answer without a step, which says little of what heavy drag lets
        through within one.
        """
        starts = [force.now for force in system.forces]
        order = system.order
        u = self._pack([end_of(begun(start), step) for start in starts], step, order)
        with system.saved() as states:

            def respond(assumed: Vector) -> Vector:
                ends = self._pass(system, starts, assumed, time, step, order)[2]
                system.restore(states)
                return self._pack(ends, step, order)

            try:
                g_u = respond(u)
                change = CHANGE * max(size(u), size(g_u), self.largest)
                self.newton = QuasiNewton(jacobian(respond, u, g_u, change), step, self.parts)
            except EndedEarly:  # an event within the step: what is known of the loop serves on
                system.restore(states)

    def _passes(self, system: System) -> int:
        """Passes allowed; a first step has no past to be predicted from and would cost an order."""
        if self.corrections is None or (system.has_no_past and self.corrections):
            return MAX_PASSES
        return self.corrections + 1

    def _pack(self, ends: list[Knot], step: float, order: int) -> Vector:
        return pack(ends if order >= 3 else [flat(end) for end in ends], step)

    def _pass(
        self,
        system: System,
        starts: list[Knot],
        u: Vector,
        time: float,
        step: float,
        order: int,
        measure: float | None = None,
    ) -> tuple[list[Cubic], list[Knot], list[Knot]]:
        """Step all units once with forces that end at u, packed by the step or this `measure`."""
        measure = measure or step

        def led(start: Knot, end: Knot) -> Cubic:
            if measure != step:
                return leading_to(end, step)
            return interpolated(start, end, step, order)

        forces = [
            led(start, end)
            for start, end in zip(starts, unpack(u, measure, self.parts), strict=True)
        ]
        ends = system.rotor_pass(forces, time, step)
        accelerations = [
            led(track.now, end) for track, end in zip(system.accelerations, ends, strict=True)
        ]
        return accelerations, ends, system.balancer_pass(accelerations, time, step)
