"""Names of steady motions: the package's rules against longer integrations with rules of their own.

`python -m tests.studies.left_behind.motions [MACHINES]` draws machines of every kind, a speed, a
drag and a start, runs each with the package and with `integrate.c`, and compares the names.  A run
that the package calls undecided is counted by itself.  So is a sensitive start: its integration
ends in another motion with half the steps, and weights that start 1e-9 rad further.
"""

from __future__ import annotations

import os
import sys
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

import autobalancer as ab
from autobalancer.harness.motions.kinds import Kind
from autobalancer.harness.motions.starts import job, perturbed
from autobalancer.harness.motions.study import _runs, alone
from autobalancer.harness.scene.quantities import each_of
from autobalancer.models.linear.modes import modes

from .draw import KINDS, Drawn, draw
from .machine import STEPS, library, run

TURNS, WINDOWS = 4000.0, 40  # of a run, half of which decides
APART = 1e-9  # rad by which a start is moved to see whether it is sensitive


@dataclass
class Case:
    """A machine at a speed, from one start."""

    machine: Drawn
    scene: ab.Scene
    speed: float
    start: str
    seed: int


def case(kind: str, number: int) -> Case:
    """A drag from 0.02 to 1 of what lets all weights through, at 1.2 to 4.5 natural frequencies."""
    random = np.random.default_rng([7, number])
    machine = draw(kind, random)
    lowest = float(modes(machine.assembly.loaded_rotor, 0.0).natural_frequencies.min())
    speed = lowest * random.uniform(1.2, 4.5)
    machine = machine.with_drag(float(np.exp(random.uniform(np.log(0.05), np.log(4.0)))))
    document = {**machine.document, "operation": {"speed": speed}}
    scene, _ = perturbed(ab.Scene(**document))
    return Case(machine, scene, speed, str(random.choice(["rest", "turning"])), number)


def by_package(one: Case) -> tuple[Kind, int]:
    """What the package calls the motion."""
    kind, weights, *_ = _runs((one.scene, one.speed, one.start, one.seed, 0, 1))
    return Kind(int(kind[0])), int(weights[0])


def by_integration(one: Case, moved: float = 0.0, finer: int = 1) -> tuple[Kind, int]:
    """What a long integration ends in, from a start moved by an angle, with so much finer steps."""
    count = len(one.machine.weights)
    made, _ = job(one.scene, one.speed, one.start, one.seed, 0, 1)
    angles = made.values[0][0::2] + moved * np.arange(1, count + 1)
    rates = np.zeros(count) if one.start == "rest" else np.full(count, one.speed)
    drags = [d for b in one.scene.balancer for d in each_of(b.drag)]
    weights = [replace(w, drag=d) for w, d in zip(one.machine.weights, drags, strict=True)]
    end = TURNS * 2.0 * np.pi / one.speed
    windows, _ = run(
        one.machine.rotor, weights, [(0.0, one.speed)], angles, rates, end, WINDOWS, finer * STEPS
    )  # fmt: skip
    late = windows[WINDOWS // 2 :]
    return _named(late, one.speed, alone(one.scene, one.speed))


def _named(late: np.ndarray, speed: float, bare: float) -> tuple[Kind, int]:
    vibration, means = late[:, 1], late[:, 2::3]
    swing = (late[:, 4::3] - late[:, 3::3]).max() / speed
    mean = means.mean(axis=0)
    slow = mean < 0.985 * speed
    if not slow.any():
        if vibration[-5:].max() < 0.05 * bare:
            return Kind.BALANCED, 0
        if vibration.std() > 0.02 * vibration.mean():
            return Kind.IRREGULAR, 0
        return (Kind.SYNCHRONOUS if swing < 1e-3 else Kind.TWO_FREQUENCIES), 0
    lag = speed - means[:, slow]
    steady = (lag.std(axis=0) < 0.02 * lag.mean(axis=0)).all()
    rest_turn = (np.abs(mean[~slow] - speed) < 0.004 * speed).all()
    return (Kind.BEHIND, int(slow.sum())) if steady and rest_turn else (Kind.IRREGULAR, 0)


Row = tuple[Case, tuple[Kind, int], tuple[Kind, int], bool]


def study(machines: int, first: int = 0) -> list[Row]:
    """Every machine with both names, and whether its start is sensitive."""
    library()
    cases = [case(KINDS[i % len(KINDS)], i) for i in range(first, first + machines)]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        package = list(pool.map(by_package, cases))
        own = list(pool.map(by_integration, cases))
        near = list(pool.map(by_integration, cases, [APART] * machines, [2] * machines))
    sensitive = [a != b for a, b in zip(own, near, strict=True)]
    return list(zip(cases, package, own, sensitive, strict=True))


def main() -> None:
    found = study(int(sys.argv[1]) if len(sys.argv) > 1 else 200)
    undecided = [row for row in found if row[1][0] is Kind.UNDECIDED]
    rest = [row for row in found if row[1][0] is not Kind.UNDECIDED]
    sensitive, decided = ([row for row in rest if row[3] is moves] for moves in (True, False))
    agree = [row for row in decided if row[1] == row[2]]
    share = f"{len(agree)} of {len(decided)} named alike ({100 * len(agree) / len(decided):.1f} %)"
    print(f"{len(found)} machines: {len(undecided)} undecided, {len(sensitive)} sensitive, {share}")
    names = Counter(f"{own[0].name.lower()} {own[1] or ''}" for _, _, own, _ in found)
    print("by the integration:", ", ".join(f"{n} {name}" for name, n in names.most_common()))
    for one, package, own, moves in found:
        if package != own or moves:
            words = f"{one.seed} {one.machine.kind} {one.start} speed {one.speed:.3f}"
            ours, theirs = (f"{kind.name} {count}" for kind, count in (package, own))
            word = ", sensitive" if moves else ""
            print(f"{words}: package {ours}, integration {theirs}{word}")


if __name__ == "__main__":
    main()
