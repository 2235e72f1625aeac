"""The scenes and random starts of a design: one rotor and space, every number of weights."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence

from ...models.papers import capacity as theory
from ...models.papers.settling import critical_drag_factor
from ..errors import SceneError
from ..scene import Scene
from ..scene.balancer import WeightBalancer
from .settling import Batch, Start, random_start

STEEL = 7800.0  # kg/m^3
BATCH = 10  # starts that share one loading of the units
SEED = 1


def sized(
    scene: Scene,
    counts: Sequence[int],
    unbalance: float,
    race: float | None = None,
    width: float | None = None,
    density: float = STEEL,
) -> dict[int, Scene]:
    """The scene with every number of weights in turn; arguments and errors as `design`.

    The weights have the radius of largest capacity that the space allows; the drag keeps its ratio
    to the mass.
    """
    balls = weights_of(scene)
    race = race_of(balls) if race is None else race
    width = 2.0 * (balls.weight_radius or 0.0) if width is None else width
    return {n: _variant(scene, balls, n, unbalance, race, width, density) for n in counts}


def _variant(
    scene: Scene,
    balls: WeightBalancer,
    count: int,
    unbalance: float,
    race: float,
    width: float,
    density: float,
) -> Scene:
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
    named = {f"{balls.label}.{key}": value for key, value in changes.items()}
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
    one = only_finite_weights(scene)
    if one is None or one.kind == "pendulums":
        raise SceneError(
            f"{scene.name}: design: needs a planar rotor with equal stiffness and damping in x and "
            "y at constant speed, and one set of balls or rollers with weight_radius"
        )
    try:
        drag_limit(scene)
    except ValueError as error:
        raise SceneError(f"{scene.name}: design: {error}") from error
    return one


def only_finite_weights(scene: Scene) -> WeightBalancer | None:
    """The one set of weights of finite size on a planar isotropic rotor at constant speed."""
    profile = scene.profile()
    fits = scene.rotor.kind == "planar" and scene.assembly().rotor.isotropic
    if not fits or profile.rises or len(scene.balancer) != 1:
        return None
    one = scene.balancer[0]
    return one if isinstance(one, WeightBalancer) and one.weight_radius else None


def drag_limit(scene: Scene) -> float:
    """`critical_drag_factor` of the scene's weights on its rotor.

    Raises:
        ValueError: there is none at this speed.
    """
    (weights,), speed = scene.balancer, scene.profile().speed(0.0)
    assert isinstance(weights, WeightBalancer)
    return critical_drag_factor(scene.assembly().loaded_rotor, speed, weights.kappa)
