"""A tolerance that is kept in one piece: the error of a run, by runs with two tolerances of steps.

The first run chooses the points of the record; the second, whose steps may err a hundredth of that,
is the result.  The first one's error is the larger by far, so that the difference of the two bounds
that of the second.  If it exceeds the tolerance, a third run compares with the second, and so on
until steps err as little as rounding.

Impacts can amplify a difference that nobody can measure.  Where weights can collide, two more runs
therefore start a little to one side and to the other (`neighbours`).  What the result differs from
these by is part of its error.  If they also differ from each other, the error is not known.

Where three weights can bounce off each other, two more runs take more and less for one impact
(`cascades`).  If what they differ by exceeds the tolerance, the error is not known.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

from ...models.constants import SERIES_SHARE
from ..errors import SimulationError
from .at_events import Counted, on_the_same_side
from .cascades import UNRESOLVED, can_cascade, has_cascade
from .compared import largest_difference, motion_signals
from .expectation import expectation
from .names import is_count
from .neighbours import BOTH_SIDES, RESOLVED, UNCOMPUTED, add_parting, run_in_one_piece
from .recorder import Recorder, Signal, divided
from .scales import least_motion

if TYPE_CHECKING:
    from ..output.workers import Progress
    from .one_file_run import OneFileRun

PARTS = 4  # of the way between two points of the first run, where they are chosen: a smooth record
FINER = 0.01  # what a step of a run may err, over that of the run before
ROUNDING = 1e-16  # what a step errs by at least
EVERY = 8  # points of the first run are those of runs to compare with
# of gaps and bounces that are followed: what a row of weights makes of them
GRAINS = 30.0, 0.03
RESOLVED_OTHERWISE = (
    "a row of weights bounces in ever faster impacts, and runs that take others of them for one "
    "end {:.1g} away"
)


class Shown(NamedTuple):
    """A run at points that others are compared at.

    Attributes:
        points: [s].
        fine: the run at more points, of which every `parts`-th is one of these.
    """

    points: Signal
    fine: Counted
    parts: int

    @property
    def names(self) -> list[str]:
        """Of its signals."""
        return list(self.fine.signals)

    @property
    def signals(self) -> Mapping[str, Signal]:
        """At the points."""
        return self.fine.at(slice(None, None, self.parts)).signals


class TwoTolerances:
    """The runs of one scene in one piece, each of smaller errors than the one before.

    Args:
        run: of the scene, with a tolerance.
        names: what is recorded.
        uncompared: recorded besides, and left out of the error.

    Attributes:
        error, unknown: estimated, and why it is not known, as of `global_error.Controlled`.
        counts_before: what signals that count, such as touches of a stop, end with in the run
            before the last, whose steps err more.
    """

    def __init__(
        self, run: OneFileRun, names: Sequence[str], uncompared: Sequence[str] = ()
    ) -> None:
        assert run.scene.coupling.tolerance is not None
        self._run, self._names, self._uncompared = run, names, uncompared
        self.tolerance = run.scene.coupling.tolerance
        self.error, self.unknown = math.inf, ""
        self.counts_before: dict[str, float] = {}
        self._units: Mapping[str, str] = {}
        self._can_collide = expectation(run.scene, meets_events=True).can_collide

    def run(
        self, progress: Progress | None, ends: Callable[[Recorder, Recorder], bool] | None = None
    ) -> Recorder:
        """Run until the error is small enough; return what the last run recorded.

        Args:
            ends: whether two runs one after the other are enough, though their difference exceeds
                the tolerance.  If given, the error is that difference alone.

        Raises:
            SimulationError: as `OneFileRun.record`.
        """
        share, done = 1.0, 0
        recorder = self._recorded(share, self._run.rows, done, progress)
        grid, first = recorder.columns()
        before, counts = Counted(first, self._run.events), _counts(first)
        parts = PARTS if self._run.rows is None else 1
        points = divided(grid, parts)
        least = least_motion(self._run.scene)
        self._units = recorder.signal_units
        scale = {name: least.get(unit, 0.0) for name, unit in self._units.items()}
        while True:
            share, done, last = share * FINER, done + 1, recorder
            recorder = self._recorded(share, points, done, progress)
            _, signals = recorder.columns()
            self.counts_before, counts = counts, _counts(signals)
            left = [n for n in signals if n not in self._uncompared and not is_count(n)]
            fine = Counted({name: signals[name] for name in left}, self._run.events)
            compared = fine.at(slice(None, None, parts))
            self.error = self._difference(before, fine, parts, scale)
            finest = SERIES_SHARE * self.tolerance * share * FINER < ROUNDING
            if ends and (self.error <= self.tolerance or finest or ends(last, recorder)):
                return recorder
            if self.error <= self.tolerance or finest:
                own = Shown(grid[::EVERY], fine, EVERY * parts)
                self._compare_with_neighbours(share, own, scale)
                if self._can_collide and has_cascade(self._run.scene, compared.signals):
                    self.error = max(self.error, UNRESOLVED)
                if self._can_collide and can_cascade(self._run.scene):
                    self._compare_with_grains(share, own, scale)
                return recorder
            before = compared

    def _difference(
        self, run: Counted, fine: Counted, parts: int, scale: Mapping[str, float]
    ) -> float:
        """Of a run from one with more points, as `largest_difference`."""
        run = Counted({name: run.signals[name] for name in fine.signals}, run.events)
        own = fine.at(slice(None, None, parts)).signals
        return largest_difference(on_the_same_side(run, fine, parts, self._units), own, scale)

    def _compare_with_neighbours(
        self, share: float, own: Shown, scale: Mapping[str, float]
    ) -> None:
        """Add what runs of neighbouring motions differ by, where weights can collide."""
        if not self._can_collide:
            return
        with self._run.another() as near:
            try:
                found = [
                    run_in_one_piece(near, share, own.points, own.names, side * RESOLVED)
                    for side in BOTH_SIDES
                ]
            except SimulationError as error:
                self.unknown = UNCOMPUTED.format(error)
                return
        others = [on_the_same_side(each, own.fine, own.parts, self._units) for each in found]
        self.error, self.unknown = add_parting(
            self.error, own.signals, others, scale, self.tolerance
        )

    def _compare_with_grains(self, share: float, own: Shown, scale: Mapping[str, float]) -> None:
        """Add what runs differ by that take more, or less, for one impact of a row of weights."""
        apart = 0.0
        for grain in GRAINS:
            try:
                other = run_in_one_piece(self._run, share, own.points, own.names, grain=grain)
            except SimulationError as error:
                self.unknown = f"impacts cannot be resolved otherwise: {error}"
                return
            apart = max(apart, self._difference(other, own.fine, own.parts, scale))
        self.error = max(self.error, apart)
        if apart > self.tolerance and not self.unknown:
            self.unknown = RESOLVED_OTHERWISE.format(apart)

    def _recorded(
        self, share: float, grid: Signal | None, done: int, progress: Progress | None
    ) -> Recorder:
        """One run, of all that is asked for and all that is compared."""
        run, runs = self._run, max(2, done + 1)
        recorder = Recorder(run.units, self._names, [*motion_signals(run.scene), *self._uncompared])
        run.start(share, grid)
        run.record(recorder, progress and (lambda part: progress((done + part) / runs)))
        return recorder


def _counts(signals: Mapping[str, Signal]) -> dict[str, float]:
    """What signals that count end with."""
    return {name: float(values[-1]) for name, values in signals.items() if is_count(name)}
