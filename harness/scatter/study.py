"""Many machines drawn from a scene's tolerances, each run in one piece."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import ClassVar, NamedTuple

import numpy as np
import tomli_w
from numpy.typing import NDArray

from ...models.harmonic_balance import NoResponse, largest_displacement, unbalance_response
from ..errors import SceneError, SimulationError
from ..master.merged import merged, names_of_states
from ..master.names import weight
from ..master.one_file import composition
from ..master.schedule import end_time
from ..output.store import open_store
from ..output.table import Sheet
from ..output.workers import Progress, Workers
from ..result.alike import table_of
from ..result.many import cosimulate_many
from ..scene import Scene
from ..scene.balancer import WeightBalancer
from ..scene.grade import moments, residual_unbalance
from .drawn import Columns, Drawn, Vector, run_drawn
from .vary import Variation, drawn, refuse_drawn, refuse_wrong

CHUNK = 50  # machines worked on together: some seconds at most
_NUMBERS = (
    *("residual", "grade", "settled", "merged", "behind", "alone"),
    *("largest", "largest_alone"),
)  # of a machine
BEHIND = 0.02  # of its speed: weights that lag by more, at the end and on average, are left behind


@dataclass(frozen=True, eq=False, repr=False)
class Scatter(Drawn):
    """Machines of a scene, and what came of each.

    Attributes:
        residual: (n,) largest amplitude in the last revolution [m]; NaN where the run failed.
        grade: (n,) of ISO 21940-11 that the residual unbalance at the end just meets [mm/s], under
            gravity that of the weights' mean moment in the last revolution; NaN where the run
            failed or the scene's balancers do not tell their unbalance.
        settled: (n,) 1 where the last two revolutions are alike and the machine is in no other
            motion: no weights are left behind, and with weights it vibrates less than without.
        merged: (n,) 1 where identical weights cannot part though they would, `master.merged`.
        behind: (n,) weights that are left behind at the end.
        alone: (n,) steady amplitude of the same machine without balancers [m]; NaN: not known.
        largest, largest_alone: (n,) of the run, and of that without balancers [m].
        left_out: why there are no grades; else empty.
        has_weights: not only liquid.
    """

    drawn_by: ClassVar[str] = "..scatter.plot:plot_scatter"
    document_by: ClassVar[str] = "..scatter.report:document"

    residual: Vector
    grade: Vector
    settled: Vector
    merged: Vector
    behind: Vector
    alone: Vector
    largest: Vector
    largest_alone: Vector
    left_out: str = ""
    has_weights: bool = True

    @property
    def unbalanced(self) -> NDArray[np.bool_]:
        """(n,) whose weights turn with the rotor, which vibrates no less than without them."""
        more = self.residual >= self.alone
        return np.asarray(self.ran & (self.behind == 0) & more & self.has_weights)

    def table(self) -> Sheet:
        """One line a machine."""
        return self._sheet(
            {
                "residual amplitude [m]": self.residual,
                "grade [mm/s]": self.grade,
                "settled": self.settled,
                "merged": self.merged,
                "weights left behind": self.behind,
                "amplitude without balancers [m]": self.alone,
                "largest amplitude [m]": self.largest,
                "largest without balancers [m]": self.largest_alone,
            }
        )


def scatter(
    scene: Scene,
    variations: Sequence[Variation],
    count: int,
    *,
    seed: int = 1,
    workers: Workers = 1,
    progress: Progress | None = None,
    store: str | Path | None = None,
) -> Scatter:
    """Draw machines and run each; the same seed draws the same ones.

    Arguments are those of `Scene.scatter`, which says what is raised.
    """
    values = draw_machines(scene, variations, count, seed)
    paths = [one.path for one in variations]
    made_for = {
        "content": "scatter",
        "scene": tomli_w.dumps(scene.document),
        "variations": "\n".join(one.text for one in variations),
        "seed": str(seed),
        "number of machines": str(count),
    }
    kept = None if store is None else open_store(store, made_for)
    try:
        numbers, failure = run_drawn(
            _machines, (scene, paths), values, CHUNK, workers, progress, kept
        )
    except SimulationError as error:
        raise SimulationError(f"{scene.label}: no machine could be run: {error}") from error
    return Scatter(
        title=scene.heading,
        variations=tuple(variations),
        seed=seed,
        values=values,
        failure=failure,
        **dict(zip(_NUMBERS, numbers.T, strict=True)),
        left_out="" if moments(scene) is not None else "the unbalance of a liquid is not known",
        has_weights=any(isinstance(one, WeightBalancer) for one in scene.balancer),
    )


def draw_machines(
    scene: Scene, variations: Sequence[Variation], count: int, seed: int = 1
) -> NDArray[np.float64]:
    """(count, variations) values, as `scatter` runs them.

    Raises:
        UserError: a path cannot vary, or a value that is drawn is not allowed.
    """
    scene.refuse_free("scatter")
    typical = refuse_wrong(scene, variations)
    composition(typical)
    values = drawn(variations, count, seed)
    refuse_drawn(typical, variations, values)
    return values


def _machines(job: tuple[Scene, list[str], Vector]) -> Columns:
    """Outcomes of some machines; one that cannot be costs itself alone."""
    scene, paths, values = job
    failure = np.full(len(values), "", dtype=object)
    machines: dict[int, Scene] = {}
    for k, row in enumerate(values.tolist()):
        try:
            machines[k] = scene.replace(dict(zip(paths, row, strict=True)))
        except SceneError as error:
            failure[k] = str(error)
    found = np.full((len(values), len(_NUMBERS)), np.nan)
    if machines:
        rows = list(machines)
        found[rows], failure[rows] = _outcomes(list(machines.values()))
    return found, failure


class _Asked(NamedTuple):
    """What is read of the runs of machines, by its names.

    Attributes:
        states: of `merged`.
        held_by: by the names that a grade asks for, the moments that are read; none of a liquid.
        rates: speeds of weights in the rotor [rad/s], and how far they lag behind it on average.
        motor: the motor's speed, where there is one.
    """

    states: list[str]
    held_by: dict[str, str]
    rates: list[tuple[str, str]]
    motor: list[str]

    @classmethod
    def of(cls, machines: list[Scene]) -> _Asked:
        """Of machines of one scene."""
        first, heavy = machines[0], any(one.operation.gravity for one in machines)
        kept = ".mean_moment_" if heavy else ".moment_"  # weights swing once per revolution
        weights = [
            f"{b.label}.{weight(k, '')}"
            for b in first.balancer
            if isinstance(b, WeightBalancer)
            for k in range(1, b.count + 1)
        ]
        return cls(
            names_of_states(first),
            {name: name.replace(".moment_", kept) for name in moments(first) or ()},
            [(f"{w}speed", f"{w}mean_lag") for w in weights],
            ["motor.speed"] if first.operation.motor else [],
        )

    @property
    def results(self) -> list[str]:
        """All of it."""
        of_run = ["residual", "settled", "largest"]
        names = [*of_run, *self.held_by.values(), *self.states, *chain(*self.rates), *self.motor]
        return list(dict.fromkeys(names))


def _outcomes(machines: list[Scene]) -> Columns:
    """Of machines that can be run, by row."""
    asked = _Asked.of(machines)
    graded = moments(machines[0]) is not None
    outcomes = cosimulate_many(machines[0], table_of(machines), results=asked.results, threads=1)
    bare = [one.without_balancers() for one in machines]
    without = cosimulate_many(bare[0], table_of(bare), results=["largest"], threads=1)
    found = np.full((len(machines), len(_NUMBERS)), np.nan)
    for k, machine in enumerate(machines):
        if not outcomes["failure"][k]:
            own = {name: float(outcomes[name][k]) for name in asked.results}
            found[k] = *_numbers(machine, own, asked, graded), without["largest"][k]
    return found, outcomes["failure"]


def _numbers(
    machine: Scene, own: dict[str, float], asked: _Asked, graded: bool
) -> tuple[float, ...]:
    """All but the last of `_NUMBERS` of a machine whose run has not failed."""
    end, grade = end_time(machine), math.nan
    if graded:
        held = {name: own[by] for name, by in asked.held_by.items()}
        grade = residual_unbalance(machine, held, end)[1]
    speed = own["motor.speed"] if asked.motor else machine.profile().speed(end)
    behind = sum(min(-own[now], own[mean]) > BEHIND * speed for now, mean in asked.rates)
    alone = _alone(machine, speed)
    other = behind or (bool(asked.rates) and own["residual"] >= alone)
    return (
        own["residual"],
        grade,
        0.0 if other else own["settled"],
        bool(merged(machine, {name: own[name] for name in asked.states})),
        behind,
        alone,
        own["largest"],
    )


def _alone(machine: Scene, speed: float) -> float:
    """Steady amplitude without balancers [m]; NaN where it is not known."""
    if not speed > 0.0:
        return math.nan
    rotor = machine.assembly().at(end_time(machine)).rotor
    try:
        return float(largest_displacement(unbalance_response(rotor, [speed])).max())
    except NoResponse:
        return math.nan
