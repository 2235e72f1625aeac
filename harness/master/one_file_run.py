"""A scene's machine in C, by its one file: run, recorded, restarted as `CoSimulation` is.

The library is called for some rows at once, and releases the interpreter's lock meanwhile.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...fmus.composite.run import Run, RunFailed, Stretch
from ..errors import SimulationError
from ..scene import Scene
from .closing import Closing
from .facts import Facts, exchanging
from .limits import FEWEST_CHOSEN
from .names import readable
from .one_file import composition_in_c, model_name
from .recorder import Recorder, Signal
from .schedule import end_time, in_one_piece, milestones, schedule, step_size

if TYPE_CHECKING:
    from ..output.workers import Progress

ROWS = 256  # of a call: interrupts and progress wait for its end
Group = tuple[NDArray[np.uintc], NDArray[np.float64]]


class OneFileRun(Closing):
    """The machine of a scene in one piece; restarted and run any number of times.

    Args:
        scene: what to simulate.

    Attributes:
        scene: as it is run: with its tolerance, or the default in place of given steps.
        units: what is recorded of them, by name.
        coupled: whether the run keeps a tolerance; a rotor alone is right to rounding.
        rows: times of the record where the scene gives steps [s], else None.
        events: how many events lie before each row of the last record.
        time: reached so far [s].

    Raises:
        SceneError: the scene's units are none that one file has.
    """

    def __init__(self, scene: Scene) -> None:
        self._given, self._steps_per_rev = scene, scene.coupling.steps_per_rev
        self.scene = in_one_piece(scene)
        made = composition_in_c(scene)
        self._run = Run(made)
        inside = scene.once(_variables_inside)
        self.units = {name: UnitInside(self._run, name, *of) for name, of in inside.items()}
        self.coupled = exchanging(scene) or not scene.rotor.is_linear
        self.rows = self._given_rows() if self._steps_per_rev else None
        self.time, self.events = 0.0, np.zeros(1)

    def another(self) -> OneFileRun:
        """A run of the same machine beside this one."""
        return OneFileRun(self._given)

    def start(
        self,
        share: float = 0.0,
        points: Signal | None = None,
        grain: float = 0.0,
        angles: Mapping[str, Sequence[float]] | None = None,
    ) -> None:
        """From the start, with this share of a step's tolerance, recorded at points [s].

        Without points the record has equal parts of the machine's own steps; of a rotor alone, the
        scene's steps.  `grain` is that of `Run`; `angles` are those of weights that start elsewhere
        than the scene says [rad], by balancer.

        Raises:
            SimulationError: the machine cannot be started.
        """
        self.time = 0.0
        changed = {
            self.units[name].variables[f"weight[{k}].angle0"]: angle
            for name, own in (angles or {}).items()
            for k, angle in enumerate(own, start=1)
        }
        try:
            self._run.start(() if points is None else points, share, grain, changed)
        except RunFailed as failure:
            raise SimulationError(f"{self.scene.label}: {failure}") from None

    def _given_rows(self) -> Signal:
        """Ends of the steps that the scene gives [s]."""
        begins = [0.0, *milestones(self.scene)]
        parts = zip(begins, schedule(self.scene, self._steps_per_rev), strict=False)
        return np.concatenate([b + step * np.arange(1, n + 1) for b, (step, n) in parts])

    def record(self, recorder: Recorder, progress: Progress | None) -> None:
        """As `CoSimulation.record`."""
        outputs = np.concatenate([np.zeros(0, np.uintc), *(g[0] for _, g in recorder.groups)])
        end, counts = end_time(self.scene), [np.zeros(1)]
        recorder.record(self.time)
        for stretch in self._stretches():
            over = False
            while not over:
                passed = np.empty(ROWS)
                rows = self._on(stretch, outputs, np.empty((ROWS, 1 + len(outputs))), passed)
                over = len(rows) < ROWS
                recorder.extend(rows)
                counts.append(passed[: len(rows)])
                self.time = float(rows[-1, 0]) if len(rows) else self.time
                if not over:
                    recorder.refuse_too_much(self.time / end)
                if progress:
                    progress(self.time / end)
            self.time = stretch.end
        self.events = np.concatenate(counts)

    def _stretches(self) -> Iterator[Stretch]:
        longest = step_size(self.scene, FEWEST_CHOSEN)
        rows = schedule(self.scene, self._steps_per_rev)
        for (step, count), bound in zip(rows, milestones(self.scene), strict=True):
            given = (0.0, longest, 0) if self.coupled else (step, step, count)
            yield Stretch(self.time, bound, *given)

    def _on(
        self,
        stretch: Stretch,
        outputs: NDArray[np.uintc],
        rows: NDArray[np.float64],
        passed: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        filled = self._run.on(stretch, outputs, rows, passed)
        if self._run.reason:
            raise SimulationError(self._run.reason)
        return filled

    def facts(self) -> Facts:
        """What the run since the last start did."""
        found = self._run.facts
        return Facts(
            scene=self.scene,
            files=(f"{model_name(self.scene)}.fmu",),
            note="",
            messages=tuple(self._run.warnings),
            calls={},
            passes=round(found.passes),
            steps=round(found.steps),
            unconverged=0,
            worst_residual=0.0,
            series_order=round(found.order),
            collocated_steps=round(found.collocated),
        )

    @property
    def is_stiff(self) -> bool:
        """Whether steps by collocation are tried, as of a stiff machine, or may be later: of a
        motor's shaft with internal damping, which a large whirl takes along."""
        return bool(self._run.facts.stiff)

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
