"""A tolerance that is kept: the error of a whole run, from runs that meet at common points.

The error of a step says little about the error at the end: lightly damped motion gathers errors,
unstable motion multiplies them.  So the run is done twice.  The first run has few steps, in C
chosen by their errors; the second divides each of them in two, and is the result.  At common points
the two differ by 2^p - 1 times the error of the second, where p is the order, 4.  It is 1 where
weights can collide, where a jump falls within a step, and after steps at rest that hold their
signals.  It is 2 at most where weights or supports stick or slide, or a motor meets a corner of its
characteristic, at the end of a step.  Two runs state their error by one order less, under a motor
by two; three runs by the order that they show, or as two do if that is higher than p.  All state it
by order 1 where steps do not follow the rotor's fastest vibration.  If the error exceeds the
tolerance, every step is divided again, into as many parts as it takes.

Hairer, Norsett & Wanner 1993, II.4: Richardson's extrapolation, here of the run as a whole.

Collisions can amplify what no run resolves.  Where weights can collide, two motions whose weights
start a little elsewhere are computed too (`neighbours`).  What they part by is part of the error.
If they part from each other, too, or if all runs differ by much, the error is not known.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..errors import SimulationError
from ..scene import Scene
from .cascades import UNRESOLVED, has_cascade
from .compared import ASYMPTOTIC, largest_difference, motion_signals
from .expectation import ORDER_OF_EVENTS, ORDER_OF_JUMPS
from .names import is_count
from .neighbours import BOTH_SIDES, RESOLVED, UNCOMPUTED, add_parting, run_in_one_piece, turned
from .one_file import why_separate
from .recorder import Recorder, Signal
from .schedule import SLIVER
from .simulation import CoupledRun

if TYPE_CHECKING:
    from ..output.workers import Progress

ORDER_HELD = 1  # of steps with held signals, and of all that follows
ATTEMPTS = 3  # at a first run, each in finer steps
# of the tolerance: what further parts are to leave, and two runs may say, for they do not tell by
# which order errors shrink; if by 1.3 already, the tolerance is still kept within a factor of 3
AIM = 0.3
# rad by which a step of the finer run may turn the rotor's fastest vibration: longer ones do not
# follow it.  Under a motor, whose speed vibrates too, 6 of 400 runs erred by 3 to 12 times what
# they stated; on supports of 10^5 times the stiffness a run-up by 4.6 times
FOLLOWED = 1.5
MOST_TIMES = 4  # as many parts as in the run before, which is to be confirmed
MOST_STEP_PARTS = 128  # of a step of the first run
PARTING = 32  # parts that should be enough to see runs come together

EVERY = 16  # points of the first run are those at which neighbours are compared
SHARE = 0.01  # of the tolerance of a step in one piece, by which neighbours are computed


@dataclass(frozen=True)
class Attempt:
    """What a run in finer steps shows against the one before.

    Attributes:
        parts: of each step of the first run; `times` as many as in the run before.
        apart: largest difference of the two, before steps at rest hold their signals.
        at_rest: the same from then on.
        order: by which errors will shrink further, as it is known by now.
        error_by_order: by the order that is expected.
        error: as it is stated.
        allowed: the error by order that keeps the tolerance.
    """

    parts: int
    times: float
    apart: float
    at_rest: float
    order: float
    error_by_order: float
    error: float
    allowed: float

    def order_to(self, apart: float) -> float:
        """Order that three runs show, the last two of which are `apart`, which is not 0."""
        return math.log1p(self.apart / apart) / math.log(self.times)

    @property
    def is_far(self) -> bool:
        """Whether the two runs differ by so much that their motions may part."""
        return max(self.apart, self.at_rest) >= ASYMPTOTIC


class Controlled:
    """The runs of one scene, each finer than the one before, until the tolerance is kept.

    Args:
        cosim: to be run, with a tolerance.
        names: what is recorded.
        uncompared: recorded besides, and left out of the error.

    Attributes:
        error: estimated, the largest of all signals, see `largest_difference`.
        unknown: why the error is not known; empty where it is.
        parts: of each step of the first run.
    """

    def __init__(
        self, cosim: CoupledRun, names: Sequence[str], uncompared: Sequence[str] = ()
    ) -> None:
        assert cosim.scene.coupling.tolerance is not None
        self.cosim, self.names, self.uncompared = cosim, names, uncompared
        self.tolerance = cosim.scene.coupling.tolerance
        self._compare = cosim.compared()
        self.expected = self._compare.expected
        self.parts, self.error, self.unknown = 1, math.inf, ""
        self._longest_step = 0.0  # of the first run [s]
        self._work_in_first_runs = 0
        self._first_attempt = 0  # which share of the tolerance the first run's steps may err

    def run(self, progress: Progress | None) -> Recorder:
        """Run until the error is small enough; return what the last run recorded.

        Raises:
            SimulationError: as `CoSimulation.run`.
        """
        recorder = self._first(progress)
        grid, signals = self._compared(recorder)
        scale = self._compare.least(recorder)
        held = _first_held(self._compare.longest_step, grid)
        self._longest_step = float(np.diff(grid).max())
        last, parts = None, 1
        while True:
            parts = max(2 * parts, self._next_parts(last))
            try:
                recorder = self._run(parts, progress)
            except SimulationError:  # steps that the tolerance allowed are too long for the loop
                if parts < PARTING:
                    continue
                if last is None or not last.is_far:
                    raise
                recorder = self._run(self.parts, progress)  # it says as much as a finer one would
                break
            finer = self._at(recorder, grid)
            apart = largest_difference(signals, finer, scale, slice(held))
            at_rest = largest_difference(signals, finer, scale, slice(held, None))
            last, signals = self._attempt(last, apart, at_rest, parts), finer
            # two runs that hide a fast vibration between their points can agree by chance
            watched = self.cosim.facts().estimated_error
            self.parts, self.error = parts, max(last.error, watched)
            kept = last.error_by_order <= last.allowed and self.error <= self.tolerance
            last = replace(last, error_by_order=max(last.error_by_order, watched))
            # of motions that part no run says more than the one before
            if kept or parts >= (PARTING if last.is_far else MOST_STEP_PARTS):
                break
        self._compare_with_neighbours(grid, signals, scale, progress)
        return recorder

    def _attempt(self, before: Attempt | None, apart: float, at_rest: float, parts: int) -> Attempt:
        """What a run shows so far `apart` from the one before, and `at_rest`."""
        times = parts / self.parts
        order, stated, allowed = self._orders(before, apart, parts)
        # where a corner lies in its step, two runs can agree by chance
        least = before.error_by_order / times**self.expected.steepest_order if before else 0.0
        by_order = error = max(apart, at_rest)
        if error < ASYMPTOTIC:
            rested = at_rest / (times**ORDER_HELD - 1.0)
            by_order = max(apart / (times**order - 1.0), rested, least)
            error = max(apart / (times**stated - 1.0), rested, least)
        shown = self._shown_order(before, apart, parts)
        return Attempt(parts, times, apart, at_rest, shown, by_order, error, allowed)

    def _shown_order(self, before: Attempt | None, apart: float, parts: int) -> float:
        """By which errors will shrink further: as three runs have shown, or as is expected."""
        if before and before.apart and apart and self._is_followed(parts):
            return min(self.expected.order, max(before.order_to(apart), ORDER_OF_JUMPS))
        return before.order if before else self.expected.order

    def _is_followed(self, parts: int) -> bool:
        """Whether steps follow the rotor's fastest vibration."""
        return self.expected.fastest * self._longest_step <= FOLLOWED * parts

    def _orders(
        self, before: Attempt | None, apart: float, parts: int
    ) -> tuple[float, float, float]:
        """Order of the errors, the order by which they are stated, and what may be left of them."""
        highest, aim = self.expected.order, AIM * self.tolerance
        if highest == ORDER_OF_JUMPS:
            cautious = highest
        else:
            cautious = max(ORDER_OF_EVENTS, highest - self.expected.caution)
        if not self._is_followed(parts):
            return ORDER_OF_JUMPS, ORDER_OF_JUMPS, self.tolerance
        if before and before.apart and apart:  # three runs show by which order errors shrink
            shown = before.order_to(apart)
            order = min(highest, max(shown, ORDER_OF_JUMPS))
            # the first runs may show the errors of steps, and the last one those of events
            order = min(order, ORDER_OF_EVENTS) if self.expected.ends_at_events else order
            # a higher order than there is: the errors of the first run did not shrink by order yet
            return order, min(order, cautious) if shown > highest else order, self.tolerance
        if highest == ORDER_OF_JUMPS:
            return highest, cautious, self.tolerance
        if self.expected.ends_at_events:
            return ORDER_OF_EVENTS, ORDER_OF_EVENTS, aim
        return highest, cautious, aim

    def _compare_with_neighbours(
        self,
        grid: Signal,
        signals: Mapping[str, Signal],
        scale: Mapping[str, float],
        progress: Progress | None,
    ) -> None:
        """Add what neighbouring motions part by, where weights can collide."""
        if not self.expected.can_collide:
            return
        if has_cascade(self.cosim.scene, signals):
            self.error = max(self.error, UNRESOLVED)
        at = _shared(grid)
        own = {name: signals[name][at] for name in motion_signals(self.cosim.scene)}
        try:
            if why_separate(self.cosim.scene):
                others = [self._near(side, grid[at], own, progress) for side in BOTH_SIDES]
            else:
                own, *others = _in_one_piece(self.cosim.scene, grid[at], list(own))
        except SimulationError as error:
            self.unknown = UNCOMPUTED.format(error)
            return
        self.error, self.unknown = add_parting(self.error, own, others, scale, self.tolerance)

    def _near(
        self, side: float, times: Signal, names: Iterable[str], progress: Progress | None
    ) -> dict[str, Signal]:
        """Signals at some times of a neighbour, by the same units in the steps of the result.

        Raises:
            SimulationError: it cannot be computed.
        """
        scene = self.cosim.scene
        with self.cosim.like(turned(scene, side * RESOLVED) or scene) as cosim:
            found = self._at(self._run(self.parts, progress, cosim), times)
        return {name: found[name] for name in names}

    def _first(self, progress: Progress | None) -> Recorder:
        """The first run; where its steps are too long, in shorter ones."""
        for self._first_attempt in range(ATTEMPTS - 1):
            try:
                return self._run(1, progress)
            except SimulationError:
                continue
        self._first_attempt = ATTEMPTS - 1
        return self._run(1, progress)

    def _next_parts(self, last: Attempt | None) -> int:
        """Parts of each step of the first run that should keep the tolerance."""
        if last is None:
            return 2
        share = (last.error_by_order / (AIM * self.tolerance)) ** (1.0 / last.order)
        return math.ceil(min(MOST_TIMES * last.parts, last.parts * share))

    def _run(
        self,
        parts: int,
        progress: Progress | None,
        cosim: CoupledRun | None = None,
    ) -> Recorder:
        """One run, of all that is asked for and all that is compared."""
        cosim = cosim or self.cosim
        watched = [*self._compare.signals, *self.uncompared]
        recorder = Recorder(cosim.units, self.names, watched)
        cosim.start(attempt=self._first_attempt, parts=parts)
        # of a first run it is certain that another follows
        done = self._work_in_first_runs
        work = max(3, done + parts)
        report = progress and (lambda part: progress((done + part * parts) / work))
        cosim.record(recorder, report)
        self._work_in_first_runs += parts
        return recorder

    def _compared(self, recorder: Recorder) -> tuple[Signal, dict[str, Signal]]:
        """Points of a run and the signals that are compared there."""
        points, signals = recorder.columns()
        left = [n for n in signals if n not in self.uncompared and not is_count(n)]
        return points, {name: signals[name] for name in left}

    def _at(self, recorder: Recorder, grid: Signal) -> dict[str, Signal]:
        """Signals of a finer run at the points of the first one."""
        points, signals = self._compared(recorder)
        at = np.searchsorted(points, grid * (1.0 - SLIVER))
        return {name: each[at] for name, each in signals.items()}


def _in_one_piece(scene: Scene, times: Signal, names: Sequence[str]) -> list[dict[str, Signal]]:
    """Signals at some times of the motion and of a neighbour on either side.

    Raises:
        SimulationError: one cannot be computed.
    """
    from .one_file_run import OneFileRun  # compiles where it has to

    with OneFileRun(scene) as run:
        turns = [0.0, *(side * RESOLVED for side in BOTH_SIDES)]
        runs = [run_in_one_piece(run, SHARE, times, names, turn) for turn in turns]
    return [dict(each.signals) for each in runs]


def _shared(grid: Signal) -> NDArray[np.intp]:
    """Places of some points of a run, with its end."""
    places = np.arange(EVERY, len(grid) - 1, EVERY)
    return np.append(places, len(grid) - 1)


def _first_held(longest: float, grid: Signal) -> int:
    """The first point that a step with held signals led to; the number of points if none did.

    Args:
        longest: step that does not hold its signals [s].
    """
    lengths = np.append(np.diff(grid), math.inf)
    return int(np.argmax(lengths > longest)) + 1 if longest < math.inf else len(grid)
