"""How many weights, and how large: Goncharov's closed forms beside co-simulated settling times."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ..models import capacity as theory
from ..models.settling import plane_response, settling_time, slow_roots
from ..models.weights import Weights
from .design_study import SETTLED, Batch, Settled, median_interval, random_start, run_batch
from .errors import SceneError
from .parallel import spread as shared
from .scene import Scene
from .scene_balancer import WeightBalancer

STEEL = 7800.0  # kg/m^3
BATCH = 5  # starts that share one loading of the units
SEED = 1


@dataclass(frozen=True)
class Choice:
    """One number of weights.

    Attributes:
        count, radius, mass, capacity: n, r [m], m [kg], S [kg m].
        packed, largest: spread p of the packed group, and the largest one (10), (13).
        measure: function (15) or (16) at this radius.
        predicted: time in which the slowest motion falls to `SETTLED` at the largest p [s].
        enough: the capacity reaches the unbalance.
        median, low, high: co-simulated settling time and its 95 % confidence interval [s].
        runs: every start.
    """

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
    def decay_error(self) -> tuple[float, int]:
        """Median of |fitted rate/slow root - 1| where that root is dominant, and how many runs."""
        errors = [
            abs(run.rate / run.root - 1.0)
            for run in self.runs
            if not (math.isnan(run.root) or math.isnan(run.rate))
        ]
        return (float(np.median(errors)), len(errors)) if errors else (math.nan, 0)


@dataclass(frozen=True)
class Design:
    """All numbers of weights for one rotor and space."""

    title: str
    kind: str
    unbalance: float
    race: float
    choices: tuple[Choice, ...]

    @property
    def words(self) -> list[str]:
        """The recommendation, and what has to be said about the numbers."""
        return _words(self)


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
    balls = _weights_of(scene)
    size = balls.weight_radius or 0.0
    race = balls.track_radius + size if race is None else race
    width = 2.0 * size if width is None else width
    amount = abs(complex(scene.assembly().rotor.unbalance[0])) if unbalance is None else unbalance
    median_interval([0.0] * starts)  # too few are refused before the work
    scenes = {n: variant(scene, n, amount, race, width, density) for n in counts}
    batches, owners = [], []
    for n, one in scenes.items():
        rng = random.Random(1000 * SEED + n)
        device = _weights_of(one)
        alpha = math.asin((device.weight_radius or 0.0) / device.track_radius)
        positions = [random_start(n, alpha, rng) for _ in range(starts)]
        scale = amount or _capacity(device)
        for k in range(0, starts, BATCH):
            batches.append(Batch(one, tuple(positions[k : k + BATCH]), scale))
            owners.append(n)
    outcomes = shared(run_batch, batches, workers, progress)
    runs: dict[int, list[Settled]] = {n: [] for n in counts}
    for n, outcome in zip(owners, outcomes, strict=True):
        runs[n] += outcome
    choices = tuple(_choice(scenes[n], amount, runs[n]) for n in counts)
    return Design(scene.title, balls.kind, amount, race, choices)


def _choice(scene: Scene, unbalance: float, runs: list[Settled]) -> Choice:
    balls = _weights_of(scene)
    device = balls.build().device
    assert isinstance(device, Weights)
    radius = balls.weight_radius or 0.0
    alpha = theory.half_angle(radius, balls.track_radius)
    response = plane_response(scene.assembly().loaded_rotor, scene.profile().speed(0.0))
    largest = theory.largest_spread(balls.count, alpha)
    root = complex(slow_roots(device, largest, response)[0])
    still = abs(root) < 1e-9 * device.damping_rate  # p = 1: rounding of a root that is 0
    limit = _capacity(balls)
    return Choice(
        balls.count,
        radius,
        balls.mass,
        limit,
        theory.packed_spread(balls.count, alpha),
        largest,
        theory.settling_shape(balls.kind, radius / (balls.track_radius + radius), balls.count),
        math.inf if still else settling_time(root, SETTLED),
        limit >= unbalance,
        *median_interval([run.seconds for run in runs]),
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
    return one


def _words(data: Design) -> list[str]:
    able = [c for c in data.choices if c.enough]
    if not able:
        best = max(data.choices, key=lambda c: c.capacity)
        return [
            f"No number of {data.kind} in this space balances {data.unbalance:.4g} kg m: "
            f"{best.count} have the most, {best.capacity:.4g} kg m. Take a larger race, a wider "
            "space or a denser material."
        ]
    lines = []
    fastest = min(able, key=lambda c: c.median)
    if math.isinf(fastest.median):
        lines.append("No recommendation: most starts did not settle within the scene's run.")
    else:
        lines.append(
            f"Take {fastest.count} {data.kind} of radius {1e3 * fastest.radius:.3g} mm: they "
            f"balance up to {fastest.capacity:.4g} kg m and settle in {fastest.median:.3g} s "
            f"(median, 95 % confidence {fastest.low:.3g} to {fastest.high:.3g} s)."
        )
        rivals = [c for c in able if c is not fastest and c.low <= fastest.high]
        if rivals:
            names = ", ".join(str(c.count) for c in rivals)
            lines.append(f"The confidence intervals do not tell it apart from {names}.")
        theirs = max(able, key=lambda c: c.measure)
        verb = "agrees" if theirs is fastest else "disagrees"
        lines.append(
            f"Goncharov's measure at the largest p {verb}: it ranks {theirs.count} fastest."
        )
    short = [str(c.count) for c in data.choices if not c.enough]
    if short:
        lines.append(f"Too little capacity for {data.unbalance:.4g} kg m: n = {', '.join(short)}.")
    runs = [run for c in data.choices for run in c.runs]
    left = sum(run.unconverged for run in runs)
    if left:
        lines.append(
            f"{left} of {sum(run.steps for run in runs)} communication steps, at contacts that "
            "open or close, left a residual above 1e-3 of the force."
        )
    for c in data.choices:
        if math.isinf(c.predicted):
            lines.append(
                f"n = {c.count}: at p = 1 the weights stand on one diameter and have a direction "
                "in which nothing drives them (slow root 0)"
                + (": with no unbalance they end there." if not data.unbalance else ".")
            )
    return lines
