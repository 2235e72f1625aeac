"""Settling of weights from random starts, co-simulated: times, final spreads and decay rates."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...models.papers.settling import settling_time
from ...models.weights import alignment
from ..errors import SimulationError
from ..master.one_file import composition_in_c
from ..master.schedule import schedule, steps_per_rev
from ..scene import Scene
from ..scene.balancer import WeightBalancer
from .decay import WINDOW, Decay, below, decay

Start = tuple[float, ...]  # angles of the weights [rad]

SETTLED_UNBALANCE = 0.01  # of the scale: residual unbalance that counts as balanced
READINGS = 8  # about, in a revolution: enough to see when a residual falls below a limit for good
CONFIDENCE = 0.95
FEWEST_STARTS = 6  # all on one side of the median: 2/2^6 = 3 %, but 2/2^5 = 6 %


@dataclass(frozen=True)
class Batch:
    """Starts of one design, run one after the other by the same units.

    Attributes:
        scene: with the weights.
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
        seconds: until the residual stays below `SETTLED_UNBALANCE`; infinite where it did not, NaN
            where the run failed.
        alignment: p at the end.
        decay: the linear end of the run against the slow root; None where the supports are not
            isotropic.
        failure: why the run failed; empty where it did not.
    """

    seconds: float
    alignment: float
    decay: Decay | None
    failure: str = ""

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


def run_batch(batch: Batch) -> list[SettlingRun]:
    """Every start of a batch, run in C as the scene's one file; one that fails costs itself alone.

    Raises:
        SceneError: one file does not have the scene's coupling or units.
    """
    from ...fmus.composite.batch import BatchRuns  # compiles where it has to

    balls, scene = weights_in(batch.scene), batch.scene
    weights = [f"{balls.label}.weight[{k}]" for k in range(1, balls.count + 1)]
    read = [*(f"{balls.label}.moment_{axis}" for axis in ("xi", "eta")), *_named(weights, "angle")]
    ((length, count),) = schedule(scene)
    runs = BatchRuns(composition_in_c(scene), _named(weights, "angle0"), read, count)
    signals, reasons = runs(np.array(batch.starts), np.full(len(batch.starts), length * count))
    every = max(1, round(steps_per_rev(scene) / READINGS))
    numbers = np.unique([*range(every, count + 1, every), count])
    return [
        SettlingRun(math.nan, math.nan, None, reason)
        if reason
        else _settling_run(batch, length * numbers, rows)
        for reason, rows in zip(reasons, signals[:, numbers], strict=True)
    ]


def weights_in(scene: Scene) -> WeightBalancer:
    """The one set of weights of a scene for a design."""
    balls = scene.balancer[0]
    assert isinstance(balls, WeightBalancer)
    return balls


def _named(weights: list[str], variable: str) -> list[str]:
    return [f"{each}.{variable}" for each in weights]


def _settling_run(batch: Batch, times: np.ndarray, rows: np.ndarray) -> SettlingRun:
    """From readings (k, 2 + weights) of the weights' moment [kg m] and their angles [rad]."""
    assembly, speed = batch.scene.assembly(), batch.scene.profile().speed(0.0)
    moment = complex(assembly.rotor.unbalance[0]) + rows[:, 0] + 1j * rows[:, 1]
    residuals = np.abs(moment) / batch.scale
    # what follows a whole revolution far below SETTLED_UNBALANCE does not count
    last_high = np.maximum.accumulate(np.where(residuals > WINDOW[0], np.arange(len(times)), -1))
    low_since = times[np.minimum(last_high + 1, len(times) - 1)]
    low = np.flatnonzero(times - low_since > math.tau / speed)
    count = int(low[0]) + 1 if low.size else len(times)
    times, residuals, angles = times[:count], residuals[:count], rows[:count, 2:]
    end = None
    if assembly.rotor.isotropic:
        alpha = weights_in(batch.scene).half_angle
        end = decay(assembly, speed, alpha, times, residuals, angles.tolist())
    return SettlingRun(settled_at(times, residuals), alignment(angles[-1]), end)


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
