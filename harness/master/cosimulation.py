"""The co-simulation master: rotor first, then the balancers, on cubic signals with rollback.

Data flow of a step: predicted forces -> rotor -> accelerations -> balancers -> forces; the scheme
decides whether they are compared with the prediction and the step is taken again.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from ..errors import SimulationError
from ..scene import Scene
from .beginning import Beginning
from .facts import Facts, advice
from .fmu import Closing, Fmu
from .loop import consistent_start, value_eigenvalues
from .plan import plan
from .recorder import Recorder
from .resolution import Resolution
from .runtime import runtime
from .scales import ROUNDING, largest_force
from .schedule import (
    DrivenSpeed,
    as_run,
    brief_step,
    end_time,
    fewest_chosen,
    meets_events,
    milestones,
    schedule,
    step_size,
)
from .schemes.iterated import Iterated
from .schemes.prescribed import SLIVER, Prescribed
from .schemes.protocol import Scheme, choose, refuse_loose_tolerance, response_before
from .schemes.startup import substeps
from .system import System
from .unit_files import find_or_build

if TYPE_CHECKING:
    from ..output.workers import Progress
    from .one_file_run import OneFileRun

REPORTED = 256  # steps between two reports of progress: some ten a second
Simulation: TypeAlias = "CoSimulation | OneFileRun"


class CoSimulation(Closing):
    """The units of a scene, loaded and connected; restarted and stepped as often as wanted.

    Args:
        scene: what to simulate.
        fmus: directory of ready-made FMUs; by default exactly those needed are built.
        watch: also step balancers that exchange no force (their clearance is wanted).
        order: of the coupling signals; by default the scene's.

    Attributes:
        coupled: whether there is a loop.
        ends_steps_at_corners: of a motor's characteristic.

    Raises:
        UnitError: an FMU is missing, corrupt, or of a different build.
        SceneError: a tolerance is asked of a scheme or an order that cannot keep it.
    """

    ends_steps_at_corners = False

    def __init__(
        self,
        scene: Scene,
        *,
        fmus: Path | None = None,
        watch: bool = True,
        order: int | None = None,
    ) -> None:
        self.scene = scene = as_run(scene)
        refuse_loose_tolerance(scene)
        self.profile = scene.profile()
        self.plan, order = plan(scene, order=order), order or scene.coupling.order
        self.runtime = runtime(scene.coupling.units)
        self.paths = find_or_build(self.plan.units, fmus, self.runtime.backend)
        with ExitStack() as stack:
            self.units = {
                one.name: stack.enter_context(Fmu(path, one.name))
                for path, one in zip(self.paths, self.plan.units, strict=True)
            }
            brief = brief_step(scene) if meets_events(scene) else 0.0
            self.system = System(self.plan, self.units, order, watch, brief)
            stack.callback(self.system.free_states)
            self._beginning = Beginning(self.system)
            stack.callback(self._beginning.free)
            self._stack = stack.pop_all()
        self.order, self.coupled = order, self.system.coupled
        self.gain = self.amplification = 0.0
        self._at: Scene | None = None  # kept: a map starts often at one speed
        self._jacobian: np.ndarray | None = None  # of the loop, at the last start
        self.time = 0.0
        self.steps = self.unconverged = 0
        self.worst_residual = 0.0

    def start(
        self,
        changes: Mapping[str, Mapping[str, float | bool]] | None = None,
        step: float | None = None,
        points: tuple[Sequence[float], float] | None = None,
        step_share: float = 0.0,
    ) -> None:
        """Restart all units from the scene's start values, `changes` by unit name on top.

        `step` is the communication step to come [s], by default the scene's.  With `points` the run
        before, which had a tolerance, begins again with the same start values and meets these:
        times [s], and the residual, of the largest force, that may stay in the loop.  Without
        points `step_share` of the tolerance, if it is above 0, is what a step may err.

        Raises:
            SimulationError: a unit refuses its parameters, or no consistent start exists.
        """
        self.time = 0.0
        self.steps = self.unconverged = 0
        self.worst_residual = 0.0
        step = step or step_size(self.scene)
        if points is None:
            self._begin(changes or {}, step)
            if step_share:
                self.scheme.allow_error(step_share)
        else:
            self._begin_again(step, *points)
        share = self.scheme.miss_per_error if self.system.order >= 3 else 0.0
        # an exchange that is unstable at any step is no matter of resolution
        judged = share and self.amplification <= 1.0 and self.coupled
        self.resolution = None
        if judged:
            self.resolution = Resolution(self._driven(changes), self.system, share, self.gain)

    @property
    def chooses_steps(self) -> bool:
        """Whether a tolerance picks the steps, since the start."""
        return self.scheme.chooses_steps

    def _driven(self, changes: Mapping[str, Mapping[str, float | bool]] | None) -> Scene:
        """The scene at the constant speed that a start gives instead of its own."""
        speeds = [own["speed"] for own in (changes or {}).values() if "speed" in own]
        if not speeds:
            return self.scene
        if self._at is None or self._at.operation.speed != speeds[0]:
            self._at = self.scene.replace({"operation.speed": speeds[0]})
        return self._at

    @cached_property
    def _rounding(self) -> float:
        """Of forces that cancel [N]."""
        return ROUNDING * largest_force(self.scene)

    def _begin(self, changes: Mapping[str, Mapping[str, float | bool]], step: float) -> None:
        """Start all units anew, for steps of this length [s]."""
        self.system.restart(changes)
        self.drive = DrivenSpeed(self.scene, self.system)
        self.scheme = self._prepare(step)
        for unit in self.units.values():
            unit.start()
        if self.scheme.chooses_steps:
            self._beginning.keep()

    def _begin_again(self, step: float, points: Sequence[float], residual: float) -> None:
        """Bring all back to the start of the run before, of whose loop all is known."""
        assert self._jacobian is not None
        self._beginning.again()
        self.drive = DrivenSpeed(self.scene, self.system)
        iterated = Iterated(self._jacobian, step, self.system.order, rounding=self._rounding)
        self.scheme = Prescribed(iterated, points, residual)

    def _prepare(self, step: float) -> Scheme:
        """Bring the units to a consistent start, and make the scheme for this loop."""
        system, rounding = self.system, self._rounding
        response = response_before(self.scene, system, step)
        self._jacobian = jacobian = consistent_start(system, step, rounding)
        eigenvalues = value_eigenvalues(jacobian, system.parts)
        self.gain = max(map(abs, eigenvalues), default=0.0)
        scheme = choose(self.scene, system, jacobian, response, step, self.gain, rounding)
        self.amplification = scheme.amplification(eigenvalues, system.order)
        return scheme

    def step(self, step: float, longest: float | None = None) -> float:
        """One communication step of length `step` [s]; returns its length.

        With a tolerance the step is chosen: at most `longest` and never beyond `step`.

        Raises:
            SimulationError: a unit failed, a signal is not finite, or the loop did not converge.
        """
        begin = self.time
        try:
            self._cover(step, longest)
            # an event is no communication point, but only at rest are these further apart
            step = min(step, longest or step)
            while self.system.has_no_past and step - (self.time - begin) > SLIVER * step:
                self._cover(step - (self.time - begin), longest)
        except SimulationError as error:
            if not self.coupled:
                raise
            hint = advice(error, self.scene)
            raise SimulationError(f"{error}; loop gain {self.gain:.3g}{hint}") from error
        return self.time - begin

    def _cover(self, step: float, longest: float | None) -> None:
        """A communication step, or what of it lies before something happens to weights."""
        for time, part in substeps(self.system, self.scheme, self.drive, self.time, step):
            self.time = time
            self._take(part, longest or part)
            if self.system.has_no_past:
                return

    def _take(self, step: float, longest: float) -> None:
        """A part of a communication step, judged and counted."""
        step, residual = self.scheme.step(self.system, self.time, step, longest)
        if self.resolution:
            self.resolution.check(self.time, step)
        if residual > self.worst_residual:
            self.worst_residual = residual
        if not self.scheme.judge(self.system, self.time, residual):
            self.unconverged += 1
        self.system.follow(self.time, step)
        self.time += step
        self.steps += 1

    def run(self) -> Iterator[float]:
        """Step through the scene's run; yields the finished fraction after every step.

        Raises:
            SimulationError: as `step`, or the scheme is unstable at the scene's loop gain.
        """
        if self.amplification > 1.0:
            raise SimulationError(
                f"{self.scheme.name} coupling of order {self.system.order} is unstable from "
                f"t = 0 s, at any step: every step repeats an error of "
                f"{', '.join(self.system.force_names)} {self.amplification:.3g}-fold; loop gain "
                f'{self.gain:.3g}; use scheme = "iterated" or "auto"'
            )
        end = end_time(self.scene)
        for (step, count), bound in zip(schedule(self.scene), milestones(self.scene), strict=True):
            start = self.time
            if self.scheme.chooses_steps:
                longest = step_size(self.scene, fewest_chosen(self.scene))
                while bound - self.time > SLIVER * bound:
                    self.step(bound - self.time, longest)
                    yield self.time / end
            else:
                for number in range(1, count + 1):
                    self.step(step)
                    # a product instead of a sum: rounding must not move the communication points
                    self.time = start + number * step
                    yield self.time / end
            self.time = bound

    def rows(self, recorder: Recorder) -> Iterator[float]:
        """`run`, recorded at the start and after every step."""
        recorder.take(self.time)
        for part in self.run():
            recorder.take(self.time)
            yield part

    def record(self, recorder: Recorder, progress: Progress | None) -> None:
        """`rows` to the end, with a report of `progress` now and then.

        Raises:
            UserError: the record will not fit into memory.
        """
        for count, part in enumerate(self.rows(recorder), start=1):
            if count % REPORTED == 0:
                recorder.refuse_too_much(part)
                if progress:
                    progress(part)

    def facts(self) -> Facts:
        """What the run since the last start did."""
        units = self.units.values()
        kinds = dict.fromkeys(kind for unit in units for kind in unit.calls)
        resolution = self.resolution
        return Facts(
            scene=self.scene,
            files=tuple(path.name for path in dict.fromkeys(self.paths)),
            note=self.runtime.note,
            messages=tuple(message for unit in units for message in unit.messages),
            calls={kind: sum(unit.calls[kind] for unit in units) for kind in kinds},
            passes=self.system.rotor.calls["step"],
            steps=self.steps,
            unconverged=self.unconverged,
            worst_residual=self.worst_residual,
            estimated_error=resolution.estimate if resolution else 0.0,
            unresolved=resolution.unresolved if resolution else 0,
        )

    def read(self, name: str, variables: Iterable[str]) -> list[float]:
        """Present values of variables of one unit."""
        unit = self.units[name]
        return unit.get(unit.group(list(variables)))

    def close(self) -> None:
        """Free all instances."""
        self._stack.close()
