"""Random machines for the study of verdicts: light and heavy balancers, all that a scene can do."""

from __future__ import annotations

import math
import random
from collections.abc import Callable

from tests.studies import verdict_supports as supports
from tests.studies.truth import draw
from tests.studies.truth.sketch import Document, even, rounded, sized
from tests.studies.verdict_supports import on

MOST_REVOLUTIONS = 120.0


class Machine:
    """Sizes that the parts of one scene are drawn from.

    Attributes:
        mass, natural, ratio: of the rotor [kg, rad/s], and its speed over the natural frequency.
        radius, moment: of the track [m], and what all weights hold [kg m].
        share: unbalance over what the weights hold.
    """

    def __init__(self, g: random.Random) -> None:
        self.mass, self.natural = sized(g, 0.5, 50.0), sized(g, 10.0, 200.0)
        self.ratio = g.choice((even(g, 1.3, 4.5), even(g, 1.8, 3.0), even(g, 0.3, 1.3)))
        self.radius = sized(g, 0.03, 0.3)
        self.moment = self.mass * self.radius * sized(g, 5e-4, 2e-2)
        self.share = g.choice((even(g, 0.05, 0.95), even(g, 0.2, 0.8), even(g, 1.05, 4.0)))
        self.damping = sized(g, 5e-3, 0.2)
        self.apart = g.choice((1.0, even(g, 1.1, 2.5)))

    @property
    def speed(self) -> float:
        """[rad/s]."""
        return rounded(self.natural * self.ratio)

    def pair(self, mass: float) -> tuple[list[float], list[float]]:
        """Stiffness and damping along x and y of a support that carries a mass."""
        k = mass * self.natural**2
        c = 2.0 * self.damping * mass * self.natural
        return [rounded(k), rounded(k * self.apart)], [rounded(c), rounded(c * self.apart**0.5)]


def weights(g: random.Random, m: Machine, name: str, moment: float) -> Document:
    """Balls, rollers or pendulums that hold so much together [kg m]."""
    count = g.choice((2, 2, 3, 4))
    mass = moment / count / m.radius
    found: Document = {
        "kind": g.choice(("balls", "balls", "rollers", "pendulums")),
        "name": name,
        "count": count,
        "mass": rounded(mass),
        "track_radius": m.radius,
        "drag": rounded(mass * m.speed * sized(g, 3e-3, 1.0)),
        "angles": [even(g, 0.0, 6.28) for _ in range(count)],
    }
    if g.random() < 0.3:
        found["speeds"] = [rounded(-m.speed)] * count
    return found


def planar(g: random.Random, m: Machine) -> Document:
    """A disc with one balancer at a constant speed."""
    stiffness, damping = m.pair(m.mass)
    rotor = {
        "kind": "planar", "mass": m.mass, "stiffness": stiffness, "damping": damping,
        "unbalance": rounded(m.share * m.moment), "unbalance_angle": even(g, 0.0, 6.28),
    }  # fmt: skip
    return {
        "rotor": rotor,
        "balancer": [weights(g, m, "weights", m.moment)],
        "operation": {"speed": m.speed},
        "run": {"revolutions": sized(g, 10.0, MOST_REVOLUTIONS)},
    }


def short(g: random.Random, m: Machine) -> Document:
    """A run of less than a few revolutions."""
    return {**planar(g, m), "run": {"revolutions": sized(g, 0.02, 8.0)}}


def over_capacity(g: random.Random, m: Machine) -> Document:
    """More unbalance than the weights hold."""
    m.share = even(g, 1.02, 6.0)
    return planar(g, m)


def below_critical(g: random.Random, m: Machine) -> Document:
    """A speed below the natural frequencies."""
    m.ratio, m.share = even(g, 0.3, 0.95), even(g, 0.1, 0.9)
    return planar(g, m)


def resonance(g: random.Random, m: Machine) -> Document:
    """A speed at or next to a natural frequency."""
    m.ratio, m.damping = even(g, 0.95, 1.15), sized(g, 1e-3, 0.05)
    return planar(g, m)


def settling(g: random.Random, m: Machine) -> Document:
    """A machine that balances, in runs that are about as long as it needs."""
    m.ratio, m.share = even(g, 1.6, 3.5), even(g, 0.2, 0.8)
    return {**planar(g, m), "run": {"revolutions": sized(g, 30.0, 3.0 * MOST_REVOLUTIONS)}}


def gravity(g: random.Random, m: Machine) -> Document:
    """Gravity from 1e-6 m/s^2 to that of the earth."""
    document = g.choice((planar, settling, over_capacity, below_critical))(g, m)
    document["operation"]["gravity"] = sized(g, 1e-6, 9.81)
    return document


def liquid(g: random.Random, m: Machine) -> Document:
    """A liquid balancer, alone or with weights."""
    document = planar(g, m)
    chamber = m.radius
    one: Document = {
        "kind": "liquid", "name": "liquid", "chamber_radius": chamber,
        "float_radius": rounded(chamber * even(g, 0.4, 0.9)), "density": 1000.0,
        "height": rounded(m.mass * sized(g, 0.01, 1.0) / (1000.0 * math.pi * chamber**2)),
    }  # fmt: skip
    document["balancer"] = [one] if g.random() < 0.7 else [one, *document["balancer"]]
    if g.random() < 0.3:
        rotor = document["rotor"]
        rotor["stiffness"], rotor["damping"] = rotor["stiffness"][0], rotor["damping"][0]
        rotor["internal_damping"] = rounded(rotor["damping"] * even(g, 0.05, 0.5))
    return document


def motor(g: random.Random, m: Machine) -> Document:
    """A motor that passes the resonance, or not."""
    document = planar(g, m)
    inertia = rounded(m.mass * m.radius**2 * sized(g, 0.3, 3.0))
    turns = document["run"]["revolutions"]
    # the time of the run is enough to run up several times over, or hardly
    stall = rounded(inertia * m.speed**2 / (math.tau * turns) * sized(g, 1.0, 20.0))
    drive = {"inertia": inertia, "stall_torque": stall, "no_load_speed": m.speed}
    if g.random() < 0.5:
        drive["from"] = rounded(m.speed * even(g, 0.0, 0.95))
    return {**document, "operation": {"motor": drive}}


def profile(g: random.Random, m: Machine) -> Document:
    """Up, a plateau, and another speed or rest."""
    document = planar(g, m)
    turns = document["run"].pop("revolutions")
    period = math.tau / m.speed
    rise, stay = turns * period * even(g, 0.2, 1.0), turns * period
    other = g.choice((0.0, rounded(m.speed * even(g, 0.4, 0.9))))
    corners = [(0.0, 0.0), (rise, m.speed), (rise + stay, m.speed)]
    corners.append((rise + stay + rise, other))
    if other:
        corners.append((rise + 2.0 * stay + rise, other))
    document["operation"] = {"profile": [[float(f"{t:.6g}"), s] for t, s in corners]}
    return document


def run_up(g: random.Random, m: Machine) -> Document:
    """A rise to the speed, and then some time there, from rest."""
    document = planar(g, m)
    seconds = document["run"]["revolutions"] * math.tau / m.speed * even(g, 0.1, 1.2)
    document["operation"] = {"run_up": {"from": 0.0, "to": m.speed, "seconds": rounded(seconds)}}
    return document


def changing(g: random.Random, m: Machine) -> Document:
    """An unbalance that changes early, in the middle or late."""
    document = g.choice((planar, settling))(g, m)
    seconds = document["run"]["revolutions"] * math.tau / m.speed
    change = {
        "time": rounded(seconds * even(g, 0.05, 0.99)),
        "amount": rounded(m.moment * even(g, 0.0, 1.3)),
        "angle": even(g, 0.0, 6.28),
    }
    document["operation"]["unbalance_changes"] = [change]
    return document


def two_planes(g: random.Random, m: Machine) -> Document:
    """A rigid rotor on two supports with weights in two planes, or in one."""
    span = rounded(m.radius * even(g, 2.0, 5.0))
    inertia = rounded(m.mass * span**2 * even(g, 0.05, 0.3))
    stiffness, damping = m.pair(0.5 * m.mass)
    places = [rounded(0.1 * span), rounded(0.9 * span)]
    half = 0.5 * m.moment
    rotor = {
        "kind": "two_support", "mass": m.mass, "inertia": inertia, "span": span,
        "polar_inertia": rounded(inertia * even(g, 0.0, 0.7)), "com": rounded(0.5 * span),
        "stiffness": [stiffness, stiffness], "damping": [damping, damping], "planes": places,
        "unbalances": [
            {"position": z, "amount": rounded(m.share * half * even(g, 0.3, 1.0)),
             "angle": even(g, 0.0, 6.28)}
            for z in places
        ],
    }  # fmt: skip
    planes = (1, 2) if g.random() < 0.8 else (1,)
    return {
        "rotor": rotor,
        "balancer": [weights(g, m, f"plane{p}", half) | {"at": p} for p in planes],
        "operation": {"speed": m.speed},
        "run": {"revolutions": sized(g, 10.0, MOST_REVOLUTIONS)},
    }


def off_centre(g: random.Random, m: Machine) -> Document:
    """Tracks that are off centre, by a share of the vibration of the rotor alone far above it."""
    document = g.choice((planar, settling, settling, two_planes))(g, m)
    for balancer in document["balancer"]:
        size, turn = m.share * m.moment / m.mass * sized(g, 3e-3, 1.0), g.uniform(0.0, math.tau)
        balancer["track_offset_xi"] = rounded(size * math.cos(turn))
        balancer["track_offset_eta"] = rounded(size * math.sin(turn))
    return document


def _as_built(maker: Callable[[random.Random], Document]) -> Callable[..., Document]:
    """A machine of the truth study at a constant speed, with weights, for some revolutions."""

    def made(g: random.Random, _m: Machine) -> Document:
        document: Document = {}
        while not document.get("balancer") or "speed" not in document["operation"]:
            document = maker(g)
        return {**document, "run": {"revolutions": sized(g, 10.0, MOST_REVOLUTIONS)}}

    return made


_BASES = (planar, settling, settling, two_planes)
FAMILIES: dict[str, Callable[[random.Random, Machine], Document]] = {
    "planar": planar, "short": short, "over capacity": over_capacity,
    "below critical": below_critical, "resonance": resonance, "settling": settling,
    "gravity": gravity, "liquid": liquid, "motor": motor, "profile": profile, "run-up": run_up,
    "changing": changing, "two planes": two_planes, "off centre": off_centre,
    "tilting": _as_built(draw.tilting), "bearings": _as_built(draw.bearings),
    "bodies": _as_built(draw.bodies),
    "dry friction": on(supports.dry_friction, _BASES),
    "free strokes": on(supports.free_strokes, _BASES), "stops": on(supports.stops, _BASES),
    "cubic springs": on(supports.cubic_springs, _BASES),
}  # fmt: skip


def drawn(family: str, number: int, seed: int) -> Document:
    """A scene of a family."""
    g = random.Random(f"{family} {number} {seed}")
    return FAMILIES[family](g, Machine(g))
