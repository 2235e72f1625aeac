"""The scenes and random starts of a design: one rotor and space, every number of weights."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence

from ...models.papers import capacity as theory
from ...models.papers.settling import critical_drag_factor
from ...models.weights import KAPPA
from ..errors import SceneError
from ..scene import Scene
from ..scene.balancer import WeightBalancer
from .settling import Batch, Start, random_start, weights_in
from .space import MATERIALS

ASSUMED_RATE = 0.2  # of the speed: rate at which a ball of unknown drag loses its speed
BATCH = 10  # starts that share one loading of the units
SEED = 1


def sized(
    scene: Scene,
    counts: Sequence[int],
    unbalance: float,
    race: float | None = None,
    width: float | None = None,
    density: float = MATERIALS["steel"],
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
    scene: Scene,
    unbalance: float,
    starts: int,
    start: Callable[..., Start] = random_start,
    reserve: float = 1.0,
) -> list[Batch]:
    """The random starts of one number of weights; none where the capacity is too small.

    The first ones are the same, however many follow.

    Args:
        start: makes one from count, alpha and a random generator.
    """
    balls = weights_of(scene)
    if balls.capacity < reserve * unbalance:
        return []
    rng = random.Random(1000 * SEED + balls.count)
    positions = [start(balls.count, balls.half_angle, rng) for _ in range(starts)]
    scale = unbalance or balls.capacity
    return [Batch(scene, tuple(positions[k : k + BATCH]), scale) for k in range(0, starts, BATCH)]


def with_balls(scene: Scene, race: float | None, width: float | None) -> Scene:
    """The scene; where it has no weights, with two steel balls of `width` and assumed drag.

    Raises:
        SceneError: the rotor is not planar, or the size of its weights is not known.
    """
    one = scene.balancer[0] if scene.balancer else None
    sized_already = isinstance(one, WeightBalancer) and one.weight_radius
    if one is not None and not isinstance(one, WeightBalancer):
        raise SceneError(
            f"{scene.label}: design: finds the number and size of balls, and balancer[1] is of "
            f'kind "{one.kind}", without weights: leave it out, and give --race and --width'
        )
    if not sized_already and (race is None or width is None):
        refuse_other_rotors(scene)  # which a size would not help
        raise SceneError(
            f"{scene.label}: design: its weights have no size: give --race and --width, the radius "
            "of the race and the space along the axis"
        )
    if one is not None or race is None or width is None:
        return scene
    radius = min(0.5 * width, theory.best_ratio("balls", 2) * race)
    mass = theory.weight_mass("balls", radius, MATERIALS["steel"])
    drag = ASSUMED_RATE * scene.profile().end * KAPPA["balls"] * mass
    balls = {"kind": "balls", "name": "balls", "count": 2, "mass": mass, "drag": drag}
    document = {**scene.document, "balancer": [{**balls, "track_radius": race - radius}]}
    return type(scene).from_document(document, path=scene.path, label=scene.label)


def refuse_other_rotors(scene: Scene) -> None:
    """Raise SceneError where the rotor is of a kind that has no design."""
    kind = scene.rotor.kind
    if kind != "planar":
        raise SceneError(f'{scene.label}: design: rotor.kind = "{kind}": must be "planar"')


def weights_of(scene: Scene) -> WeightBalancer:
    """The scene's weights, if it is one for a design.

    Raises:
        SceneError: it is not; every reason is named.
    """
    rotor = scene.rotor
    reasons = {
        f'rotor.kind = "{rotor.kind}": must be "planar"': rotor.kind != "planar",
        "[operation]: must have a constant speed": scene.profile().changes,
        "operation.unbalance_changes: must be left out": bool(scene.operation.unbalance_changes),
        "[[balancer]]: must be one set of balls or rollers, or none": len(scene.balancer) != 1
        or getattr(scene.balancer[0], "kind", "") not in ("balls", "rollers"),
        "mass, drag, weight_radius: must be single values, of equal weights": any(
            getattr(one, "unequal", False) for one in scene.balancer
        ),
    }
    if any(reasons.values()):
        wrong = "; ".join(reason for reason, is_so in reasons.items() if is_so)
        raise SceneError(f"{scene.label}: design: {wrong}")
    if is_isotropic(scene):
        refuse_without_slow_root(scene)
    return weights_in(scene)


def refuse_without_slow_root(scene: Scene) -> None:
    """Raise SceneError where Goncharov's slow root (1) does not hold."""
    try:
        drag_limit(scene)
    except ValueError as error:
        raise SceneError(f"{scene.label}: design: {error}") from error


def is_isotropic(scene: Scene) -> bool:
    """Whether Goncharov's closed forms hold for the rotor."""
    return bool(scene.assembly().rotor.isotropic)


def drag_limit(scene: Scene) -> float:
    """`critical_drag_factor` of the scene's weights on its rotor.

    Raises:
        ValueError: there is none at this speed.
    """
    speed, kappa = scene.profile().speed(0.0), weights_in(scene).kappa
    return critical_drag_factor(scene.assembly().loaded_rotor, speed, kappa)
