"""How many weights, and how large: Goncharov's closed forms beside co-simulated settling times."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ...models.papers import capacity as theory
from ...models.papers.settling import settling_time, slow_root
from ..master.schedule import end_time
from ..output.outcome import Outcome
from ..output.table import Sheet
from ..output.workers import Progress, Workers, in_order
from ..scene import Scene
from .decay import Decay
from .scenes import (
    batches,
    drag_limit,
    is_isotropic,
    race_of,
    sized,
    unbalance_of,
    weights_of,
    with_balls,
)
from .settling import (
    FEWEST_STARTS,
    SETTLED_UNBALANCE,
    SettlingRun,
    median_interval,
    refuse_few,
    run_batch,
)
from .space import MATERIALS


@dataclass(frozen=True)
class Choice:
    """One number of weights.

    Attributes:
        scene: with these weights.
        count, radius, mass, capacity: n, r [m], m [kg], S [kg m].
        packed, largest: spread p of the packed group, and the largest one (10), (13).
        measure: function (15) or (16) at this radius.
        predicted: time in which the slow root (1) falls to `SETTLED_UNBALANCE` at the
            largest p [s]; NaN on anisotropic supports.
        has_capacity: it reaches the unbalance with the reserve; where it does not, nothing is run.
        median, low, high: co-simulated settling time and its 95 % confidence interval [s] of the
            starts that did not fail; infinite: not within the run; NaN where nothing was run, or
            too many starts failed.
        runs: every start.
    """

    scene: Scene
    count: int
    radius: float
    mass: float
    capacity: float
    packed: float
    largest: float
    measure: float
    predicted: float
    has_capacity: bool
    median: float
    low: float
    high: float
    runs: tuple[SettlingRun, ...]

    @property
    def ran(self) -> tuple[SettlingRun, ...]:
        """Starts whose runs did not fail."""
        return tuple(run for run in self.runs if not run.failure)

    @property
    def failures(self) -> list[tuple[int, str]]:
        """Starts that failed, counted from 1, and why."""
        return [(k, run.failure) for k, run in enumerate(self.runs, start=1) if run.failure]

    @property
    def seconds(self) -> float:
        """Length of a run [s]."""
        return end_time(self.scene)

    @property
    def settled(self) -> int:
        """How many starts settled."""
        return sum(math.isfinite(run.seconds) for run in self.runs)

    @property
    def median_alignment(self) -> float:
        """Median of p where the runs ended."""
        return float(np.median([run.alignment for run in self.ran])) if self.ran else math.nan

    @property
    def predicted_at_end(self) -> float:
        """Median of the times that the slow root predicts for the positions reached [s]."""
        return float(np.median([run.predicted for run in self.ran])) if self.ran else math.nan


@dataclass(frozen=True, repr=False)
class Design(Outcome):
    """All numbers of weights for one rotor and space.

    Attributes:
        title, kind: of the scene, of its weights.
        race: radius on which they roll [m].
        unbalance: the largest to be balanced [kg m].
        choices: by number of weights.
        reserve: capacity that is asked for, over the unbalance.
        least: the smallest unbalance that occurs [kg m].
    """

    drawn_by: ClassVar[str] = "..design.plot:plot_capacity"

    title: str
    kind: str
    unbalance: float
    race: float
    choices: tuple[Choice, ...]
    reserve: float = 1.0
    least: float = 0.0

    @property
    def with_capacity(self) -> list[Choice]:
        """Those with enough capacity."""
        return [c for c in self.choices if c.has_capacity]

    def table(self) -> Sheet:
        """One line for every number of weights."""
        rows = [
            (
                *(c.count, 2.0 * c.radius, c.count * c.mass, c.capacity, c.median, c.low, c.high),
                len(c.failures),
                c.failures[0][1] if c.failures else "",
            )
            for c in self.choices
        ]
        times = ("settling time [s]", "95 % from [s]", "to [s]", "failed starts", "failure")
        columns = ("n", "diameter [m]", "mass of all [kg]", "capacity [kg m]", *times)
        return Sheet(columns, rows, "r" * len(columns), self.title)

    @property
    def decays(self) -> list[Decay]:
        """Ends of all runs, where the closed forms hold."""
        return [run.decay for c in self.with_capacity for run in c.runs if run.decay]


def design(
    scene: Scene,
    *,
    unbalance: float | None = None,
    race: float | None = None,
    width: float | None = None,
    density: float = MATERIALS["steel"],
    counts: Sequence[int] = range(2, 9),
    starts: int = 200,
    workers: Workers = 1,
    progress: Progress | None = None,
    reserve: float = 1.0,
    least: float = 0.0,
) -> Design:
    """Compare numbers of weights on the rotor of a scene.

    Starts run in C as one file.

    Arguments are those of `Scene.design`, which says what is raised, as numbers in SI units;
    `width` is the height of rollers, or the largest diameter of balls.
    """
    refuse_few(starts)  # before the work
    scene.refuse_unrest("a design")
    scene.refuse_free("a design")
    scene.refuse_lobes("a design is that")
    scene = with_balls(scene, race, width)
    balls = weights_of(scene)
    amount = unbalance_of(scene) if unbalance is None else unbalance
    race = race_of(balls) if race is None else race
    scenes = sized(scene, counts, amount, race, width, density)
    work = [batch for n in counts for batch in batches(scenes[n], amount, starts, reserve=reserve)]
    outcomes = in_order(run_batch, work, workers, progress)
    runs: dict[int, list[SettlingRun]] = {n: [] for n in counts}
    for batch, outcome in zip(work, outcomes, strict=True):
        runs[weights_of(batch.scene).count] += outcome
    choices = tuple(_choice(scenes[n], reserve * amount, runs[n]) for n in counts)
    return Design(scene.title, balls.kind, amount, race, choices, reserve, least)


def _choice(scene: Scene, required: float, runs: list[SettlingRun]) -> Choice:
    balls = weights_of(scene)
    radius, alpha = balls.weight_radius or 0.0, balls.half_angle
    largest = theory.largest_alignment(balls.count, alpha)
    limit = balls.capacity
    times, predicted = [run.seconds for run in runs if not run.failure], math.nan
    if is_isotropic(scene):
        predicted = settling_time(
            slow_root(balls.device, largest, drag_limit(scene)), SETTLED_UNBALANCE
        )
    return Choice(
        scene,
        balls.count,
        radius,
        balls.mass,
        limit,
        theory.packed_alignment(balls.count, alpha),
        largest,
        theory.settling_shape(balls.kind, radius / race_of(balls), balls.count),
        predicted,
        limit >= required,
        *(median_interval(times) if len(times) >= FEWEST_STARTS else (math.nan,) * 3),
        tuple(runs),
    )
