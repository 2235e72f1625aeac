"""Tolerance-driven steps: the iterated scheme with step size and passes set by an error estimate.

What limits the accuracy is the cubic that stands for a signal within a step.  The cubic of the step
before, extrapolated to the end of this one, misses the converged signal by
(h + h0)^2 h^2 f''''/24, and the cubic of this step misses it by h^4 f''''/720 on average; so

    error = |converged - predicted| h^2 / (30 (h + h0)^2).

Quintics (order 5) miss it by (h + h0)^3 h^3 f^(6)/720 and by h^6 f^(6)/100800 on average, and so

    error = |converged - predicted| h^3 / (140 (h + h0)^3).

Both signals belong to a loop that has converged, so the estimate holds with direct feedthrough,
where comparing one step with two halves does not (Schierz, Arnold, Clauss 2012).  Order 4,
with quintics 6.

The estimate sees ends alone, and nothing of a vibration that turns whole times in a step.  So steps
are no longer than `longest`, which follows every revolution, until all rests in the rotor: until at
the end of a step no acceleration, no slope of one and no change of a force is left that counts.  A
vibration shows in value or slope, whatever its phase.  After `RESTED` such steps of one length the
next is twice as long, so that none is longer than a quarter of the time that rest has lasted: what
is not stable grows meanwhile.  Steps longer than `longest` hold the signals at their end values,
order 1: cubics would amplify what they do not resolve.  One that ends in motion is taken back, and
what follows is at most `longest`.
"""

from __future__ import annotations

import math

from ...errors import LoopError, SimulationError
from ..system import System
from .iterated import MAX_PASSES, Iterated, Trial
from .own_steps import OwnSteps

LOCAL_SHARE = 0.2  # of the tolerance that one step may err: the errors of many steps add up
AIM = 0.5  # of what is allowed, so that few steps are rejected
RUNGS = 4  # of the ladder of step sizes per factor 2, so that the rotor's matrices are reused
FIRST_RUNG = 6 * RUNGS  # 64 times shorter than the longest
MINUTE = 20 * RUNGS  # steps 2^20 times shorter: what one misses of a jump moves nothing
LOWEST = 40 * RUNGS  # steps 2^40 times shorter than the longest are no way to finish
RESTED = 4  # steps at rest of one length
GROWTH = 2.0  # at most, from one step to the next: a lucky zero of f'''' must not mislead
SLOWEST = 1e3  # times the residual allowed: passes then lead nowhere, with the Jacobian they have
RESIDUAL_SHARE = 0.2  # of what a step may err: it may stay in the loop


class Adaptive(OwnSteps):
    """Steps as long as the tolerance allows, rejected by rollback where they were too long.

    Args:
        iterated: the scheme that takes a step.
        tolerance: allowed error of the coupling signals, relative to the largest so far.
        gain: of the loop; where force and reaction nearly cancel, an error of the force is that
            much larger in the motion that is left.
        mass: of the loaded rotor [kg], which forces that are rounding can accelerate.
        jumps: whether accelerations jump (dry friction), so that no step over one is short enough.
        slowest: rate of the rotor's slowest motion, over its speed; 0: steps stay short at rest.

    Attributes:
        share: of the tolerance that one step may err.
    """

    def __init__(
        self,
        iterated: Iterated,
        tolerance: float,
        gain: float = 0.0,
        mass: float = math.inf,
        jumps: bool = False,
        slowest: float = 0.0,
    ) -> None:
        super().__init__(iterated)
        self.tolerance, self._mass = tolerance, mass
        self._cancelled = max(1.0, gain)
        self.allow_error(LOCAL_SHARE)
        # start short: nothing is known of the signals yet, and a longer step sees no fast mode
        self.rung: int = FIRST_RUNG
        self._minute = 2.0 ** (-MINUTE / RUNGS) if jumps else 0.0
        self.rejected = self._rested = 0
        self._still = LOCAL_SHARE * tolerance
        # what moves slowly is still on its way when its acceleration is small
        self._still_motion = 0.0 if jumps else self._still * min(1.0, slowest) ** 2

    def allow_error(self, share: float) -> None:
        """From the start on, let a step err by this share of the tolerance, its loop by less."""
        self.share = share
        iterated, allowed = self.iterated, RESIDUAL_SHARE * self.tolerance
        # whatever a step may err, forces that cancel are not told from rounding
        iterated.allow(min(share, LOCAL_SHARE) * allowed)
        iterated.tolerance = max(iterated.tolerance, share * allowed)
        self._largest_motion = iterated.largest / self._mass

    def judge(self, system: System, time: float, residual: float) -> bool:
        """Always converged, or the step would not have been accepted."""
        return True

    def step(self, system: System, time: float, step: float, longest: float) -> tuple[float, float]:
        """One accepted step, at most as long as what remains (`step`) and as `longest`.

        Raises:
            LoopError: no step is short enough for the tolerance.
        """
        allowed, remaining, met = self.share * self.tolerance, step, False
        if system.has_no_past:
            self.rung = max(self.rung, 0)
        while remaining:
            step = longest * 2.0 ** (-self.rung / RUNGS)
            # do not leave a sliver for the last step
            if step >= remaining:
                step = remaining
            elif step > 0.5 * remaining:
                step = 0.5 * remaining
            trial: Trial | None = None
            with system.saved() as states:
                try:
                    trial, step = self.iterated.try_step(
                        system, states, time, step, MAX_PASSES, held=self.rung < 0
                    )
                except SimulationError:  # a unit cannot follow a loop that diverges
                    system.restore(states)
                    if self.rung + 2 * RUNGS > LOWEST:
                        raise
                else:
                    if not trial:
                        met, remaining = True, step
                        continue
                    error, largest_motion = self._error(system, trial)
                    change = GROWTH
                    if error > 0.0:
                        change = min(GROWTH, (AIM * allowed / error) ** (1.0 / (system.order + 1)))
                    wanted = RUNGS * math.log2(longest / (step * change))
                    minute = step <= self._minute * longest
                    long = self.rung < 0
                    rests = (long or wanted < 0.0) and self._rests(
                        system, trial, longest, largest_motion
                    )
                    exact = error <= allowed and (rests or not long)
                    if (exact or minute) and trial.residual <= self.iterated.tolerance:
                        self.rung = max(self._lowest(rests), math.ceil(wanted - 1e-9))
                        if minute:
                            self.rung = min(self.rung, MINUTE)
                        self._largest_motion = largest_motion
                        return self.iterated.go_on(system, trial, met and step == remaining)
                    system.restore(states)
            if not trial or trial.residual > SLOWEST * self.iterated.tolerance:
                self.iterated.after_start(system, time, 0.5 * step)
            if not trial:
                self.rung += 2 * RUNGS
                continue
            self.rejected += 1
            self.rung = max(math.ceil(wanted), self.rung + 1)
            if long and not rests:
                self.rung, self._rested = max(self.rung, 0), 0
                system.drop_past()
            if self.rung > LOWEST:
                raise LoopError(
                    f"tolerance {self.tolerance:g} cannot be met at t = {time:g} s: steps of "
                    f"{step:.3g} s still err by {error:.3g}, loop residual {trial.residual:.3g}"
                )
        return self.iterated.strike(system, time)

    def _error(self, system: System, trial: Trial) -> tuple[float, float]:
        """Largest relative error of the signals' cubics over the step, and the largest motion."""
        count, missed = len(system.forces), trial.missed
        largest = max([self._largest_motion, *[abs(end[0]) for end in trial.ends[count:]]])
        force, motion = max(missed[:count]), max(missed[count:], default=0.0)
        error = max(
            self._cancelled * force / trial.largest if trial.largest else 0.0,
            motion / largest if largest else 0.0,
        )
        return error * _share(system.forces[0].last_step, trial.step, system.order), largest

    def _lowest(self, rests: bool) -> int:
        """The rung of the longest step that may follow the one now accepted."""
        lowest = min(self.rung, 0) if rests else 0
        self._rested = self._rested + 1 if rests else 0
        if self._rested == RESTED:
            self._rested, lowest = 0, lowest - RUNGS
        return lowest

    def _rests(self, system: System, trial: Trial, longest: float, largest_motion: float) -> bool:
        """Whether nothing moves in the rotor at the end of a step."""
        count = len(system.forces)
        motion, force = self._still_motion * largest_motion, self._still * trial.largest
        for end in trial.ends[count:]:
            if not max(abs(end[0]), longest * abs(end[1])) < motion:
                return False
        return all(
            self._cancelled * max(abs(end[0] - s.now[0]), longest * abs(end[1])) < force
            for s, end in zip(system.forces, trial.ends, strict=False)
        )


def _share(last_step: float, step: float, order: int) -> float:
    """Part of the prediction's miss that is error of the step's own cubic; 1/120 of equal steps."""
    if order == 5:
        return (step / (step + last_step)) ** 3 / 140.0
    return step * step / (30.0 * (step + last_step) ** 2)
