"""Command: random scenes whose growth is hard to tell from zero, by three methods.

python -m tests.studies.regions 200 [SEED]

Tiny masses, huge drag and nearly equal stiffness make growth rates of 1e-6 to 1e-12 per revolution.
Two methods contradict each other where one states stable and the other unstable, outside the errors
of their limits.
"""

from __future__ import annotations

import math
import random
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import autobalancer as ab
from autobalancer.harness import UserError
from autobalancer.harness.stability.speeds import Speeds

KINDS = ("tiny mass", "huge drag", "nearly equal stiffness")
LOWEST, HIGHEST = 0.3, 3.0  # of the range, times the rotor's natural frequency
NARROWEST_PROVED = 1e-4  # of the range: an undecided band of a proof

Stretch = tuple[float, float, str]  # from, to, what is stated


@dataclass
class Found:
    """What the methods say of one scene.

    Attributes:
        kind, number: which scene.
        limits: number of limits by method.
        undecided: number of undecided regions by method.
        contradictions: pairs of methods, and where they contradict each other.
        refused: reasons of methods without an answer.
    """

    kind: str
    number: int
    limits: dict[str, int] = field(default_factory=dict)
    undecided: dict[str, int] = field(default_factory=dict)
    contradictions: list[str] = field(default_factory=list)
    refused: dict[str, str] = field(default_factory=dict)
    seconds: float = 0.0


def draw(seed: int, number: int) -> tuple[str, dict[str, Any]]:
    """Kind and document of one scene."""
    generator = random.Random(f"regions {seed} {number}")
    kind = KINDS[number % len(KINDS)]
    mass, frequency = _log(generator, 0.1, 100.0), _log(generator, 5.0, 300.0)
    radius = _log(generator, 0.05, 0.5)
    each = mass * _log(generator, *((1e-9, 1e-6) if kind == "tiny mass" else (1e-4, 3e-2)))
    drag = each * frequency * _log(generator, 0.1, 10.0)
    stiffness = [mass * frequency**2 * ratio for ratio in (1.0, generator.uniform(1.2, 4.0))]
    if kind == "huge drag":
        drag = each * frequency * _log(generator, 1e3, 1e7)
        stiffness = [stiffness[0]] * 2 if generator.random() < 0.25 else stiffness
    if kind == "nearly equal stiffness":
        stiffness[1] = stiffness[0] * (1.0 + _log(generator, 1e-12, 1e-3))
    damping = 2.0 * mass * frequency * _log(generator, 1e-4, 0.2)
    planes = generator.choice((1, 1, 2))
    rotor: dict[str, Any] = {"kind": "planar", "mass": mass, "stiffness": stiffness}
    rotor |= {"damping": damping, "unbalance_angle": generator.uniform(-3.0, 3.0)}
    capacity = 2 * planes * each * radius
    rotor["unbalance"] = capacity * generator.uniform(0.05, 0.9)
    balancers = [
        {
            "name": f"b{k}",
            "kind": generator.choice(("balls", "rollers", "pendulums")),
            "count": 2,
            "mass": each,
            "track_radius": radius,
            "drag": drag,
            "angles": [generator.uniform(0.0, math.pi), generator.uniform(math.pi, 6.28)],
        }
        for k in range(planes)
    ]
    document = {"title": f"{kind} {number}", "rotor": rotor, "balancer": balancers}
    return kind, {**document, "operation": {"speed": 2.0 * frequency}, "run": {"revolutions": 5}}


def _log(generator: random.Random, low: float, high: float) -> float:
    return math.exp(generator.uniform(math.log(low), math.log(high)))


def compare(seed: int, number: int, proved: bool = True) -> Found:
    """Speeds of one scene by all methods, compared two by two."""
    kind, document = draw(seed, number)
    scene, found, begun = ab.Scene.from_document(document), Found(kind, number), time.process_time()
    frequency = scene.operation.speed / 2.0
    span = LOWEST * frequency, HIGHEST * frequency
    speeds = scene.speeds(*span, "floquet,cosim")
    stated = {method: list(stretches(speeds, method)) for method in speeds.methods}
    found.refused = dict(speeds.refused)
    if proved:
        try:
            narrowest = NARROWEST_PROVED * (span[1] - span[0])
            proof = scene.speeds(*span, "proved", narrowest=narrowest)
            found.refused |= proof.refused
            if proof.proof is not None:
                stated["proved"] = [(b.low, b.high, b.state) for b in proof.proof.bands]
        except UserError as error:
            found.refused["proved"] = str(error)
    found.limits = {method: len(found_by) for method, found_by in speeds.methods.items()}
    found.undecided = {method: len(each) for method, each in speeds.undecided.items()}
    names = list(stated)
    for place, one in enumerate(names):
        for other in names[place + 1 :]:
            for low, high in contradictions(stated[one], stated[other]):
                found.contradictions.append(f"{one}, {other}: {low:.9g} to {high:.9g} rad/s")
    found.seconds = time.process_time() - begun
    return found


def stretches(speeds: Speeds, method: str) -> Iterator[Stretch]:
    """What a method states of the range, without the errors of its limits."""
    low, state = speeds.range[0], str(speeds.lowest[method])
    for crossing in speeds.methods[method]:
        yield low, crossing.speed - crossing.error, state
        low, state = crossing.speed + crossing.error, str(crossing.above)
    yield low, speeds.range[1], state


def contradictions(
    one: Sequence[Stretch], other: Sequence[Stretch]
) -> Iterator[tuple[float, float]]:
    """Where one states stable and the other unstable."""
    for low, high, state in one:
        for begin, end, beside in other:
            left, right = max(low, begin), min(high, end)
            if {state, beside} == {"stable", "unstable"} and right - left > 1e-9 * right:
                yield left, right


def states_alternate(speeds: Speeds) -> bool:
    """Whether no two rows of a method stand at one speed or state the same."""
    for method, crossings in speeds.methods.items():
        states = [speeds.lowest[method], *(c.above for c in crossings)]
        places = [c.speed for c in crossings]
        if any(a == b for a, b in pairwise(states)):
            return False
        if any(a >= b for a, b in pairwise(places)):
            return False
    return True


def main(count: int, seed: int = 1) -> None:
    """Compare and print."""
    all_found = []
    for number in range(count):
        found = compare(seed, number)
        all_found.append(found)
        for line in found.contradictions:
            print(f"{found.kind} {number}: {line}", flush=True)
        for method, reason in found.refused.items():
            print(f"{found.kind} {number}: {method} refuses: {reason[:100]}", flush=True)
    print("| kind | scenes | limits | undecided by floquet | by cosim | contradictions |")
    print("|---|---|---|---|---|---|")
    for kind in (*KINDS, "all"):
        mine = [f for f in all_found if kind in (f.kind, "all")]
        total = Counter[str]()
        for found in mine:
            total += Counter({f"limits {k}": n for k, n in found.limits.items()})
            total += Counter({f"undecided {k}": n for k, n in found.undecided.items()})
        wrong = sum(len(f.contradictions) for f in mine)
        print(
            f"| {kind} | {len(mine)} | {total['limits floquet']} | {total['undecided floquet']} "
            f"| {total['undecided cosim']} | {wrong} |"
        )
    print(f"{sum(f.seconds for f in all_found):.0f} s of processor time")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:3]))
