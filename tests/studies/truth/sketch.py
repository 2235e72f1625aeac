"""Parts of random scenes: sizes as a person might write them, a disc, its weights and liquid.

Sizes are drawn log-uniformly over what rotors and their balancers span, from a turbocharger to a
drum, and rounded to four digits so that a saved scene reads like one that was typed.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from itertools import accumulate, pairwise
from typing import Any

from autobalancer.harness import Scene
from autobalancer.harness.master.schedule import end_time

Document = dict[str, Any]

TURN = 6.283  # rad, as one types it
LONGEST = 400.0  # radians of the fastest mode: longer runs gather error in the reference too


def rounded(value: float) -> float:
    """Four digits, as one types it."""
    return float(f"{value:.4g}")


def sized(generator: random.Random, low: float, high: float) -> float:
    """Log-uniform, four digits."""
    return rounded(math.exp(generator.uniform(math.log(low), math.log(high))))


def even(generator: random.Random, low: float, high: float) -> float:
    """Uniform, four digits."""
    return rounded(generator.uniform(low, high))


def sometimes(generator: random.Random, share: float, value: float) -> float:
    return value if generator.random() < share else 0.0


class Sketch:
    """What the parts of one scene are drawn relative to.

    Attributes:
        mass: of the rotor [kg].
        mode: its typical natural frequency [rad/s].
        speed: of operation [rad/s].
        radius: of its balancers [m].
    """

    def __init__(self, generator: random.Random) -> None:
        self.mass = sized(generator, 0.1, 100.0)
        self.speed = sized(generator, 1.0, 1000.0)
        self.mode = self.speed * sized(generator, 0.03, 30.0)
        self.radius = sized(generator, 0.02, 0.5)

    def stiffness(self, generator: random.Random) -> float:
        return sized(generator, 0.3, 3.0) * self.mass * self.mode**2

    def damping(self, generator: random.Random) -> float:
        """Viscous damping for a damping ratio of 0 to 0.5."""
        ratio = sometimes(generator, 0.85, sized(generator, 1e-5, 0.5))
        return rounded(2.0 * ratio * self.mass * self.mode)


def pair(generator: random.Random, size: Callable[[random.Random], float]) -> list[float]:
    """Along x and y; alike in a third of the cases."""
    first = size(generator)
    return [first, first if generator.random() < 1 / 3 else size(generator)]


def disc(generator: random.Random, sketch: Sketch) -> Document:
    return {
        "kind": "planar",
        "mass": sketch.mass,
        "stiffness": pair(generator, sketch.stiffness),
        "damping": pair(generator, sketch.damping),
        "unbalance": unbalance(generator, sketch, 0.0)["amount"],
    }


def unbalance(generator: random.Random, sketch: Sketch, position: float) -> Document:
    eccentricity = sometimes(generator, 0.95, sketch.radius * sized(generator, 1e-6, 0.1))
    return {
        "position": rounded(position),
        "amount": rounded(sketch.mass * eccentricity),
        "angle": even(generator, 0.0, TURN),
    }


def weights_of(generator: random.Random, sketch: Sketch, least: float, most: float) -> Document:
    """Weights of together `least` to `most` times the rotor's mass."""
    count = generator.choice((1, 2, 2, 3, 4))
    mass = sketch.mass * sized(generator, least, most) / count
    drag = mass * sketch.speed * sized(generator, 1e-3, 1e3)
    balancer: Document = {
        "kind": generator.choice(("balls", "rollers", "pendulums")),
        "name": "weights",
        "count": count,
        "mass": rounded(mass),
        "track_radius": sketch.radius,
        "drag": sometimes(generator, 0.9, rounded(drag)),
        "angles": [even(generator, 0.0, TURN) for _ in range(count)],
    }
    if generator.random() < 0.2:
        fastest = 3.0 * sketch.speed
        balancer["speeds"] = [even(generator, -fastest, fastest) for _ in range(count)]
    return balancer


def liquid_of(generator: random.Random, sketch: Sketch) -> Document:
    chamber = sketch.radius
    carried = sketch.mass * sized(generator, 0.01, 3.0)  # rho pi r1^2 h
    return {
        "kind": "liquid",
        "name": "liquid",
        "chamber_radius": chamber,
        "float_radius": rounded(chamber * even(generator, 0.3, 0.95)),
        "height": rounded(carried / (1000.0 * math.pi * chamber**2)),
        "density": 1000.0,
        "inertia_as_force": generator.random() < 0.4,
    }


def at_constant_speed(
    generator: random.Random, sketch: Sketch, rotor: Document, balancers: list[Document]
) -> Document:
    """A whole scene at constant speed with default coupling."""
    longest = LONGEST / (2.0 * math.pi) * sketch.speed / max(sketch.speed, sketch.mode)
    run: Document = {"revolutions": sized(generator, 0.3, max(0.6, min(30.0, longest)))}
    if generator.random() < 0.15:
        length = sketch.radius * sized(generator, 1e-4, 0.1)
        run["initial"] = {
            "x": even(generator, -length, length),
            "y": even(generator, -length, length),
            "vx": even(generator, -length, length) * sketch.mode,
            "angle": even(generator, 0.0, TURN),
        }
    return {
        "rotor": rotor,
        "balancer": balancers,
        "operation": {"speed": sketch.speed},
        "run": run,
    }


def along_profile(generator: random.Random, sketch: Sketch, document: Document) -> Document:
    """The scene with two to six lines of speed: it rises, dips, stays, runs down and stops."""
    count = generator.randint(2, 6)
    stops = [
        sketch.speed * sometimes(generator, 0.75, generator.random()) for _ in range(count + 1)
    ]
    fastest = generator.randrange(count + 1)
    stops[fastest] = sketch.speed
    if generator.random() < 0.3:
        k = generator.randrange(count)
        stops[k + 1] = stops[k]
    if not any(stops):  # the line that stays was the only one that turns
        stops[fastest] = sketch.speed
    lengths = [sized(generator, 0.2, 1.0) for _ in range(count)]
    turned = sum(
        t * (low + high) / 2.0 for t, (low, high) in zip(lengths, pairwise(stops), strict=True)
    )
    wanted = 2.0 * math.pi * document["run"].pop("revolutions")
    times = [0.0, *accumulate(t * wanted / turned for t in lengths)]
    corners = zip(times, stops, strict=True)
    profile = [[float(f"{time:.5g}"), rounded(speed)] for time, speed in corners]
    return {**document, "operation": {"profile": profile}}


def in_run_up(generator: random.Random, sketch: Sketch, document: Document) -> Document:
    """The scene with a run-up to its speed that takes some or most of the run."""
    share = even(generator, 0.2, 1.5)
    start = sometimes(generator, 0.6, sketch.speed * even(generator, 0.0, 0.9))
    revolutions = document["run"]["revolutions"]
    seconds = share * 2.0 * math.pi * revolutions / (0.5 * (start + sketch.speed))
    profile = {
        "from": rounded(start),
        "to": sketch.speed,
        "seconds": rounded(seconds),
    }
    return {**document, "operation": {"run_up": profile}}


def length_of(document: Document) -> float:
    """Length of the run [s]."""
    return end_time(Scene.from_document(document))
