"""A scene's units coupled in C, by its one file: stepped, recorded, restarted as `CoSimulation` is.

The same steps at the same points as with separate units, so that the results agree to rounding; the
library is called for some rows at once, and releases the interpreter's lock meanwhile.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...fmus.composite.run import Run, RunFailed, Stretch
from ...models.constants import FEWEST_CHOSEN, RESIDUAL_SHARE
from ..errors import LoopError, SimulationError
from ..scene import Scene
from .closing import Closing
from .compared import Compared, compared_motion
from .facts import Facts, advice, exchanging
from .names import readable
from .one_file import composition_in_c, model_name
from .recorder import Recorder, Signal, divided
from .schedule import (
    as_run,
    end_time,
    meets_events,
    milestones,
    schedule,
    step_size,
)
from .simulation import Repeated, refuse_loose_tolerance

if TYPE_CHECKING:
    from ..output.workers import Progress

# of the tolerance, what a step of a first run may err, by attempt; halved, it errs 1/16 or 1/64
SHARES = (10.0, 1.0, 0.1)
ROWS = 256  # of a call: interrupts and progress wait for its end
Group = tuple[NDArray[np.uintc], NDArray[np.float64]]


class OneFileRun(Closing):
    """The coupling in C of a scene; restarted and stepped any number of times.

    Args:
        scene: what to simulate.
        order: of the coupling signals; by default the scene's.

    Attributes:
        units: what is recorded of them, by name.
        time: reached so far [s].

    Raises:
        SceneError: the scene's units or coupling are none that one file has, or a tolerance is
            asked of a scheme or an order that cannot keep it.
    """

    estimates_errors = True

    def __init__(self, scene: Scene) -> None:
        self.scene = scene = as_run(scene)
        refuse_loose_tolerance(scene)
        made = composition_in_c(scene)
        self._run = Run(made)
        inside = scene.once(_variables_inside)
        self.units = {name: UnitInside(self._run, name, *of) for name, of in inside.items()}
        self.coupled = exchanging(scene)
        self._chooses_steps = scene.coupling.tolerance is not None and self.coupled
        self.meets_events = meets_events(scene)
        self.time, self._passes, self._parts = 0.0, 0.0, 1

    def like(self, scene: Scene) -> OneFileRun:
        """As `CoSimulation.like`."""
        return OneFileRun(scene)

    def start(self, *, attempt: int | None = None, again: Repeated | None = None) -> None:
        """As `CoSimulation.start`; without an attempt steps may err by less, for one run alone."""
        if self.time:
            self._passes += self._run.facts.passes
        self.time = 0.0
        try:
            share, points = 0.0 if attempt is None else SHARES[attempt], None
            self._parts = again.parts if again else 1
            if again and self._chooses_steps:
                allowed = RESIDUAL_SHARE * share * (self.scene.coupling.tolerance or 0.0)
                points = divided(again.times, again.parts), again.residual * allowed
            self._run.start(points, share)
        except RunFailed as failure:
            raise SimulationError(f"{self.scene.name}: {failure}") from None

    @property
    def in_one_piece(self) -> bool:
        """Whether the machine goes on in one piece: C decides at the start.

        Raises:
            SimulationError: as `start`.
        """
        self.start()
        return bool(self._run.facts.one_piece)

    def start_in_one_piece(
        self, share: float, points: Signal | None = None, grain: float = 0.0
    ) -> None:
        """From the start, with this share of a step's tolerance, recorded at points [s].

        Without points the record has equal parts of the machine's own steps.
        """
        self.start()
        self._run.start(None if points is None else (points.tolist(), 0.0), share, grain)

    def record(self, recorder: Recorder, progress: Progress | None) -> None:
        """As `CoSimulation.record`."""
        outputs = np.concatenate([np.zeros(0, np.uintc), *(g[0] for _, g in recorder.groups)])
        end = end_time(self.scene)
        recorder.record(self.time)
        for stretch in self._stretches():
            over = False
            while not over:
                rows = self._on(stretch, outputs, np.empty((ROWS, 1 + len(outputs))))
                over = len(rows) < ROWS
                recorder.extend(rows)
                self.time = float(rows[-1, 0]) if len(rows) else self.time
                if not over:
                    recorder.refuse_too_much(self.time / end)
                if progress:
                    progress(self.time / end)
            self.time = stretch.end

    def _stretches(self) -> Iterator[Stretch]:
        longest = step_size(self.scene, FEWEST_CHOSEN)
        for (step, count), bound in zip(schedule(self.scene), milestones(self.scene), strict=True):
            part = step / self._parts
            given = (0.0, longest, 0) if self._chooses_steps else (part, part, count * self._parts)
            yield Stretch(self.time, bound, *given)

    def _on(
        self, stretch: Stretch, outputs: NDArray[np.uintc], rows: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        filled = self._run.on(stretch, outputs, rows)
        if self._run.reason:
            kind = LoopError if self._run.facts.loop_failed else SimulationError
            hint = advice(kind(), self.scene, self.meets_events)
            raise SimulationError(f"{self._run.reason}{hint}")
        return filled

    def compared(self) -> Compared:
        """What the runs of this motion are compared by."""
        return compared_motion(self.scene, self.meets_events)

    def facts(self) -> Facts:
        """What the run since the last start did."""
        found = self._run.facts
        return Facts(
            scene=self.scene,
            files=(f"{model_name(self.scene)}.fmu",),
            note="",
            messages=tuple(self._run.warnings),
            calls={},
            passes=round(self._passes + found.passes),
            steps=round(found.steps),
            unconverged=round(found.unconverged),
            worst_residual=found.worst_residual,
            estimated_error=found.estimated_error,
            unresolved=round(found.unresolved),
            series_order=round(found.order),
            collocated_steps=round(found.collocated),
        )

    def close(self) -> None:
        """Free the run."""
        self._run.close()


class UnitInside:
    """What a `Recorder` reads of a unit within the one file, as of an `Fmu`."""

    def __init__(
        self, run: Run, name: str, variables: Mapping[str, int], measured_in: Mapping[str, str]
    ) -> None:
        """Of a run by the unit's name; its variables by their value references in the file."""
        self.name, self._run = name, run
        self.variables, self.measured_in = variables, measured_in

    def group(self, names: Sequence[str], memory: NDArray[np.float64]) -> Group:
        """Variables that are read together, and where to."""
        return np.array([self.variables[name] for name in names], np.uintc), memory

    def fetch(self, group: Group) -> None:
        """Read the group's variables."""
        self._run.read(*group)


def _variables_inside(scene: Scene) -> dict[str, tuple[dict[str, int], dict[str, str]]]:
    """By unit: value references of its variables in the one file, and what they are measured in."""
    made = composition_in_c(scene)
    found: dict[str, tuple[dict[str, int], dict[str, str]]]
    found = {part.name: ({}, {}) for part in made.parts}
    for variable in made.layout.variables:
        owner, own = _owned(variable.name)
        if owner in found:
            references, measured_in = found[owner]
            references[own] = made.layout.index[variable.name]
            measured_in[own] = readable(variable.unit)
    return found


@lru_cache(maxsize=4096)
def _owned(name: str) -> tuple[str, str]:
    """Unit and variable of a name in the one file: `der(balls.F_xi)` is `der(F_xi)` of `balls`."""
    der = "der(" * name.startswith("der(")
    owner, _, own = name.removeprefix(der).partition(".")
    return owner, f"{der}{own}"
