"""Iterated: step, compare the forces with those assumed, roll back and step again.

Order: 4 with cubic Hermite signals from values and slopes of both ends, 2 linear, 1 held.
Stability: any loop gain, as long as no eigenvalue of the loop is 1: each corrector pass is a
quasi-Newton step with the loop's Jacobian measured at the start (fixed-point passes would need a
gain below 1).  Broyden's update refines it where the loop changes along the run.
"""

from __future__ import annotations

import math
from copy import copy
from typing import Any

import numpy as np

from ...errors import LoopError
from ..fmu import EndedEarly
from ..limits import (
    BRIEF_FOR_LOOP,
    CLOSED,
    CONVERGED_FORCES,
    GAIN_ROUNDING,
    JACOBIAN_CHANGE,
    LOOSE_RESIDUAL,
    MAX_PASSES,
    SLOW_CONVERGENCE,
)
from ..loop import QuasiNewton, Vector, jacobian, of_values, pack, size, unpack
from ..signals import Knots
from ..system import System
from .explicit import Scheme


class Iterated(Scheme):
    """Implicit scheme with rollback.

    Args:
        jacobian: of the loop at the start, from `loop.consistent_start` with `step` [s].
        order: of the exchanged signals; slopes take part in the iteration only from 3 on.
        corrections: corrector passes of every step, or None to go on until converged.
        rounding: of forces that cancel [N]; no smaller residual is asked for.
    """

    def __init__(
        self,
        jacobian: np.ndarray,
        step: float,
        order: int = 3,
        corrections: int | None = None,
        rounding: float = 0.0,
    ) -> None:
        self.order, self.corrections = order, corrections
        if order < 3:
            values = of_values(jacobian)
            jacobian = np.where(np.outer(values, values), jacobian, 0.0)
        self.newton = QuasiNewton(jacobian, step)
        self._at_once, self._usual = copy(self.newton), step  # of the start, where no step acts
        self.tolerance = max(CONVERGED_FORCES, GAIN_ROUNDING * self.newton.gain)
        asked = self.tolerance if corrections is None else LOOSE_RESIDUAL
        self.largest = self._least(rounding / asked)

    def step(self, system: System, time: float, step: float, jump: bool = False) -> float:
        """One step; over a jump of the drive with as many passes as it takes."""
        # a first step has no past to be predicted from, and would cost an order
        passes = MAX_PASSES
        if not (jump or self.corrections is None or (system.has_no_past and self.corrections)):
            passes = self.corrections + 1
        newton = self._solver(step) if jump else self.newton
        newton.rescale(step)
        u = self._used(system.forces.ends(system.forces.predicted(system.order), step), step)
        before: tuple[Vector, Vector, float] | None = None
        system.save()
        for number in range(1, passes + 1):
            motion, answers = self._pass(system, u, time, step)
            packed = pack(answers, step)
            residual = (packed if self.order == 3 else self._used(answers, step)) - u
            # of passes that are taken back none counts: they can be far too large
            largest = self._grown(packed)
            error = self._share(residual, largest)
            slow = before is not None and error > SLOW_CONVERGENCE * before[2]
            if before and slow and error > self.tolerance:
                newton.learn(before[0], before[1], residual)
            # a jump is crossed in a brief step, where what is left of a force makes a steep slope
            enough = error <= (CLOSED if jump and not slow else self.tolerance)
            if number == passes or enough or math.isnan(error):
                break
            du = newton.correction(residual)
            before = du, residual, error
            u = u + du
            system.restore()
        self.largest = largest
        system.accept(motion, answers, time, step)
        return error

    def _pass(self, system: System, u: Vector, time: float, step: float) -> tuple[Knots, Knots]:
        """Step all units once under assumed ends of the forces; accelerations and answers.

        Raises:
            EndedEarly: a unit ended the step at an event; all are rolled back.
        """
        forces = system.forces.to(unpack(u, step), step, self.order)
        try:
            motion = system.rotor_pass(forces, time, step)
            accelerations = system.accelerations.to(motion, step, self.order)
            return motion, system.balancer_pass(accelerations, time, step)
        except EndedEarly:
            system.restore()
            raise

    def _solver(self, step: float) -> QuasiNewton:
        """Of the loop in a step over a jump or up to one, from which other steps do not learn.

        A brief step acts as the start does, without a step.
        """
        return copy(self._at_once if step < BRIEF_FOR_LOOP * self._usual else self.newton)

    def _least(self, force: float) -> Any:
        """What residuals are compared with at least, of forces [N]."""
        return force

    def _grown(self, answers: Vector) -> Any:
        """The largest force so far, these among them."""
        return max(self.largest, size(answers))

    def _share(self, residual: Vector, largest: Any) -> float:
        """Largest residual over the largest force."""
        return size(residual) / largest if largest else 0.0

    def _disturbance(self, u: Vector, g_u: Vector) -> Any:
        """Change of the forces that shows the loop's Jacobian."""
        return JACOBIAN_CHANGE * max(size(g_u), size(u), self.largest)

    def _used(self, ends: Knots, step: float) -> Vector:
        """Ends of forces as a vector; below order 3 slopes take no part."""
        return pack(ends, step if self.order == 3 else 0.0)

    def cross_jump(self, system: System, time: float, step: float) -> None:
        """One step, where nothing of the past can be used."""
        self.step(system, time, step, jump=True)

    def after_start(self, system: System, time: float, step: float) -> None:
        """Take the loop's Jacobian from steps of this length, all of them taken back.

        At the start the units answer without a step, which says little of what heavy drag lets
        through within one.
        """
        u = self._used(system.forces.ends(system.forces.predicted(1), step), step)
        system.save()

        def respond(assumed: Vector) -> Vector:
            answers = self._pass(system, assumed, time, step)[-1]
            system.restore()
            return self._used(answers, step)

        g_u = respond(u)
        self.jacobian = jacobian(respond, u, g_u, self._disturbance(u, g_u))
        self.newton = QuasiNewton(self.jacobian, step)

    def agrees(self, residual: float) -> bool:
        return not residual > self.tolerance

    def check_agreement(self, system: System, time: float, residual: float) -> bool:
        """Whether the forces agree well enough.

        Raises:
            LoopError: they do not agree at all, or not after all the passes it may take.
        """
        allowed = self.tolerance if self.corrections is None else LOOSE_RESIDUAL
        if not residual > allowed:
            return True
        if residual >= 1.0 or self.corrections is None:
            raise LoopError(
                f"the loop did not converge at t = {time:g} s: {', '.join(system.force_names)} "
                f"still changes by {residual:.2g} of the largest force; use smaller steps or more "
                "corrections"
            )
        return False
