"""Settling of weights from random starts, co-simulated: times, final spreads and decay rates."""

from __future__ import annotations

import math
import random
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ...models.papers.settling import settling_time
from ...models.weights import alignment
from ..errors import SimulationError
from ..master.one_file import composition_in_c
from ..master.schedule import at_fixed_steps, schedule, steps_per_rev
from ..scene import Scene
from ..scene.balancer import WeightBalancer
from .decay import WINDOW, Decay, below, decay

Start = tuple[float, ...]  # angles of the weights [rad]
# times [s], residuals over the scale, and angles of all weights [rad]
Readings = tuple[np.ndarray, np.ndarray, list[list[float]]]

SETTLED_UNBALANCE = 0.01  # of the scale: residual unbalance that counts as balanced
READINGS = 8  # about, in a revolution: enough to see when a residual falls below a limit for good
CONFIDENCE = 0.95
_COUNTS = ("coupling.unconverged", "coupling.steps")
FEWEST_STARTS = 6  # all on one side of the median: 2/2^6 = 3 %, but 2/2^5 = 6 %


@dataclass(frozen=True)
class Batch:
    """Starts of one design, run one after the other by the same units.

    Attributes:
        starts: angles of all weights [rad], one list a start.
        scale: residual unbalance 1 [kg m].
    """

    scene: Scene
    starts: tuple[Start, ...]
    scale: float


@dataclass(frozen=True)
class SettlingRun:
    """One run.

    Attributes:
        seconds: until the residual stays below `SETTLED_UNBALANCE`; infinite where it did not.
        alignment: p at the end.
        decay: the linear end of the run against the slow root; None where the supports are not
            isotropic.
        unconverged, steps: communication steps whose loop left more than `LOOSE_RESIDUAL` of the
            force; of all.
    """

    seconds: float
    alignment: float
    decay: Decay | None
    unconverged: int = 0
    steps: int = 0

    @property
    def predicted(self) -> float:
        """Time in which the slow root there falls to `SETTLED_UNBALANCE` [s], or NaN."""
        return settling_time(self.decay.root, SETTLED_UNBALANCE) if self.decay else math.nan


def random_start(count: int, alpha: float, rng: random.Random) -> Start:
    """Angles of weights that do not overlap, uniform among all such positions [rad].

    Args:
        alpha: half the angle between neighbours that touch.
    """
    free = math.tau - 2.0 * count * alpha
    cuts = sorted(rng.uniform(0.0, free) for _ in range(count - 1))
    begin = rng.uniform(0.0, math.tau)
    return tuple(begin + cut + 2.0 * alpha * k for k, cut in enumerate([0.0, *cuts]))


def facing_start(count: int, alpha: float, rng: random.Random) -> Start:
    """Angles of two groups that face each other, from packed to evenly spread: p large [rad].

    Args:
        alpha: half the angle between neighbours that touch.
    """
    middle = rng.uniform(0.0, math.tau)
    room = math.tau / count - 2.0 * alpha
    angles: list[float] = []
    for size, side in ((count - count // 2, 0.0), (count // 2, math.pi)):
        gaps = [2.0 * alpha + rng.uniform(0.0, 0.5 * room) for _ in range(size - 1)]
        place = middle + side - 0.5 * sum(gaps)
        for gap in [0.0, *gaps]:
            place += gap
            angles.append(place)
    return tuple(angles)


def run_batch(batch: Batch) -> list[SettlingRun]:
    """Every start of a batch, run in C as the scene's one file.

    Raises:
        SceneError: one file does not have the scene's coupling or units.
        SimulationError: a run has failed.
    """
    from ...fmus.composite.batch import BatchRuns  # compiles where it has to

    balls, scene = _balls(batch), at_fixed_steps(batch.scene)
    changed, asked = (
        [f"{balls.label}.{name}" for name in of(balls)] for of in (_start_names, _read_names)
    )
    ((length, count),) = schedule(scene)
    runs = BatchRuns(composition_in_c(scene), changed, [*asked, *_COUNTS], count)
    signals, reasons = runs(np.array(batch.starts), np.full(len(batch.starts), length * count))
    if any(reasons):
        raise SimulationError(f"{scene.name}: {next(filter(None, reasons))}")
    numbers, settled = _read_after(scene), []
    for rows in signals[:, numbers]:
        samples = zip((length * number for number in numbers), rows[:, :-2].tolist(), strict=True)
        readings = _until_settled(batch, samples)
        counts = rows[len(readings[0]) - 1, -2:].astype(int).tolist()
        settled.append(_settling_run(batch, balls, readings, *counts))
    return settled


def _balls(batch: Batch) -> WeightBalancer:
    balls = batch.scene.balancer[0]
    assert isinstance(balls, WeightBalancer)
    return balls


def _start_names(balls: WeightBalancer) -> list[str]:
    return [f"weight[{k}].angle0" for k in range(1, balls.count + 1)]


def _read_names(balls: WeightBalancer) -> list[str]:
    angles = [f"weight[{k}].angle" for k in range(1, balls.count + 1)]
    return ["moment_xi", "moment_eta", *angles]


def _read_after(scene: Scene) -> list[int]:
    """Numbers of the steps after which a run is read."""
    every = max(1, round(steps_per_rev(scene) / READINGS))
    ((_, count),) = schedule(scene)
    return [number for number in range(1, count + 1) if number % every == 0 or number == count]


def _until_settled(batch: Batch, samples: Iterable[tuple[float, Sequence[float]]]) -> Readings:
    """Readings until the run has settled, from times [s] with moments and angles of the weights."""
    unbalance = complex(batch.scene.assembly().rotor.unbalance[0])
    times, residuals, places = [], [], []
    turn = math.tau / batch.scene.profile().speed(0.0)
    low_since = math.inf
    for time, (xi, eta, *angles) in samples:
        times.append(time)
        residuals.append(abs(unbalance + complex(xi, eta)) / batch.scale)
        places.append(angles)
        low_since = min(low_since, time) if residuals[-1] <= WINDOW[0] else math.inf
        if time - low_since > turn:  # far below SETTLED_UNBALANCE for a whole revolution
            break
    return np.array(times), np.array(residuals), places


def _settling_run(
    batch: Batch,
    balls: WeightBalancer,
    readings: Readings,
    unconverged: int,
    steps: int,
) -> SettlingRun:
    times, residuals, places = readings
    assembly, speed = batch.scene.assembly(), batch.scene.profile().speed(0.0)
    end = None
    if assembly.rotor.isotropic:
        end = decay(assembly, speed, balls.half_angle, times, residuals, places)
    return SettlingRun(
        settled_at(times, residuals),
        alignment(places[-1]),
        end,
        unconverged,
        steps,
    )


def settled_at(times: np.ndarray, residuals: np.ndarray) -> float:
    """Time after which residuals stay below `SETTLED_UNBALANCE` [s]; infinite if they do not."""
    begin = below(residuals, SETTLED_UNBALANCE)
    return math.inf if begin >= len(times) else float(times[begin])


def refuse_few(starts: int) -> None:
    """Raise SimulationError where the median of so many starts has no confidence interval."""
    if starts < FEWEST_STARTS:
        raise SimulationError(
            f"{starts} starts are too few for a confidence interval: {FEWEST_STARTS} are needed"
        )


def median_interval(values: Sequence[float]) -> tuple[float, float, float]:
    """Median and its 95 % confidence interval from order statistics, whatever the distribution.

    Infinite values count as later than all others.

    Raises:
        SimulationError: there are too few values for an interval.
    """
    from scipy.stats import quantile_test

    refuse_few(len(values))
    interval = quantile_test(values).confidence_interval(CONFIDENCE)
    return float(np.median(values)), float(interval.low), float(interval.high)
