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
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..errors import SimulationError
from ..scene import Scene
from .attempts import Attempts
from .cascades import UNRESOLVED, has_cascade
from .compared import largest_difference, motion_signals
from .names import is_count
from .neighbours import BOTH_SIDES, RESOLVED, UNCOMPUTED, add_parting, run_in_one_piece, turned
from .one_file import why_separate
from .recorder import Recorder, Signal
from .schedule import SLIVER
from .simulation import CoupledRun

if TYPE_CHECKING:
    from ..output.workers import Progress

ATTEMPTS = 3  # at a first run, each in finer steps
MOST_STEP_PARTS = 128  # of a step of the first run
PARTING = 32  # parts that should be enough to see runs come together
EVERY = 16  # points of the first run are those at which neighbours are compared
SHARE = 0.01  # of the tolerance of a step in one piece, by which neighbours are computed


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
        judge = Attempts(self.expected, self.tolerance, float(np.diff(grid).max()))
        last, parts = None, 1
        while True:
            parts = max(2 * parts, judge.next_parts(last))
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
            last, signals = judge.attempt(last, apart, at_rest, parts), finer
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
