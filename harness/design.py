"""How many weights, and how large: Goncharov's closed forms beside co-simulated settling times."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ..models import capacity as theory
from ..models.settling import critical_drag, settling_time, slow_root
from ..models.weights import Weights
from .design_study import SETTLED, Batch, Settled, median_interval, random_start, run_batch
from .errors import SceneError
from .parallel import spread as shared
from .scene import Scene
from .scene_balancer import WeightBalancer

STEEL = 7800.0  # kg/m^3
BATCH = 10  # starts that share one loading of the units
SEED = 1

Start = tuple[float, ...]  # angles of the weights [rad]


@dataclass(frozen=True)
class Choice:
    """One number of weights.

    Attributes:
        scene: with these weights.
        count, radius, mass, capacity: n, r [m], m [kg], S [kg m].
        packed, largest: spread p of the packed group, and the largest one (10), (13).
        measure: function (15) or (16) at this radius.
        predicted: time in which the slow root (1) falls to `SETTLED` at the largest p [s].
        enough: the capacity reaches the unbalance; where it does not, nothing is run.
        median, low, high: co-simulated settling time and its 95 % confidence interval [s]; NaN
            where nothing was run.
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
    enough: bool
    median: float
    low: float
    high: float
    runs: tuple[Settled, ...]

    @property
    def settled(self) -> int:
        """How many starts settled."""
        return sum(math.isfinite(run.seconds) for run in self.runs)

    @property
    def reached(self) -> float:
        """Median of p where the runs ended."""
        return float(np.median([run.spread for run in self.runs])) if self.runs else math.nan

    @property
    def predicted_there(self) -> float:
        """Median of the times that the slow root predicts for the positions reached [s]."""
        return float(np.median([run.predicted for run in self.runs])) if self.runs else math.nan


@dataclass(frozen=True)
class Design:
    """All numbers of weights for one rotor and space."""

    title: str
    kind: str
    unbalance: float
    race: float
    choices: tuple[Choice, ...]

    @property
    def able(self) -> list[Choice]:
        """Those with enough capacity."""
        return [c for c in self.choices if c.enough]

    @property
    def words(self) -> list[str]:
        """The recommendation, and what has to be said about the numbers."""
        from .design_words import words

        return words(self)


def variant(
    scene: Scene, count: int, unbalance: float, race: float, width: float, density: float
) -> Scene:
    """The scene with n weights of the radius of largest capacity that its space allows.

    The drag keeps its ratio to the mass.

    Raises:
        SceneError: the scene's rotor or balancer is not one that the theory covers.
    """
    balls = _weights_of(scene)
    ratio = theory.best_ratio(balls.kind, count)
    if balls.kind == "balls":
        ratio = min(ratio, 0.5 * width / race)
    radius = ratio * race
    mass = theory.weight_mass(balls.kind, radius, density, width)
    alpha = theory.half_angle(radius, race - radius)
    changes = {
        "count": count,
        "mass": mass,
        "track_radius": race - radius,
        "weight_radius": radius,
        "drag": balls.drag * mass / balls.mass,
        "angles": list(random_start(count, alpha, random.Random(0))),
        "speeds": [0.0] * count,
    }
    named: dict[str, object] = {f"{balls.label}.{key}": value for key, value in changes.items()}
    return scene.replace({"rotor.unbalance": unbalance, **named})


def design(
    scene: Scene,
    *,
    unbalance: float | None = None,
    race: float | None = None,
    width: float | None = None,
    density: float = STEEL,
    counts: Sequence[int] = range(2, 9),
    starts: int = 200,
    workers: int = 1,
    progress: Callable[[float], None] | None = None,
) -> Design:
    """Compare numbers of weights on the rotor of a scene.

    Args:
        unbalance: the largest to be balanced [kg m], by default the scene's.
        race: radius of the race [m], by default that of the scene's weights.
        width: of the space along the axis [m]: height of rollers, largest diameter of balls; by
            default the diameter of the scene's weights.
        starts: random starts for every number of weights.

    Raises:
        SceneError: the scene is not a planar isotropic rotor at constant speed with one set of
            balls or rollers with weight_radius.
        SimulationError: a run cannot be completed, or the starts are too few.
    """
    median_interval([0.0] * starts)  # too few are refused before the work
    balls = _weights_of(scene)
    amount = unbalance_of(scene) if unbalance is None else unbalance
    race = race_of(balls) if race is None else race
    scenes = sized(scene, counts, amount, race, width, density)
    work = [batch for n in counts for batch in batches(scenes[n], amount, starts)]
    outcomes = shared(run_batch, work, workers, progress)
    runs: dict[int, list[Settled]] = {n: [] for n in counts}
    for batch, outcome in zip(work, outcomes, strict=True):
        runs[_weights_of(batch.scene).count] += outcome
    choices = tuple(_choice(scenes[n], amount, runs[n]) for n in counts)
    return Design(scene.title, balls.kind, amount, race, choices)


def sized(
    scene: Scene,
    counts: Sequence[int],
    unbalance: float,
    race: float | None = None,
    width: float | None = None,
    density: float = STEEL,
) -> dict[int, Scene]:
    """The scene with every number of weights in turn; arguments and errors as `design`."""
    balls = _weights_of(scene)
    race = race_of(balls) if race is None else race
    width = 2.0 * (balls.weight_radius or 0.0) if width is None else width
    return {n: variant(scene, n, unbalance, race, width, density) for n in counts}


def unbalance_of(scene: Scene) -> float:
    """Of a planar rotor [kg m]."""
    return abs(complex(scene.assembly().rotor.unbalance[0]))


def race_of(balls: WeightBalancer) -> float:
    """Radius on which the weights roll [m]."""
    return balls.track_radius + (balls.weight_radius or 0.0)


def batches(
    scene: Scene, unbalance: float, starts: int, start: Callable[..., Start] = random_start
) -> list[Batch]:
    """The random starts of one number of weights; none where the capacity is too small.

    The first ones are the same, however many follow.

    Args:
        start: makes one from count, alpha and a random generator.
    """
    balls = _weights_of(scene)
    if _capacity(balls) < unbalance:
        return []
    rng = random.Random(1000 * SEED + balls.count)
    alpha = theory.half_angle(balls.weight_radius or 0.0, balls.track_radius)
    positions = [start(balls.count, alpha, rng) for _ in range(starts)]
    scale = unbalance or _capacity(balls)
    return [Batch(scene, tuple(positions[k : k + BATCH]), scale) for k in range(0, starts, BATCH)]


def _choice(scene: Scene, unbalance: float, runs: list[Settled]) -> Choice:
    balls = _weights_of(scene)
    device = balls.build().device
    assert isinstance(device, Weights)
    radius = balls.weight_radius or 0.0
    alpha = theory.half_angle(radius, balls.track_radius)
    largest = theory.largest_spread(balls.count, alpha)
    rotor, speed = scene.assembly().loaded_rotor, scene.profile().speed(0.0)
    root = slow_root(device, largest, critical_drag(rotor, speed, device.kappa))
    limit = _capacity(balls)
    times = [run.seconds for run in runs]
    return Choice(
        scene,
        balls.count,
        radius,
        balls.mass,
        limit,
        theory.packed_spread(balls.count, alpha),
        largest,
        theory.settling_shape(balls.kind, radius / (balls.track_radius + radius), balls.count),
        settling_time(root, SETTLED),
        limit >= unbalance,
        *(median_interval(times) if runs else (math.nan,) * 3),
        tuple(runs),
    )


def _capacity(balls: WeightBalancer) -> float:
    return theory.capacity(balls.mass, balls.track_radius, balls.weight_radius or 0.0, balls.count)


def _weights_of(scene: Scene) -> WeightBalancer:
    profile, found = scene.profile(), scene.balancer
    fits = scene.rotor.kind == "planar" and scene.assembly().rotor.isotropic
    one = found[0] if len(found) == 1 else None
    if (
        not fits
        or not isinstance(one, WeightBalancer)
        or one.kind == "pendulums"
        or not one.weight_radius
        or profile.start != profile.end
    ):
        raise SceneError(
            f"{scene.name}: design: needs a planar rotor with equal stiffness and damping in x and "
            "y at constant speed, and one set of balls or rollers with weight_radius"
        )
    try:
        critical_drag(scene.assembly().loaded_rotor, profile.speed(0.0))
    except ValueError as error:
        raise SceneError(f"{scene.name}: design: {error}") from error
    return one
