"""Random scenes of every kind, as a person might write them who does not know what is hard."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Sequence

import numpy as np

from tests.studies.truth.sketch import (
    TURN,
    Document,
    Sketch,
    along_profile,
    at_constant_speed,
    disc,
    even,
    in_run_up,
    length_of,
    liquid_of,
    pair,
    rounded,
    sized,
    sometimes,
    unbalance,
    weights_of,
)


def planar(generator: random.Random) -> Document:
    """A disc on supports, alone or with light weights, at constant speed."""
    sketch = Sketch(generator)
    balancers = [weights_of(generator, sketch, 1e-5, 0.3)] if generator.random() < 0.85 else []
    return at_constant_speed(generator, sketch, disc(generator, sketch), balancers)


def run_up(generator: random.Random) -> Document:
    """A disc whose speed rises, alone, with weights or with liquid."""
    sketch = Sketch(generator)
    kind = generator.random()
    balancers = []
    if kind < 0.6:
        balancers = [weights_of(generator, sketch, 1e-5, 0.3)]
    elif kind < 0.8:
        balancers = [liquid_of(generator, sketch)]
    return in_run_up(
        generator, sketch, at_constant_speed(generator, sketch, disc(generator, sketch), balancers)
    )


def _on_two_supports(generator: random.Random) -> tuple[Sketch, Document]:
    """A rigid rotor on two supports with one or two planes."""
    sketch = Sketch(generator)
    span = sized(generator, 0.05, 2.0)
    inertia = sketch.mass * span**2 * sized(generator, 0.02, 0.5)
    planes = sorted(even(generator, -0.2, 1.2) * span for _ in range(generator.choice((1, 1, 2))))
    rotor = {
        "kind": "two_support",
        "mass": sketch.mass,
        "inertia": rounded(inertia),
        "polar_inertia": rounded(sometimes(generator, 0.7, even(generator, 0.0, 1.8)) * inertia),
        "span": span,
        "com": rounded(even(generator, 0.1, 0.9) * span),
        "stiffness": [pair(generator, sketch.stiffness) for _ in range(2)],
        "damping": [pair(generator, sketch.damping) for _ in range(2)],
        "planes": [rounded(place) for place in planes],
        "unbalances": [unbalance(generator, sketch, generator.uniform(0.0, span))],
    }
    return sketch, rotor


def two_support(generator: random.Random) -> Document:
    """The same with weights in its planes."""
    sketch, rotor = _on_two_supports(generator)
    balancers = [
        weights_of(generator, sketch, 1e-5, 0.1) | {"name": f"plane{i}", "at": i}
        for i in range(1, len(rotor["planes"]) + 1)
    ]
    document = at_constant_speed(generator, sketch, rotor, balancers)
    return in_run_up(generator, sketch, document) if generator.random() < 0.25 else document


def flexible(generator: random.Random) -> Document:
    """Discs on an elastic shaft with weights on one of them."""
    sketch = Sketch(generator)
    count = generator.choice((3, 3, 4, 5))
    length = sized(generator, 0.2, 3.0)
    gaps = [generator.uniform(0.3, 1.0) for _ in range(count - 1)]
    places = [rounded(length * sum(gaps[:j]) / sum(gaps)) for j in range(count)]
    # the middle of a shaft of length l is softer than E I by l^3/48
    bending = sized(generator, 0.1, 10.0) * sketch.mass * sketch.mode**2 * length**3 / 48.0
    rotor = {
        "kind": "flexible",
        "stations": places,
        "masses": [rounded(sketch.mass * even(generator, 0.2, 1.0)) for _ in places],
        "supports": [1, count],
        "support_stiffness": [pair(generator, sketch.stiffness) for _ in range(2)],
        "support_damping": [pair(generator, sketch.damping) for _ in range(2)],
        "bending_stiffness": rounded(bending),
        "internal_damping": sometimes(generator, 0.3, 0.1 * sketch.damping(generator)),
        "unbalances": [unbalance(generator, sketch, places[generator.randrange(count)])],
    }
    balancer = weights_of(generator, sketch, 1e-5, 0.1)
    return at_constant_speed(
        generator, sketch, rotor, [balancer | {"at": generator.randint(1, count)}]
    )


def tilting(generator: random.Random) -> Document:
    """A flexible shaft, overhung in half of the cases, some of whose discs tilt."""
    document = flexible(generator)
    rotor = document["rotor"]
    count, longest = len(rotor["stations"]), rotor["stations"][-1]
    if generator.random() < 0.5:
        rotor["supports"] = [1, count - 1]
    across, along = [], []
    for mass in rotor["masses"]:
        size = mass * (longest * sized(generator, 0.01, 0.3)) ** 2
        across.append(rounded(sometimes(generator, 0.6, size)))
        along.append(rounded(across[-1] * even(generator, 0.0, 2.0) * (1.0 - 1e-3)))
    across[-1] = across[-1] or rounded(rotor["masses"][-1] * (0.1 * longest) ** 2)
    rotor |= {"transverse_inertias": across, "polar_inertias": along}
    if generator.random() < 0.3:
        rotor["shear_stiffness"] = rounded(
            rotor["bending_stiffness"] / longest**2 * sized(generator, 3.0, 300.0)
        )
    if generator.random() < 0.3:
        rotor["skews"] = [
            {"station": count, "tilt": sized(generator, 1e-6, 1e-2), "angle": even(generator, 0, 6)}
        ]
    if generator.random() < 0.25:
        sketch = Sketch(generator)
        sketch.speed = document["operation"]["speed"]
        return in_run_up(generator, sketch, document)
    return document


def bearings(generator: random.Random) -> Document:
    """Any rotor on bearings with cross terms, below or above the threshold of whirl."""
    document = generator.choice((planar, two_support, flexible, tilting))(generator)
    rotor = document["rotor"]
    flexible_one = rotor["kind"] == "flexible"
    prefix = "support_" if flexible_one else ""
    pairs = [rotor.pop(f"{prefix}{key}") for key in ("stiffness", "damping")]
    if rotor["kind"] == "planar":
        pairs = [[pair] for pair in pairs]
    rotor["bearings"] = []
    for number, (k, c) in enumerate(zip(*pairs, strict=True), start=1):
        mass = rotor["mass"] if "mass" in rotor else sum(rotor["masses"])
        cross = (max(c) * math.sqrt(max(k) / mass) + 1e-4 * max(k)) * even(generator, -1.5, 1.5)
        skew = even(generator, 0.5, 1.5)
        sheared = even(generator, -0.5, 0.5) * min(c)
        rotor["bearings"].append(
            {
                "support": number,
                "stiffness": [[k[0], rounded(cross)], [rounded(-cross * skew), k[1]]],
                "damping": [[c[0], rounded(sheared)], [rounded(sheared), c[1]]],
            }
        )
    return document


def bodies(generator: random.Random) -> Document:
    """Any rotor on a tub or base with feet, on one that is free, or with an absorber."""
    document = generator.choice((planar, two_support, flexible, tilting))(generator)
    rotor = document["rotor"]
    mass = rotor["mass"] if "mass" in rotor else sum(rotor["masses"])
    key = "support_stiffness" if rotor["kind"] == "flexible" else "stiffness"
    pairs = np.reshape(rotor[key], (-1, 2))
    damping = np.reshape(rotor[key.replace("stiffness", "damping")], (-1, 2))
    places = {"planar": [0.0], "two_support": [0.0, rotor.get("span")]}.get(rotor["kind"])
    places = places or [rotor["stations"][k - 1] for k in rotor["supports"]]
    length = places[-1] - places[0]
    own = mass * sized(generator, 0.05, 20.0)
    share = sized(generator, 0.05, 20.0)
    feet = [
        {
            "position": place,
            "stiffness": [rounded(share * value) for value in k],
            "damping": [rounded(share * value) for value in c],
        }
        for place, k, c in zip(places, pairs.tolist(), damping.tolist(), strict=True)
    ]
    body = {"name": "base", "mass": rounded(own), "feet": feet}
    if length:
        body["center"] = rounded(places[0] + length * even(generator, 0.1, 0.9))
        body["transverse_inertia"] = rounded(own * (length * sized(generator, 0.1, 1.0)) ** 2)
    choice = generator.random()
    if choice < 0.15 and rotor["kind"] != "flexible":
        body["on"] = "rotor"
        body["feet"] = feet[:1] if not length else []
        if length:
            body |= {"on": "ground", "feet": feet}
    elif choice < 0.3:
        body["feet"] = []
    rotor["bodies"] = [body]
    rotor["on"] = "ground" if body.get("on") == "rotor" else "base"
    if rotor["kind"] == "planar" and generator.random() < 0.3:
        rotor["internal_damping"] = rounded(0.1 * float(damping.max()))
    return document


def rubber(generator: random.Random) -> Document:
    """Rubber in the supports of any rotor, under a base, or both."""
    base = generator.random() < 0.6
    document = bodies(generator) if base else generator.choice((planar, two_support))(generator)
    rotor = document["rotor"]
    speed = document["operation"].get("speed") or 1.0

    def element(prefix: str) -> Document:
        factor = [sized(generator, 0.02, 1.5) for _ in range(2)]
        frequency = rounded(speed * sized(generator, 0.2, 5.0))
        return {f"{prefix}loss_factor": factor, "loss_frequency": frequency}

    feet = [foot for body in rotor.get("bodies", []) for foot in body["feet"]]
    for foot in feet:
        foot |= element("")
    if not feet or generator.random() < 0.4:
        rotor |= element("support_")
    return document


def tables(generator: random.Random) -> Document:
    """Bearings whose terms change with the speed, at constant speed or through the rows."""
    document = bearings(generator)
    operation = document["operation"]
    profile = operation.get("profile")
    ends = [speed for _, speed in profile] if profile else []
    run_up = operation.get("run_up")
    if run_up:
        ends = [run_up.get("from", 0.0), run_up["to"]]
    ends = ends or [operation["speed"]]
    low, high = 0.7 * min(ends), 1.3 * max(ends)
    speeds = [rounded(low + (high - low) * k / 4) for k in range(5)]
    for bearing in document["rotor"]["bearings"]:
        terms = [*np.ravel(bearing.pop("stiffness")), *np.ravel(bearing.pop("damping"))]
        bearing["table"] = [
            [speed, *(rounded(float(term) * even(generator, 0.6, 1.5)) for term in terms)]
            for speed in speeds
        ]
    return document


def one_way(generator: random.Random) -> Document:
    """A rotor on a base that moves along one axis alone."""
    while True:
        document = bodies(generator)
        rotor = document["rotor"]
        if rotor["bodies"][0]["feet"] and not rotor.get("internal_damping"):
            rotor["bodies"][0]["free"] = generator.choice("xy")
            return document


def liquid(generator: random.Random) -> Document:
    """A disc with liquid through the added-mass port or as a force, half of them with weights."""
    sketch = Sketch(generator)
    balancers = [liquid_of(generator, sketch)]
    if generator.random() < 0.5:
        balancers.append(weights_of(generator, sketch, 1e-5, 0.1))
    return at_constant_speed(generator, sketch, disc(generator, sketch), balancers)


def heavy(generator: random.Random) -> Document:
    """Weights of a tenth of the rotor's mass to ten times it, by either port."""
    sketch = Sketch(generator)
    balancer = weights_of(generator, sketch, 0.1, 10.0)
    balancer["inertia_as_force"] = generator.random() < 0.3
    return at_constant_speed(generator, sketch, disc(generator, sketch), [balancer])


def finite(generator: random.Random) -> Document:
    """Balls or rollers that collide and pack, as a rule light, at constant speed."""
    sketch = Sketch(generator)
    balancer = weights_of(generator, sketch, 1e-4, 0.3)
    restitution = sometimes(generator, 0.6, even(generator, 0.0, 1.0))
    balancer = _sized(generator, sketch, balancer, (2, 2, 3, 4), restitution)
    return at_constant_speed(generator, sketch, disc(generator, sketch), [balancer])


def impacts(generator: random.Random) -> Document:
    """Weights without restitution that the rotor feels: 0.02 to 0.4 of its mass on each plane."""
    if generator.random() < 0.7:
        sketch = Sketch(generator)
        rotor = disc(generator, sketch)
        planes = 1
    else:
        sketch, rotor = _on_two_supports(generator)
        planes = len(rotor["planes"])
    balancers = []
    for plane in range(1, planes + 1):
        balancer = weights_of(generator, sketch, 0.02, 0.4)
        sized_ones = _sized(generator, sketch, balancer, (2, 3, 4, 5, 6), 0.0)
        balancers.append(sized_ones | {"name": f"plane{plane}", "at": plane})
    return at_constant_speed(generator, sketch, rotor, balancers)


def harsh(generator: random.Random) -> Document:
    """Impacts that are felt, over 8 to 40 revolutions, with light drag and fast starts."""
    document = impacts(generator)
    for balancer in document["balancer"]:
        balancer["restitution"] = sometimes(generator, 0.7, even(generator, 0.0, 1.0))
        speed, count = document["operation"]["speed"], balancer["count"]
        balancer["drag"] = rounded(balancer["mass"] * speed * sized(generator, 1e-3, 0.1))
        if generator.random() < 0.7:
            balancer["speeds"] = [even(generator, -1.0, 1.0) * speed for _ in range(count)]
    document["run"]["revolutions"] = even(generator, 8.0, 40.0)
    return document


def _sized(
    generator: random.Random,
    sketch: Sketch,
    balancer: Document,
    counts: Sequence[int],
    restitution: float,
) -> Document:
    """The same weights as balls or rollers of a size that fits, some of them moving."""
    count = generator.choice(counts)
    alpha = even(generator, 0.1, 0.8) * math.pi / count  # half the angle that each takes up
    slack = math.pi / count - alpha
    turned = even(generator, 0.0, TURN)
    made = balancer | {
        "kind": generator.choice(("balls", "rollers")),
        "mass": rounded(balancer["mass"] * balancer["count"] / count),
        "count": count,
        "weight_radius": rounded(sketch.radius * math.sin(alpha)),
        "restitution": restitution,
        "angles": [
            rounded(turned + math.tau * k / count + generator.uniform(-0.9, 0.9) * slack)
            for k in range(count)
        ],
    }
    made.pop("speeds", None)
    if generator.random() < 0.5:
        made["speeds"] = [even(generator, -1.0, 1.0) * sketch.speed for _ in range(count)]
    return made


def offset(generator: random.Random) -> Document:
    """Weights on a track that is off centre, a quarter of them in a run-up."""
    sketch = Sketch(generator)
    balancer = weights_of(generator, sketch, 1e-5, 0.3)
    size, turn = sketch.radius * sized(generator, 1e-4, 0.1), generator.uniform(0.0, math.tau)
    balancer["track_offset_xi"] = rounded(size * math.cos(turn))
    balancer["track_offset_eta"] = rounded(size * math.sin(turn))
    document = at_constant_speed(generator, sketch, disc(generator, sketch), [balancer])
    return in_run_up(generator, sketch, document) if generator.random() < 0.25 else document


def sticking(generator: random.Random) -> Document:
    """Weights with rolling resistance, a fifth of them heavy, a quarter in a run-up."""
    sketch = Sketch(generator)
    balancer = weights_of(
        generator, sketch, *((0.1, 2.0) if generator.random() < 0.2 else (1e-4, 0.1))
    )
    balancer["drag"] = rounded(balancer["drag"] / 300.0)  # nothing stops a weight in drag
    balancer["rolling_resistance"] = sized(generator, 1e-4, 0.1)
    document = at_constant_speed(generator, sketch, disc(generator, sketch), [balancer])
    return in_run_up(generator, sketch, document) if generator.random() < 0.25 else document


def friction(generator: random.Random) -> Document:
    """Sliders in the supports, rigid or behind springs, half of the rotors with light weights."""
    sketch = Sketch(generator)
    rotor = disc(generator, sketch)
    largest = sketch.mass * max(sketch.speed, sketch.mode) ** 2 * 1e-2 * sketch.radius
    limit = max(rotor["unbalance"] * sketch.speed**2, 1e-3 * largest)
    slider: Document = {"limit": pair(generator, lambda g: sized(g, 0.01, 1.0) * limit)}
    if generator.random() < 0.5:
        slider["stiffness"] = sketch.stiffness(generator)
    rotor["friction"] = [slider]
    balancers = [weights_of(generator, sketch, 1e-4, 0.1)] if generator.random() < 0.5 else []
    document = at_constant_speed(generator, sketch, rotor, balancers)
    return in_run_up(generator, sketch, document) if generator.random() < 0.25 else document


def gravity(generator: random.Random) -> Document:
    """Any smooth kind of rotor across whose axis gravity pulls, as a rule downwards."""
    document = generator.choice((planar, run_up, two_support, flexible, liquid, offset))(generator)
    document["operation"]["gravity"] = sized(generator, 0.1, 9.81)
    if generator.random() < 0.3:
        document["operation"]["gravity_angle"] = even(generator, 0.0, TURN)
    return document


def motor(generator: random.Random) -> Document:
    """Any rotor with point weights before a motor that passes the resonance or is caught there.

    The characteristic of half of the motors has one to seven corners.
    """
    kinds = planar, planar, two_support, flexible, offset
    return _before_motor(generator, generator.choice(kinds)(generator))


def motor_contacts(generator: random.Random) -> Document:
    """Balls or rollers that collide and pack before such a motor."""
    return _before_motor(generator, generator.choice((finite, impacts))(generator))


def _before_motor(generator: random.Random, document: Document) -> Document:
    """The same machine with a motor, which turns it about as far."""
    rotor, operation = document["rotor"], document["operation"]
    speed = operation["speed"] if "speed" in operation else operation["run_up"]["to"]
    mass = rotor["mass"] if "mass" in rotor else min(rotor["masses"])
    moment = rotor["unbalance"] if "unbalance" in rotor else rotor["unbalances"][0]["amount"]
    own = moment**2 / mass  # the least that a shaft with this unbalance can have
    inertia = rounded(10.0 * own + mass * sized(generator, 1e-4, 0.1))
    seconds = 2.0 * math.pi * document["run"]["revolutions"] / speed
    stall = rounded(inertia * speed / seconds * sized(generator, 0.3, 10.0))
    drive: Document = {"inertia": inertia}
    if generator.random() < 0.5:
        corners = sorted({even(generator, 0.02, 0.95) for _ in range(generator.choice((1, 2, 7)))})
        inner = [[speed * at, stall * sized(generator, 0.3, 3.0)] for at in corners]
        drive["table"] = [[0.0, stall], *inner, [speed, 0.0]]
    else:
        drive |= {"stall_torque": stall, "no_load_speed": speed}
    drive["from"] = sometimes(generator, 0.6, speed * even(generator, 0.0, 0.9))
    return {**document, "operation": {"motor": drive}}


def unequal(generator: random.Random) -> Document:
    """Any kind of scene with weights that have their own masses, drags, and sizes where they meet.

    The draw is repeated until there are two weights.
    """
    makers = (planar, run_up, two_support, heavy, finite, impacts, offset, sticking, motor)
    document: Document = {}
    while not any(one.get("count", 1) > 1 for one in document.get("balancer", ())):
        document = generator.choice(makers)(generator)
    for balancer in document["balancer"]:
        for key in ("mass", "drag", "weight_radius"):
            if key in balancer:  # smaller ones than those that fit, fit
                balancer[key] = [
                    rounded(balancer[key] * generator.uniform(0.4, 1.0))
                    for _ in range(balancer["count"])
                ]
    return document


def profile(generator: random.Random) -> Document:
    """Any kind of rotor along a speed profile, a third of them with gravity across the axis."""
    kinds = (planar, two_support, flexible, liquid, finite, impacts, offset, sticking, friction)
    document = generator.choice(kinds)(generator)
    sketch = Sketch(generator)
    operation = document["operation"]
    sketch.speed = operation["speed"] if "speed" in operation else operation["run_up"]["to"]
    document = along_profile(generator, sketch, document)
    if generator.random() < 1 / 3:
        document["operation"]["gravity"] = sized(generator, 0.1, 9.81)
    return document


def changing(generator: random.Random) -> Document:
    """Any kind of scene whose rotor's unbalance changes once to four times, as in a lost blade."""
    kinds = (planar, run_up, two_support, flexible, finite, impacts, offset, sticking, unequal)
    document: Document = {"operation": {"motor": {}}}
    while "motor" in document["operation"]:
        document = generator.choice((*kinds, profile))(generator)
    end = length_of(document)
    rotor = document["rotor"]
    amount = rotor["unbalance"] if "unbalance" in rotor else rotor["unbalances"][0]["amount"]
    document["operation"]["unbalance_changes"] = [
        {
            "time": rounded(end * share),
            "amount": rounded(amount * sized(generator, 0.1, 4.0)),
            "angle": even(generator, 0.0, TURN),
        }
        for share in sorted(generator.uniform(0.05, 0.95) for _ in range(generator.randint(1, 4)))
    ]
    return document


FAMILIES: dict[str, Callable[[random.Random], Document]] = {
    "planar": planar,
    "run_up": run_up,
    "two_support": two_support,
    "flexible": flexible,
    "tilting": tilting,
    "bearings": bearings,
    "bodies": bodies,
    "rubber": rubber,
    "tables": tables,
    "one_way": one_way,
    "liquid": liquid,
    "heavy": heavy,
    "finite": finite,
    "impacts": impacts,
    "harsh": harsh,
    "offset": offset,
    "sticking": sticking,
    "friction": friction,
    "gravity": gravity,
    "motor": motor,
    "motor_contacts": motor_contacts,
    "unequal": unequal,
    "profile": profile,
    "changing": changing,
}


def draw(family: str, seed: int, number: int) -> Document:
    """The scene of this number, as a document; the same whenever and wherever it is drawn.

    Args:
        family: one of `FAMILIES`.
        seed, number: of the study, and of the scene in it.
    """
    document = FAMILIES[family](random.Random(f"{family} {seed} {number}"))
    return {"title": f"{family} {seed} {number}", **document}
