"""Units that are coupled, run from the start to the end: what runs of any units have in common."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack
from typing import TYPE_CHECKING

from ..errors import SimulationError, UserError
from .closing import Closing
from .recorder import REPORTED, Recorder
from .schemes.explicit import Scheme

if TYPE_CHECKING:
    from ..output.workers import Progress
    from .system import System

FINER_FIRST = 4  # times as many steps in a first run where fewer were too few


class Coupled(Closing):
    """Units and their connections, stepped by a scheme.

    A kind of units says how it starts, and what it does at the beginning of a step.

    Attributes:
        coupled: whether there is a loop.
        meets_events: whether steps end where a stop is touched, or weights or supports stick.
        system: the units with their signals; `scheme` couples them.
        time: reached so far [s]; may be set to where a step was to end.
        gain: of the loop; `amplification` what the scheme makes of an error in a step.
        steps: taken since the start; `unconverged` those whose loop has not converged.
        worst_residual: of all steps.
    """

    meets_events = False
    coupled: bool
    system: System
    scheme: Scheme
    gain: float
    amplification: float
    time: float
    steps: int
    unconverged: int
    worst_residual: float
    _stack: ExitStack
    _schedule: list[tuple[float, int]]
    _parts: int

    def step(self, step: float) -> None:
        """One communication step of length `step` [s].

        Raises:
            SimulationError: a unit failed, a signal is not finite, or the loop did not converge.
        """
        try:
            self._cover(step)
        except SimulationError as error:
            if not self.coupled or isinstance(error, UserError):  # a unit of others is to blame
                raise
            raise SimulationError(f"{error}; {self._about_loop(error)}") from error

    def _about_loop(self, _error: SimulationError) -> str:
        """What a failure in a loop is told with."""
        return f"loop gain {self.gain:.3g}"

    def _cover(self, step: float) -> None:
        """A communication step."""
        self._advance_part(step)

    def _cross_jump(self, _step: float) -> float:
        """Cross a jump of a drive here, if there is one; the part of the step that took [s]."""
        return 0.0

    def _advance_part(self, step: float) -> None:
        """A part of a communication step."""
        self._advance(step)

    def _advance(self, step: float, jump: bool = False, tolerant: bool = False) -> bool:
        """A step of the scheme, over a jump or without, judged and counted; whether forces agree.

        Args:
            tolerant: where they do not, that is no error, and not counted.
        """
        residual = self.scheme.step(self.system, self.time, step, jump)
        agrees = self.scheme.agrees(residual)
        if agrees or not tolerant:
            self.worst_residual = max(self.worst_residual, residual)
            if not self.scheme.check_agreement(self.system, self.time, residual):
                self.unconverged += 1
        self.system.follow(self.time, step)
        self.time += step
        self.steps += 1
        return agrees

    def run(self) -> Iterator[float]:
        """Step through the scene's run; yields the finished fraction after every step.

        Raises:
            SimulationError: as `step`, or the scheme is unstable at the scene's loop gain.
        """
        if self.amplification > 1.0:
            raise SimulationError(
                f"{self.scheme_name} coupling of order {self.system.order} is unstable "
                f"from t = 0 s, at any step: every step repeats an error of "
                f"{', '.join(self.system.force_names)} {self.amplification:.3g}-fold; loop gain "
                f'{self.gain:.3g}; use scheme = "iterated" or "auto"'
            )
        bounds = self._bounds()
        for (whole, count), bound in zip(self._schedule, bounds, strict=True):
            start, step = self.time, whole / self._parts
            for number in range(1, count * self._parts + 1):
                self.step(step)
                # a product instead of a sum: rounding must not move the communication points
                self.time = start + number * step
                yield self.time / bounds[-1]
            self.time = bound

    @property
    def scheme_name(self) -> str:
        """As the scene calls it."""
        raise NotImplementedError

    def _bounds(self) -> list[float]:
        """Times that must be communication points [s], the last of them the end."""
        raise NotImplementedError

    def record(self, recorder: Recorder, progress: Progress | None) -> None:
        """`run` to the end; a row at the start and after every step, a report now and then.

        Raises:
            UserError: the record will not fit into memory.
        """
        self._record_row(recorder)
        for count, part in enumerate(self.run(), start=1):
            self._record_row(recorder)
            if count % REPORTED == 0:
                recorder.refuse_too_much(part)
                if progress:
                    progress(part)

    def _record_row(self, recorder: Recorder) -> None:
        recorder.record(self.time)

    def close(self) -> None:
        """Free all instances."""
        self._stack.close()
