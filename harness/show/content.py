"""What a page knows of its scene: tokens of the units, geometry, sliders, window."""

from __future__ import annotations

import cmath
import math
import re
from collections.abc import Iterator, Mapping
from itertools import product
from typing import Any

from ...fmus.composite.composition import Composition
from ...fmus.native.build.compile import page_library, stamp
from ...models.assembly import weights_of
from ...models.readable import unbalance_unit
from ..capture.captured import captured_or_none
from ..errors import SceneError
from ..master.one_file import composition
from ..master.plan import plan
from ..scene import Scene
from ..scene.balancer import Ring, WeightBalancer
from ..scene.grade import GRADES
from ..units import shown_in
from .saved import document, keys_of
from .window import window

MOST_WEIGHTS = 8  # that a slider adds to the scene's own number
MOST_VARIANTS = 64  # numbers of weights on the tracks that a page knows: it is kept small
SHOWN_IN = 20.0  # s that a run of the scene's length takes on the page, if it has as many turns
CHANGED_IN = 30.0  # revolutions that a change of speed by the scene's own takes
KICK = 3.0  # of the unbalance: the kick's impulse over it times the speed
LIGHT = 0.1  # kg: masses from here on are shown in kg
BARE = 1e-4  # m: eccentricity that a rotor without unbalance and weights is kicked by

# label, unit, variables, largest factor, whether it is spread by its logarithm
_Slider = tuple[str, str, str, float, bool]
_OF_ROTOR: tuple[_Slider, ...] = (
    ("Torque of the motor", "N m", r"motor\.point\[\d+\]\.torque", 2.0, False),
    ("Unbalance", "kg m", r"rotor\.unbalance(\[\d+\]\.amount)?", 3.0, False),
    ("Stiffness of the supports", "N/m", r"rotor\.(support\[\d\]\.)?stiffness_[xy]", 4.0, True),
    ("Damping of the supports", "N s/m", r"rotor\.(support\[\d\]\.)?damping_[xy]", 10.0, True),
)
_OF_WEIGHTS: tuple[_Slider, ...] = (
    ("Drag of the weights", "N s/m", r"({})\.drag", 10.0, True),
    ("Mass of a weight", "kg", r"({})\.mass", 4.0, True),
)


def content(scene: Scene) -> dict[str, Any]:
    """Everything of a scene that its page needs, as JSON has it; SI units.

    Raises:
        SceneError: the scene is coupled in a way that a composite does not have.
        NotCompiled: the library has to be compiled, and there is no compiler.
    """
    page_library()  # the stamp is that of the sources it is made from
    made, profile = composition(scene), scene.profile()
    bands = window(scene.replace({"operation.unbalance_changes": None}))  # of the first unbalance
    said = captured_or_none(scene)
    return {
        "units": {
            **{symbol: shown_in(symbol) for symbol in ("rad/s", "m")},
            "kg m": unbalance_unit(_moment(scene, made)),
            "kg": _mass_unit(scene),
        },
        "tracks": _tracks(scene),
        "tokens": [
            {"weights": counts, "capacities": capacities, "token": each.token(stamp())}
            for counts, capacities, each in _variants(scene, made)
        ],
        "motor": scene.operation.motor is not None,
        "speed": profile.end,
        "profile": [list(corner) for corner in zip(profile.times, profile.speeds, strict=True)],
        "rate": max(0.0, profile.acceleration(0.0)) or profile.end**2 / (math.tau * CHANGED_IN),
        "window": {
            "low": min(bands.low, profile.end),
            "high": max(bands.high, profile.end),
            "ends": bands.ends,
            "kinds": bands.kinds,
            "words": bands.words,
        },
        "left_behind": "" if said is None else said.sentence().replace("`", ""),
        "scene": document(scene),
        "sliders": list(_sliders(scene, made)),
        "pace": max(1.0, scene.revolutions / SHOWN_IN),
        "mass": scene.rotor.mass,
        "grades": GRADES,
        "kick": KICK * _moment(scene, made) * profile.end,
        "stations": scene.rotor.stations,
        "numbered": len(scene.rotor.points) > 1,  # those of bodies are stations too
        "supports": scene.rotor.supports,
        "balancers": list(_balancers(scene)),
        "points": len(scene.rotor.points),
        "stops": list(_stops(scene)),
        "carrier": _carrier(scene),
        "tub": _tub(scene),
        "heavy": _heavy(made),
        "changes": _changes(scene),
    }


def _mass_unit(scene: Scene) -> tuple[str, float]:
    """Unit in which the weights' masses read well, and how many of it are one kg."""
    masses = [one.mass for m in scene.assembly().weights for one in weights_of(m).each]
    return ("g", 1e3) if min(masses, default=1.0) < LIGHT else ("kg", 1.0)


def _tracks(scene: Scene) -> list[list[str]]:
    """Labels of the tracks that share sliders: all, or each its own where their weights differ."""
    balancers = [b for b in scene.balancer if isinstance(b, WeightBalancer)]
    labels = [b.label for b in balancers]
    alike = len({(b.kind, b.count, b.mass, b.drag, b.track_radius) for b in balancers}) == 1
    return [labels] if alike else [[label] for label in labels]


def _variants(
    scene: Scene, own: Composition
) -> Iterator[tuple[list[int], list[float], Composition]]:
    """Numbers of weights on each of `_tracks`: the scene's, then all others; with them what the
    weights of each of the tracks hold [kg m], and what has them."""
    tracks, bare = _tracks(scene), scene.without()
    there = {b.label: b.count for b in scene.balancer if isinstance(b, WeightBalancer)}
    counts = [there[labels[0]] for labels in tracks]
    yield counts, _capacities(scene, tracks), own
    most = min(MOST_WEIGHTS, int(MOST_VARIANTS ** (1.0 / max(1, len(tracks))) + 1e-9))
    choices = [
        sorted({n, *_fitting(bare, labels, most)}) for n, labels in zip(counts, tracks, strict=True)
    ]
    for numbers in product(*choices):
        if list(numbers) != counts:
            each = {k: n for labels, n in zip(tracks, numbers, strict=True) for k in labels}
            other = _with_numbers(bare, each)
            yield list(numbers), _capacities(other, tracks), composition(other)


def _capacities(scene: Scene, tracks: list[list[str]]) -> list[float]:
    """What the weights on each of the tracks hold together [kg m]."""
    each = {b.label: b.capacity for b in scene.balancer if isinstance(b, WeightBalancer)}
    return [sum(each[label] for label in labels) for labels in tracks]


def _fitting(scene: Scene, labels: list[str], most: int) -> Iterator[int]:
    """Numbers of weights up to `most` that fit on these tracks."""
    for count in range(1, most + 1):
        try:
            _with_numbers(scene, dict.fromkeys(labels, count))
        except SceneError:
            return
        yield count


def _with_numbers(scene: Scene, numbers: Mapping[str, int]) -> Scene:
    """The scene with so many weights on each track, spread as they are by default."""
    spread = {f"{label}.{key}": None for label in numbers for key in ("angles", "speeds")}
    return scene.replace({**{f"{k}.count": n for k, n in numbers.items()}, **spread})


def _sliders(scene: Scene, made: Composition) -> Iterator[dict[str, Any]]:
    """Sliders for what the scene has: factors of the variables' bases."""
    parameters = [v for v in made.described(scene.name).layout.variables if not v.boolean]
    tracks = _tracks(scene)
    plots: list[tuple[_Slider, list[str]]] = [(slider, []) for slider in _OF_ROTOR]
    for labels in tracks:
        named = f": {labels[0]}" if len(tracks) > 1 else ""
        plots += [
            ((f"{label}{named}", unit, pattern.format("|".join(labels)), most, log), labels)
            for label, unit, pattern, most, log in _OF_WEIGHTS
        ]
    for (label, unit, pattern, most, log), labels in plots:
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
                "keys": list(keys_of(scene, label, labels, _moment(scene, made))),
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
    capacity = sum(b.capacity for b in scene.balancer if isinstance(b, WeightBalancer))
    return unbalance or capacity or scene.rotor.mass * BARE


def _changes(scene: Scene) -> list[list[float]]:
    """Of a rotor with one unbalance its changes: time [s], xi and eta [kg m]."""
    turned = [(c.time, cmath.rect(c.amount, c.angle)) for c in scene.operation.unbalance_changes]
    alone = len(scene.rotor.unbalance_names) == 1
    return [[time, u.real, u.imag] for time, u in turned] if alone else []


def _heavy(made: Composition) -> float | None:
    """Direction of the unbalance in the rotor [rad]; None where there are several, or none."""
    unbalances = _unbalances(made)
    return cmath.phase(unbalances[0]) if len(unbalances) == 1 else None


def _carrier(scene: Scene) -> dict[str, Any] | None:
    """The body that carries a rotor of several stations: its two points among those of the rotor,
    from 0, and places along the shaft of these, of its feet and of its middle [m]."""
    rotor, body, names = scene.rotor, scene.rotor.carrier, _points(scene)
    if body is None or len(rotor.supports) < 2:
        return None
    return {
        "name": body.name,
        "points": [names.index(f"{body.name} at support {s}") for s in (1, 2)],
        "z": rotor.support_positions,
        "feet": [foot.position for foot in body.feet],
        "middle": body.center,
    }


def _tub(scene: Scene) -> dict[str, Any] | None:
    """The body that carries a planar rotor: its name, its point among those of the rotor, from 0,
    and whether it stands on feet."""
    body = scene.rotor.carrier
    if body is None or len(scene.rotor.supports) != 1:
        return None
    point = _points(scene).index(body.name)
    return {"name": body.name, "point": point, "feet": bool(body.feet)}


def _points(scene: Scene) -> list[str]:
    """Names of the points of the rotor; its stations have none."""
    return [*("" for _ in scene.rotor.stations), *scene.rotor.beyond]


def _stops(scene: Scene) -> Iterator[dict[str, Any]]:
    """Every stop: what it is called, its gap [m], place along the shaft [m], and rows by which the
    points of the rotor move across it."""
    places: dict[int | str, float] = dict(enumerate(scene.rotor.support_positions, start=1))
    for body in scene.rotor.bodies:
        feet = enumerate(body.feet, start=1)
        places |= {f"{body.name}.foot[{k}]": foot.position for k, foot in feet}
    built = scene.restrained_assembly().rotor.stops
    for stop, element in zip(scene.rotor.stops, built, strict=True):
        yield {
            "label": stop.called,
            "kind": stop.kind,
            "gap": stop.gap,
            "z": places.get(stop.support, scene.rotor.stations[0]),
            "rows": element.rows.tolist(),
        }


def _balancers(scene: Scene) -> Iterator[dict[str, Any]]:
    """Geometry of every balancer, under the names that its scene gives it."""
    planes = plan(scene).planes
    sizes = [
        *("track_radius", "weight_radius", "track_offset_xi", "track_offset_eta"),
        *("chamber_radius", "float_radius", "wall_radius"),
    ]
    for balancer in scene.balancer:
        place = scene.rotor.planes[balancer.at - 1]
        known = {"label": balancer.label, "kind": balancer.kind, "z": place}
        known["plane"] = planes[balancer.label]
        known |= {key: getattr(balancer, key, None) for key in sizes}
        if isinstance(balancer, Ring):
            known |= {"inner_radius": balancer.device.inner_radius}
        if isinstance(balancer, WeightBalancer):
            known |= {"race": [one.model_dump() for one in balancer.race]}
        weights = balancer.device.each if isinstance(balancer, WeightBalancer) else ()
        yield known | {"radii": [one.radius for one in weights]}
