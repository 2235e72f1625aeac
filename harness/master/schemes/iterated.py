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
from ..loop import SLOW, QuasiNewton, Vector, jacobian, size, values_in, vector
from ..signals import EXACT, MISS_PER_ERROR, Cubic, Knot
from ..system import System
from .contacts import before, strike
from .iterated_maps import Known, ahead, iterated_maps, layout_of

CONVERGED = 1e-10  # residual of the forces relative to the largest force so far
MAX_PASSES = 30  # quasi-Newton meets CONVERGED in two to six; more means it does not converge
# per loop gain: what rounding leaves of a residual; forces err by it over the gain
ROUNDING = 1e-12
# of the residual allowed, what held signals may leave: no motion is to be kept up by it
HELD = 0.01
CHANGE = 1e-3  # of the largest force: a disturbance that shows the loop's Jacobian
LOOSE = 1e-3  # a fixed number of passes that leaves more of the force than this is reported


@dataclass(slots=True)
class Trial:
    """A step taken but not yet accepted; rows are of the forces, then of the accelerations.

    Attributes:
        cubics, ends: of all signals; by how far these are from where the cubics before led,
            `missed`.
        residual: of the forces, relative to the largest so far.
        largest: force [N] so far, this step's included.
    """

    scheme: Iterated
    time: float
    step: float
    cubics: list[Cubic]
    ends: list[Knot]
    missed: list[float]
    residual: float
    largest: float

    def accept(self, system: System) -> None:
        """Go on from the end of the step."""
        self.scheme.largest = self.largest
        signals = (*system.forces, *system.accelerations)
        of_signals = zip(signals, self.cubics, self.ends, self.missed, strict=True)
        for signal, cubic, end, missed in of_signals:
            alike = signal.last_step == self.step
            signal.arrive(cubic, end, self.step, missed if alike else 0.0)
        system.accepted(self.time + self.step)


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
        self._rooms: dict[tuple[bool, float], Known] = {}
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

    def allow_error(self, share: float) -> None:
        """Nothing: it keeps no tolerance."""

    def amplification(self, eigenvalues: Sequence[complex], order: int) -> float:
        """0: the loop is solved, so that steps repeat no error, whatever its gain."""
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
        tolerance = max(self._least, HELD * self.tolerance) if held else self.tolerance
        # by the unit of a negligible step second derivatives would count for nothing
        unit = self.newton.step if jump and system.order == 5 else step
        self.newton.rescale(unit)
        count, cut = len(system.forces), self.parts
        known = self._ready(system, unit, held, step / unit)
        past = self._past(system)
        track = past.dot(ahead(system.order, system.forces[0].last_step, step))
        if unit != step:
            track *= np.tile((unit / step) ** np.arange(cut), 2)
        known.starts[:] = track[:, :cut]
        known.assumed_ends[:] = 0.0 if held else track[:count, cut:]
        previous: tuple[np.ndarray, np.ndarray, float] | None = None
        for number in range(1, passes + 1):
            answers, residual = self._pass(system, time, step)
            # of passes and steps that are taken back none counts: they can be far too large
            largest = max(self.largest, size(vector(answers)))
            error = size(vector(residual)) / largest if largest else 0.0
            if previous and error > max(tolerance, SLOW * previous[2]):
                self.newton.learn(previous[0], previous[1], residual)
            if number == passes or not error > tolerance:
                break
            du = self.newton.correction(residual)
            previous = (du, residual, error)
            known.assumed += du
            system.restore(states)
        cubics = self._maps.cubics.dot(known.numbers).view(complex).reshape(len(track), -1)
        # accelerations stand first
        changes, led = known.changes.tolist(), track[:, cut].tolist()
        changes = changes[-count:] + changes[:-count]
        return Trial(
            self,
            time,
            step,
            [tuple(cubic) for cubic in cubics.tolist()],
            system.ends(),
            [abs(found - change) for found, change in zip(changes, led, strict=True)],
            error,
            largest,
        )

    def after_start(self, system: System, time: float, step: float) -> None:
        """Take the loop's Jacobian from steps of this length, all of them taken back.

        At the start the units answer without a step, which says little of what heavy drag lets
        through within one.
        """
        known, past = self._ready(system, step), self._past(system)
        past[:, self.parts :] = 0.0
        track = past.dot(ahead(system.order, 0.0, step))
        known.starts[:] = track[:, : self.parts]
        known.assumed_ends[:] = track[: len(system.forces), self.parts :]
        largest = max(self.largest, size(vector(known.first + known.assumed)))
        with system.saved() as states:

            def respond(assumed: Vector) -> Vector:
                known.assumed.view(complex)[:] = assumed
                answers, _ = self._pass(system, time, step)
                system.restore(states)
                return vector(answers)

            try:
                u = vector(known.assumed)
                g_u = respond(u)
                change = CHANGE * max(size(g_u), largest)
                self.newton = QuasiNewton(jacobian(respond, u, g_u, change), step, self.parts)
            except EndedEarly:  # an event within the step: what is known of the loop serves on
                system.restore(states)

    def _passes(self, system: System) -> int:
        """Passes allowed; a first step has no past to be predicted from and would cost an order."""
        if self.corrections is None or (system.has_no_past and self.corrections):
            return MAX_PASSES
        return self.corrections + 1

    def _ready(self, system: System, unit: float, held: bool = False, length: float = 1.0) -> Known:
        """Maps of a step of so many units of time [s], and room for what is known of it."""
        room = held, length
        if room not in self._rooms:
            layout = layout_of(system.planes, len(system.forces), system.order, held, length)
            self._rooms[room] = Known(layout)
        self._known = known = self._rooms[room]
        self._maps = iterated_maps(known.layout, unit)
        return known

    def _past(self, system: System) -> np.ndarray:
        """Of every signal its end now, and the higher derivatives of its cubic before."""
        signals = (*system.forces, *system.accelerations)
        return np.array([s.now + s.last[self.parts :] for s in signals], complex)

    def _pass(self, system: System, time: float, step: float) -> tuple[np.ndarray, np.ndarray]:
        """Step all units once as assumed; forces answered, and how far they miss those assumed."""
        maps, known = self._maps, self._known
        maps.pushed.dot(known.pushing, system.pushed)
        if system.shaft:
            system.shaft.tell(tuple(vector(maps.spun.dot(known.pushing))), step)
        system.step_rotor(time, step)
        np.subtract(maps.felt.dot(system.felt), known.begun, known.moved)
        maps.told.dot(known.telling, system.told)
        system.step_balancers(time, step)
        answers = maps.answers.dot(system.answers)
        np.subtract(answers, known.first, known.answered)
        residual = known.answered - known.assumed
        unused = known.layout.unused
        if unused.size:
            answers[unused] = residual[unused] = 0.0
        return answers, residual
