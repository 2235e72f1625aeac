"""What a page knows of its scene: tokens of the units, geometry, sliders, window."""

from __future__ import annotations

import cmath
import math
import re
from collections.abc import Iterator
from typing import Any

from ...fmus.composite.composition import Composition
from ...fmus.native.compile import page_library, stamp
from ..errors import SceneError
from ..master.one_file import composition
from ..master.plan import plan
from ..scene import Scene
from ..scene.balancer import WeightBalancer
from .window import window

MOST_WEIGHTS = 8  # of the slider; more where the scene has more
CHANGED_IN = 30.0  # revolutions that a change of speed by the scene's own takes
KICK = 3.0  # of the unbalance: the kick's impulse over it times the speed
BARE = 1e-4  # m: eccentricity that a rotor without unbalance and weights is kicked by

# label, unit, variables, largest factor, whether it is spread by its logarithm
_SLIDERS = (
    ("Torque of the motor", "N m", r"motor\.point\[\d+\]\.torque", 2.0, False),
    ("Unbalance", "kg m", r"rotor\.unbalance(\[\d+\]\.amount)?", 3.0, False),
    ("Drag of the weights", "N s/m", r"(?!rotor\.)\w+\.drag", 10.0, True),
    ("Stiffness of the supports", "N/m", r"rotor\.(support\[\d\]\.)?stiffness_[xy]", 4.0, True),
    ("Damping of the supports", "N s/m", r"rotor\.(support\[\d\]\.)?damping_[xy]", 10.0, True),
)


def content(scene: Scene) -> dict[str, Any]:
    """Everything of a scene that its page needs, as JSON has it; SI units.

    Raises:
        SceneError: the scene is coupled in a way that a composite does not have.
        NotCompiled: the library has to be compiled, and there is no compiler.
    """
    page_library()  # the stamp is that of the sources it is made from
    made, profile, found = composition(scene), scene.profile(), window(scene)
    own = tuple(b.count for b in scene.balancer if isinstance(b, WeightBalancer))
    return {
        "tokens": [
            {"weights": count, "token": each.token(stamp())}
            for count, each in _variants(scene, made, own)
        ],
        "motor": scene.operation.motor is not None,
        "speed": profile.end,
        "rate": profile.acceleration(0.0) or profile.end**2 / (math.tau * CHANGED_IN),
        "window": {
            "low": min(found.low, profile.end),
            "high": max(found.high, profile.end),
            "ends": found.ends,
            "kinds": found.kinds,
            "words": found.words,
        },
        "sliders": list(_sliders(scene, made)),
        "kick": KICK * _moment(scene, made) * profile.end,
        "stations": scene.rotor.stations,
        "supports": scene.rotor.supports,
        "balancers": list(_balancers(scene)),
        "heavy": _heavy(made),
    }


def _variants(
    scene: Scene, own: Composition, counts: tuple[int, ...]
) -> Iterator[tuple[int | None, Composition]]:
    """The scene's composition, then those with 1, 2 ... weights on every track that fit."""
    same = counts[0] if len(set(counts)) == 1 else None
    yield same, own
    if not counts:
        return
    bare = scene.without()
    labels = [b.label for b in scene.balancer if isinstance(b, WeightBalancer)]
    for count in range(1, max(MOST_WEIGHTS, *counts) + 1):
        if count == same:
            continue
        changes = {f"{label}.count": count for label in labels}
        spread = {f"{label}.{key}": None for label in labels for key in ("angles", "speeds")}
        try:
            yield count, composition(bare.replace({**changes, **spread}))
        except SceneError:
            return  # weights of that size do not fit


def _sliders(scene: Scene, made: Composition) -> Iterator[dict[str, Any]]:
    """Sliders for what the scene has: factors of the variables' bases."""
    parameters = [v for v in made.described(scene.name).layout.variables if not v.boolean]
    for label, unit, pattern, most, log in _SLIDERS:
        base = {v.name: float(v.start or 0.0) for v in parameters if re.fullmatch(pattern, v.name)}
        value = 1.0
        if label == "Unbalance" and not any(base.values()):
            base, value = dict.fromkeys(base, _moment(scene, made)), 0.0
        if any(base.values()):
            least = 1.0 / most if log else 0.0
            yield {
                "label": label,
                "unit": unit,
                "base": base,
                "value": value,
                "range": [least, most],
                "log": log,
            }


def _unbalances(made: Composition) -> list[complex]:
    """Of the rotor, those of nothing left out [kg m]."""
    start = made.parts[0].start
    angle_of = {"unbalance": "unbalance_angle"}  # of a planar rotor
    angle_of |= {n: n.replace("amount", "angle") for n in start if n.endswith("].amount")}
    pairs = [(start[a], start[b]) for a, b in angle_of.items() if a in start]
    return [cmath.rect(amount, angle) for amount, angle in pairs if amount]


def _moment(scene: Scene, made: Composition) -> float:
    """Unbalance that the scene is about: the rotor's, else what its weights can balance [kg m]."""
    unbalance = sum(map(abs, _unbalances(made)))
    capacity = sum(
        b.count * b.mass * b.track_radius for b in scene.balancer if isinstance(b, WeightBalancer)
    )
    return unbalance or capacity or scene.rotor.mass * BARE


def _heavy(made: Composition) -> float | None:
    """Direction of the unbalance in the rotor [rad]; None where there are several, or none."""
    found = _unbalances(made)
    return cmath.phase(found[0]) if len(found) == 1 else None


def _balancers(scene: Scene) -> Iterator[dict[str, Any]]:
    """Geometry of every balancer, under the names that its scene gives it."""
    planes = plan(scene).planes
    sizes = [
        *("track_radius", "weight_radius", "track_offset_xi", "track_offset_eta"),
        *("chamber_radius", "float_radius"),
    ]
    for balancer in scene.balancer:
        place = scene.rotor.planes[balancer.at - 1]
        known = {"label": balancer.label, "kind": balancer.kind, "z": place}
        known["plane"] = planes[balancer.label]
        yield known | {key: getattr(balancer, key, None) for key in sizes}
