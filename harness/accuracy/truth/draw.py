"""Random scenes of every kind, as a person might write them who does not know what is hard.

Sizes are drawn log-uniformly over what rotors and their balancers span, from a turbocharger to a
drum, and rounded to four digits so that a saved scene reads like one that was typed.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from typing import Any

Document = dict[str, Any]

LONGEST = 400.0  # radians of the fastest mode: longer runs gather error in the reference too


def _sized(generator: random.Random, low: float, high: float) -> float:
    """Log-uniform, four digits."""
    return float(f"{math.exp(generator.uniform(math.log(low), math.log(high))):.4g}")


def _even(generator: random.Random, low: float, high: float) -> float:
    """Uniform, four digits."""
    return float(f"{generator.uniform(low, high):.4g}")


def _sometimes(generator: random.Random, share: float, value: float) -> float:
    return value if generator.random() < share else 0.0


class _Sketch:
    """What the parts of one scene are drawn relative to.

    Attributes:
        mass: of the rotor [kg].
        mode: its typical natural frequency [rad/s].
        speed: of operation [rad/s].
        radius: of its balancers [m].
    """

    def __init__(self, generator: random.Random) -> None:
        self.mass = _sized(generator, 0.1, 100.0)
        self.speed = _sized(generator, 1.0, 1000.0)
        self.mode = self.speed * _sized(generator, 0.03, 30.0)
        self.radius = _sized(generator, 0.02, 0.5)

    def stiffness(self, generator: random.Random) -> float:
        return _sized(generator, 0.3, 3.0) * self.mass * self.mode**2

    def damping(self, generator: random.Random) -> float:
        """Viscous damping for a damping ratio of 0 to 0.5."""
        ratio = _sometimes(generator, 0.85, _sized(generator, 1e-5, 0.5))
        return float(f"{2.0 * ratio * self.mass * self.mode:.4g}")


def planar(generator: random.Random) -> Document:
    """A disc on supports, alone or with light weights, at constant speed."""
    sketch = _Sketch(generator)
    balancers = [_weights(generator, sketch, 1e-5, 0.3)] if generator.random() < 0.85 else []
    return _scene(generator, sketch, _disc(generator, sketch), balancers)


def run_up(generator: random.Random) -> Document:
    """A disc whose speed rises, alone, with weights or with liquid."""
    sketch = _Sketch(generator)
    kind = generator.random()
    balancers = []
    if kind < 0.6:
        balancers = [_weights(generator, sketch, 1e-5, 0.3)]
    elif kind < 0.8:
        balancers = [_liquid(generator, sketch)]
    return _risen(generator, sketch, _scene(generator, sketch, _disc(generator, sketch), balancers))


def two_support(generator: random.Random) -> Document:
    """A rigid rotor on two supports with weights in one or two planes."""
    sketch = _Sketch(generator)
    span = _sized(generator, 0.05, 2.0)
    inertia = sketch.mass * span**2 * _sized(generator, 0.02, 0.5)
    planes = sorted(_even(generator, -0.2, 1.2) * span for _ in range(generator.choice((1, 1, 2))))
    rotor = {
        "kind": "two_support",
        "mass": sketch.mass,
        "inertia": float(f"{inertia:.4g}"),
        "polar_inertia": float(
            f"{_sometimes(generator, 0.7, _even(generator, 0.0, 1.8)) * inertia:.4g}"
        ),
        "span": span,
        "com": float(f"{_even(generator, 0.1, 0.9) * span:.4g}"),
        "stiffness": [_pair(generator, sketch.stiffness) for _ in range(2)],
        "damping": [_pair(generator, sketch.damping) for _ in range(2)],
        "planes": [float(f"{place:.4g}") for place in planes],
        "unbalances": [_unbalance(generator, sketch, generator.uniform(0.0, span))],
    }
    balancers = [
        _weights(generator, sketch, 1e-5, 0.1) | {"name": f"plane{i}", "at": i}
        for i in range(1, len(planes) + 1)
    ]
    document = _scene(generator, sketch, rotor, balancers)
    return _risen(generator, sketch, document) if generator.random() < 0.25 else document


def flexible(generator: random.Random) -> Document:
    """Discs on an elastic shaft with weights on one of them."""
    sketch = _Sketch(generator)
    count = generator.choice((3, 3, 4, 5))
    length = _sized(generator, 0.2, 3.0)
    gaps = [generator.uniform(0.3, 1.0) for _ in range(count - 1)]
    places = [float(f"{length * sum(gaps[:j]) / sum(gaps):.4g}") for j in range(count)]
    # the middle of a shaft of length l is softer than E I by l^3/48
    bending = _sized(generator, 0.1, 10.0) * sketch.mass * sketch.mode**2 * length**3 / 48.0
    rotor = {
        "kind": "flexible",
        "stations": places,
        "masses": [float(f"{sketch.mass * _even(generator, 0.2, 1.0):.4g}") for _ in places],
        "supports": [1, count],
        "support_stiffness": [_pair(generator, sketch.stiffness) for _ in range(2)],
        "support_damping": [_pair(generator, sketch.damping) for _ in range(2)],
        "bending_stiffness": float(f"{bending:.4g}"),
        "internal_damping": _sometimes(generator, 0.3, 0.1 * sketch.damping(generator)),
        "unbalances": [_unbalance(generator, sketch, places[generator.randrange(count)])],
    }
    balancer = _weights(generator, sketch, 1e-5, 0.1)
    return _scene(generator, sketch, rotor, [balancer | {"at": generator.randint(1, count)}])


def liquid(generator: random.Random) -> Document:
    """A disc with liquid through the added-mass port or as a force, half of them with weights."""
    sketch = _Sketch(generator)
    balancers = [_liquid(generator, sketch)]
    if generator.random() < 0.5:
        balancers.append(_weights(generator, sketch, 1e-5, 0.1))
    return _scene(generator, sketch, _disc(generator, sketch), balancers)


def heavy(generator: random.Random) -> Document:
    """Weights of a tenth of the rotor's mass to ten times it, by either port."""
    sketch = _Sketch(generator)
    balancer = _weights(generator, sketch, 0.1, 10.0)
    balancer["inertia_as_force"] = generator.random() < 0.3
    return _scene(generator, sketch, _disc(generator, sketch), [balancer])


def finite(generator: random.Random) -> Document:
    """Balls or rollers that collide and pack, as a rule light, at constant speed."""
    sketch = _Sketch(generator)
    balancer = _weights(generator, sketch, 1e-4, 0.3)
    count = generator.choice((2, 2, 3, 4))
    alpha = _even(generator, 0.1, 0.8) * math.pi / count  # half the angle that each takes up
    slack = math.pi / count - alpha
    turned = _even(generator, 0.0, 6.283)
    balancer |= {
        "kind": generator.choice(("balls", "rollers")),
        "mass": float(f"{balancer['mass'] * balancer['count'] / count:.4g}"),
        "count": count,
        "weight_radius": float(f"{sketch.radius * math.sin(alpha):.4g}"),
        "restitution": _sometimes(generator, 0.6, _even(generator, 0.0, 1.0)),
        "angles": [
            float(f"{turned + math.tau * k / count + generator.uniform(-0.9, 0.9) * slack:.4g}")
            for k in range(count)
        ],
    }
    balancer.pop("speeds", None)
    if generator.random() < 0.5:
        balancer["speeds"] = [_even(generator, -1.0, 1.0) * sketch.speed for _ in range(count)]
    return _scene(generator, sketch, _disc(generator, sketch), [balancer])


def offset(generator: random.Random) -> Document:
    """Weights on a track that is off centre, a quarter of them in a run-up."""
    sketch = _Sketch(generator)
    balancer = _weights(generator, sketch, 1e-5, 0.3)
    size, turn = sketch.radius * _sized(generator, 1e-4, 0.1), generator.uniform(0.0, math.tau)
    balancer["track_offset_xi"] = float(f"{size * math.cos(turn):.4g}")
    balancer["track_offset_eta"] = float(f"{size * math.sin(turn):.4g}")
    document = _scene(generator, sketch, _disc(generator, sketch), [balancer])
    return _risen(generator, sketch, document) if generator.random() < 0.25 else document


def sticking(generator: random.Random) -> Document:
    """Weights with rolling resistance, a fifth of them heavy, a quarter in a run-up."""
    sketch = _Sketch(generator)
    balancer = _weights(
        generator, sketch, *((0.1, 2.0) if generator.random() < 0.2 else (1e-4, 0.1))
    )
    balancer["drag"] = float(f"{balancer['drag'] / 300.0:.4g}")  # nothing stops a weight in drag
    balancer["rolling_resistance"] = _sized(generator, 1e-4, 0.1)
    document = _scene(generator, sketch, _disc(generator, sketch), [balancer])
    return _risen(generator, sketch, document) if generator.random() < 0.25 else document


def friction(generator: random.Random) -> Document:
    """Sliders in the supports, rigid or behind springs, half of the rotors with light weights."""
    sketch = _Sketch(generator)
    rotor = _disc(generator, sketch)
    largest = sketch.mass * max(sketch.speed, sketch.mode) ** 2 * 1e-2 * sketch.radius
    limit = max(rotor["unbalance"] * sketch.speed**2, 1e-3 * largest)
    slider: Document = {"limit": _pair(generator, lambda g: _sized(g, 0.01, 1.0) * limit)}
    if generator.random() < 0.5:
        slider["stiffness"] = sketch.stiffness(generator)
    rotor["friction"] = [slider]
    balancers = [_weights(generator, sketch, 1e-4, 0.1)] if generator.random() < 0.5 else []
    document = _scene(generator, sketch, rotor, balancers)
    return _risen(generator, sketch, document) if generator.random() < 0.25 else document


def gravity(generator: random.Random) -> Document:
    """Any smooth kind of rotor across whose axis gravity pulls, as a rule downwards."""
    document = generator.choice((planar, run_up, two_support, flexible, liquid, offset))(generator)
    document["operation"]["gravity"] = _sized(generator, 0.1, 9.81)
    if generator.random() < 0.3:
        document["operation"]["gravity_angle"] = _even(generator, 0.0, 6.283)
    return document


def motor(generator: random.Random) -> Document:
    """Any rotor with point weights before a motor that passes the resonance or is caught there.

    A third of the motors have a characteristic of three points.
    """
    document = generator.choice((planar, planar, two_support, flexible, offset))(generator)
    rotor, operation = document["rotor"], document["operation"]
    speed = operation["speed"] if "speed" in operation else operation["run_up"]["to"]
    mass = rotor["mass"] if "mass" in rotor else min(rotor["masses"])
    unbalance = rotor["unbalance"] if "unbalance" in rotor else rotor["unbalances"][0]["amount"]
    own = unbalance**2 / mass  # the least that a shaft with this unbalance can have
    inertia = float(f"{10.0 * own + mass * _sized(generator, 1e-4, 0.1):.4g}")
    seconds = 2.0 * math.pi * document["run"]["revolutions"] / speed
    stall = float(f"{inertia * speed / seconds * _sized(generator, 0.3, 10.0):.4g}")
    drive: Document = {"inertia": inertia}
    if generator.random() < 1 / 3:
        between = float(f"{speed * _even(generator, 0.2, 0.9):.4g}")
        drive["table"] = [[0.0, stall], [between, 1.5 * stall], [speed, 0.0]]
    else:
        drive |= {"stall_torque": stall, "no_load_speed": speed}
    drive["from"] = _sometimes(generator, 0.6, speed * _even(generator, 0.0, 0.9))
    return {**document, "operation": {"motor": drive}}


FAMILIES: dict[str, Callable[[random.Random], Document]] = {
    "planar": planar,
    "run_up": run_up,
    "two_support": two_support,
    "flexible": flexible,
    "liquid": liquid,
    "heavy": heavy,
    "finite": finite,
    "offset": offset,
    "sticking": sticking,
    "friction": friction,
    "gravity": gravity,
    "motor": motor,
}


def draw(family: str, seed: int, number: int) -> Document:
    """The scene of this number, as a document; the same whenever and wherever it is drawn.

    Args:
        family: one of `FAMILIES`.
        seed, number: of the study, and of the scene in it.
    """
    document = FAMILIES[family](random.Random(f"{family} {seed} {number}"))
    return {"title": f"{family} {seed} {number}", **document}


def _pair(generator: random.Random, size: Callable[[random.Random], float]) -> list[float]:
    """Along x and y; alike in a third of the cases."""
    first = size(generator)
    return [first, first if generator.random() < 1 / 3 else size(generator)]


def _disc(generator: random.Random, sketch: _Sketch) -> Document:
    return {
        "kind": "planar",
        "mass": sketch.mass,
        "stiffness": _pair(generator, sketch.stiffness),
        "damping": _pair(generator, sketch.damping),
        "unbalance": _unbalance(generator, sketch, 0.0)["amount"],
    }


def _unbalance(generator: random.Random, sketch: _Sketch, position: float) -> Document:
    eccentricity = _sometimes(generator, 0.95, sketch.radius * _sized(generator, 1e-6, 0.1))
    return {
        "position": float(f"{position:.4g}"),
        "amount": float(f"{sketch.mass * eccentricity:.4g}"),
        "angle": _even(generator, 0.0, 6.283),
    }


def _weights(generator: random.Random, sketch: _Sketch, least: float, most: float) -> Document:
    """Weights of together `least` to `most` times the rotor's mass."""
    count = generator.choice((1, 2, 2, 3, 4))
    mass = sketch.mass * _sized(generator, least, most) / count
    drag = mass * sketch.speed * _sized(generator, 1e-3, 1e3)
    balancer: Document = {
        "kind": generator.choice(("balls", "rollers", "pendulums")),
        "name": "weights",
        "count": count,
        "mass": float(f"{mass:.4g}"),
        "track_radius": sketch.radius,
        "drag": _sometimes(generator, 0.9, float(f"{drag:.4g}")),
        "angles": [_even(generator, 0.0, 6.283) for _ in range(count)],
    }
    if generator.random() < 0.2:
        fastest = 3.0 * sketch.speed
        balancer["speeds"] = [_even(generator, -fastest, fastest) for _ in range(count)]
    return balancer


def _liquid(generator: random.Random, sketch: _Sketch) -> Document:
    chamber = sketch.radius
    carried = sketch.mass * _sized(generator, 0.01, 3.0)  # rho pi r1^2 h
    return {
        "kind": "liquid",
        "name": "liquid",
        "chamber_radius": chamber,
        "float_radius": float(f"{chamber * _even(generator, 0.3, 0.95):.4g}"),
        "height": float(f"{carried / (1000.0 * math.pi * chamber**2):.4g}"),
        "density": 1000.0,
        "inertia_as_force": generator.random() < 0.4,
    }


def _scene(
    generator: random.Random, sketch: _Sketch, rotor: Document, balancers: list[Document]
) -> Document:
    """A whole scene at constant speed with default coupling."""
    longest = LONGEST / (2.0 * math.pi) * sketch.speed / max(sketch.speed, sketch.mode)
    run: Document = {"revolutions": _sized(generator, 0.3, max(0.6, min(30.0, longest)))}
    if generator.random() < 0.15:
        length = sketch.radius * _sized(generator, 1e-4, 0.1)
        run["initial"] = {
            "x": _even(generator, -length, length),
            "y": _even(generator, -length, length),
            "vx": _even(generator, -length, length) * sketch.mode,
            "angle": _even(generator, 0.0, 6.283),
        }
    return {
        "rotor": rotor,
        "balancer": balancers,
        "operation": {"speed": sketch.speed},
        "run": run,
    }


def _risen(generator: random.Random, sketch: _Sketch, document: Document) -> Document:
    """The scene with a run-up to its speed that takes some or most of the run."""
    share = _even(generator, 0.2, 1.5)
    start = _sometimes(generator, 0.6, sketch.speed * _even(generator, 0.0, 0.9))
    revolutions = document["run"]["revolutions"]
    seconds = share * 2.0 * math.pi * revolutions / (0.5 * (start + sketch.speed))
    profile = {
        "from": float(f"{start:.4g}"),
        "to": sketch.speed,
        "seconds": float(f"{seconds:.4g}"),
    }
    return {**document, "operation": {"run_up": profile}}
