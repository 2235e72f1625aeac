"""Settling of weights from random starts, co-simulated: times, final spreads and decay rates."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass

import numpy as np

from ..models.positions import least_distance
from ..models.settling import plane_response, slow_roots
from ..models.weights import Weights, spread
from .errors import SimulationError
from .master import CoSimulation
from .scene import Scene
from .scene_balancer import WeightBalancer
from .schedule import schedule

SETTLED = 0.01  # of the scale: residual unbalance that counts as balanced
FITTED = (1e-4, 3e-3)  # of the scale: residuals from which the decay rate is fitted
READINGS = 5  # communication steps between readings
FEWEST = 8  # readings in a fit
APART = 2.0  # the slow root is dominant where everything else is this many times faster
FREE = 1e-3  # rad: weights closer than this touch, and the slow root knows no contact


@dataclass(frozen=True)
class Batch:
    """Starts of one design, run one after the other with the same loaded units.

    Attributes:
        starts: angles of all weights [rad], one list a start.
        scale: residual unbalance 1 [kg m].
    """

    scene: Scene
    starts: tuple[tuple[float, ...], ...]
    scale: float


@dataclass(frozen=True)
class Settled:
    """One run.

    Attributes:
        seconds: until the residual stays below `SETTLED`; infinite where it did not.
        spread: p at the end.
        rate: fitted decay rate of the residual [1/s], NaN without enough readings.
        root: slow root at the end's p where it is real and dominant and no weights touch, else
            NaN [1/s].
        unconverged, steps: communication steps whose loop left more than 1e-3 of the force; of all.
    """

    seconds: float
    spread: float
    rate: float
    root: float
    unconverged: int = 0
    steps: int = 0


def random_start(count: int, alpha: float, rng: random.Random) -> tuple[float, ...]:
    """Angles of weights that do not overlap, uniform among all such positions [rad].

    Args:
        alpha: half the angle between neighbours that touch.
    """
    free = math.tau - 2.0 * count * alpha
    cuts = sorted(rng.uniform(0.0, free) for _ in range(count - 1))
    begin = rng.uniform(0.0, math.tau)
    return tuple(begin + cut + 2.0 * alpha * k for k, cut in enumerate([0.0, *cuts]))


def run_batch(batch: Batch) -> list[Settled]:
    """Every start of a batch."""
    balls = batch.scene.balancer[0]
    assert isinstance(balls, WeightBalancer)
    with CoSimulation(batch.scene) as units:
        return [_run(units, batch, balls, start) for start in batch.starts]


def _run(
    units: CoSimulation, batch: Batch, balls: WeightBalancer, start: tuple[float, ...]
) -> Settled:
    angles = {f"weight[{k}].angle0": angle for k, angle in enumerate(start, start=1)}
    units.start({balls.label: angles})
    unbalance = complex(batch.scene.assembly().rotor.unbalance[0])
    times, residuals = [0.0], [math.inf]
    turn = math.tau / batch.scene.profile().speed(0.0)
    low_since = math.inf
    ((step, count),) = schedule(batch.scene)
    for number in range(1, count + 1):
        units.step(step)
        units.time = number * step
        if number % READINGS:
            continue
        moment = complex(*units.read(balls.label, ("moment_xi", "moment_eta")))
        times.append(units.time)
        residuals.append(abs(unbalance + moment) / batch.scale)
        if residuals[-1] > FITTED[0]:
            low_since = math.inf
        else:
            low_since = min(low_since, units.time)
            if units.time - low_since > turn:  # a hundredth of SETTLED for a whole revolution
                break
    names = [f"weight[{k}].angle" for k in range(1, balls.count + 1)]
    angles_end = units.read(balls.label, names)
    final = spread(angles_end)
    seconds = settled_at(np.array(times), np.array(residuals))
    apart = 2.0 * math.asin((balls.weight_radius or 0.0) / balls.track_radius)
    free = least_distance(angles_end) > apart + FREE
    root = _dominant(batch.scene, final) if free else math.nan
    rate = decay_rate(np.array(times), np.array(residuals))
    return Settled(seconds, final, rate, root, units.unconverged, units.steps)


def settled_at(times: np.ndarray, residuals: np.ndarray) -> float:
    """Time after which all residuals are below `SETTLED`; infinite if the last one is not [s]."""
    above = np.flatnonzero(residuals > SETTLED)
    last = int(above[-1]) if above.size else -1
    return math.inf if last + 1 >= len(times) else float(times[last + 1])


def decay_rate(times: np.ndarray, residuals: np.ndarray) -> float:
    """Rate of the exponential through the last readings within `FITTED` [1/s]; NaN if too few."""
    low, high = FITTED
    above = np.flatnonzero(residuals > high)
    begin = int(above[-1]) + 1 if above.size else 0
    chosen = np.arange(begin, len(residuals))
    chosen = chosen[residuals[chosen] > low]
    if len(chosen) < FEWEST:
        return math.nan
    return float(np.polyfit(times[chosen], np.log(residuals[chosen]), 1)[0])


def _dominant(scene: Scene, final: float) -> float:
    """The slow root where it is real and all else `APART` times faster, else NaN [1/s]."""
    mounted = scene.assembly().weights[0]
    assert isinstance(mounted.device, Weights)
    rotor, speed = scene.assembly().loaded_rotor, scene.profile().speed(0.0)
    first, second = slow_roots(mounted.device, final, plane_response(rotor, speed))[:2]
    mass, damping, stiffness = (complex(m[0, 0]) for m in rotor.coefficients(speed))
    whirl = max(np.roots([mass, damping, stiffness]).real)
    if abs(first.imag) > 1e-9 * abs(first) or not first.real < 0.0:
        return math.nan
    alone = max(second.real, whirl) < APART * first.real
    return float(first.real) if alone else math.nan


def median_interval(values: list[float]) -> tuple[float, float, float]:
    """Median and its 95 % confidence interval from order statistics, whatever the distribution.

    Infinite values count as later than all others.

    Raises:
        SimulationError: there are too few values for an interval, 6 are needed.
    """
    from scipy.stats import binom

    n = len(values)
    rank = int(binom.ppf(0.025, n, 0.5))
    if rank < 1 or n < 6:
        raise SimulationError(f"{n} starts are too few for a confidence interval: 6 are needed")
    order = sorted(values)
    middle = 0.5 * (order[(n - 1) // 2] + order[n // 2])
    return middle, order[rank - 1], order[n - rank]
