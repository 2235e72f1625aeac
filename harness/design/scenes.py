"""The scenes and random starts of a design: one rotor and space, every number of weights."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence

from ...models.papers import capacity as theory
from ...models.papers.settling import critical_drag_factor
from ..errors import SceneError
from ..scene import Scene
from ..scene.balancer import WeightBalancer
from .settling import Batch, random_start

STEEL = 7800.0  # kg/m^3
BATCH = 10  # starts that share one loading of the units
SEED = 1

Start = tuple[float, ...]  # angles of the weights [rad]


def sized(
    scene: Scene,
    counts: Sequence[int],
    unbalance: float,
    race: float | None = None,
    width: float | None = None,
    density: float = STEEL,
) -> dict[int, Scene]:
    """The scene with every number of weights in turn; arguments and errors as `design`."""
    balls = weights_of(scene)
    race = race_of(balls) if race is None else race
    width = 2.0 * (balls.weight_radius or 0.0) if width is None else width
    return {n: variant(scene, n, unbalance, race, width, density) for n in counts}


def variant(
    scene: Scene, count: int, unbalance: float, race: float, width: float, density: float
) -> Scene:
    """The scene with n weights of the radius of largest capacity that its space allows.

    The drag keeps its ratio to the mass.

    Raises:
        SceneError: the scene's rotor or balancer is not one that the theory covers.
    """
    balls = weights_of(scene)
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
    balls = weights_of(scene)
    if capacity_of(balls) < unbalance:
        return []
    rng = random.Random(1000 * SEED + balls.count)
    positions = [start(balls.count, balls.half_angle, rng) for _ in range(starts)]
    scale = unbalance or capacity_of(balls)
    return [Batch(scene, tuple(positions[k : k + BATCH]), scale) for k in range(0, starts, BATCH)]


def capacity_of(balls: WeightBalancer) -> float:
    """S [kg m]."""
    return theory.capacity(balls.mass, balls.track_radius, balls.weight_radius or 0.0, balls.count)


def weights_of(scene: Scene) -> WeightBalancer:
    """The scene's weights, if it is one for a design.

    Raises:
        SceneError: it is not.
    """
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
        critical_drag_factor(scene.assembly().loaded_rotor, profile.speed(0.0))
    except ValueError as error:
        raise SceneError(f"{scene.name}: design: {error}") from error
    return one
