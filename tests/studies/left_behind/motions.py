"""Names of steady motions: the package's rules against longer integrations with rules of their own.

`python -m tests.studies.left_behind.motions [MACHINES] [SEED] [FIRST]` draws machines of every
kind, a speed, a drag and a start, runs each with the package and with `integrate.c`, and compares
the names.

The integration judges a machine where it agrees with itself: with two steps, and from starts whose
weights stand further by as much as a run of the package may err, it ends in one motion.  An end is
a motion that its last half and its last quarter have, and whose vibration does not drift; until
then it is run on.  The others are counted as not judged; of them it is counted how often the
package's name is one of those found.  A run that the package calls undecided is counted by itself.
All others count as named alike or not.
"""

from __future__ import annotations

import os
import sys
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace

import numpy as np

import autobalancer as ab
from autobalancer.harness.motions.kinds import Kind
from autobalancer.harness.motions.settle import alone
from autobalancer.harness.motions.starts import job, perturbed
from autobalancer.harness.motions.study import _runs
from autobalancer.harness.scene.quantities import each_of
from autobalancer.models.linear.modes import modes

from .draw import KINDS, Drawn, draw
from .machine import STEPS, library, run

TURNS, WINDOWS = 4000.0, 40  # of a run, half of which decides
MOST_TURNS = 16_000.0  # up to which it is run on, in windows as long
SEED = 2711
SLIPS = 0.02  # of the rotor's speed: weights that slip by less are not left behind
OPEN = (Kind.IRREGULAR, Kind.SYNCHRONOUS, Kind.TWO_FREQUENCIES)  # while their vibration drifts
PART = 20  # machines after which it says how many agree so far
ERROR = 1e-4  # rad: the tolerance of a run of the package, of a turn at least
# moves of the first weight, finer steps; so many that they do not agree by chance where a start is
# sensitive, which is seen by the first ones alone as a rule
WITNESSES = ((0.0, 1), (0.0, 2), (ERROR, 1), (-ERROR, 1))
MORE = tuple((ERROR * k / 6.0, 1) for k in (-5, -4, -3, -2, -1, 1, 2, 3, 4, 5))


@dataclass
class Case:
    """A machine at a speed, from one start."""

    machine: Drawn
    scene: ab.Scene
    speed: float
    start: str
    seed: int


def case(kind: str, number: int, seed: int = SEED) -> Case:
    """Drags of 0.00025 to 0.02 N s/m, at 1.2 to 4.5 times the lowest natural frequency."""
    random = np.random.default_rng([seed, number])
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
    turns, bare = TURNS, alone(one.scene, one.speed)
    while True:
        end, windows = turns * 2.0 * np.pi / one.speed, round(WINDOWS * turns / TURNS)
        found, _ = run(
            one.machine.rotor, weights, [(0.0, one.speed)], angles, rates, end, windows,
            finer * STEPS,
        )  # fmt: skip
        half, quarter = (
            _named(found[-(windows // part) :], one.speed, bare, end / windows) for part in (2, 4)
        )
        ended = half == quarter and not (half[0] in OPEN and _drifts(found[-(windows // 4) :, 1]))
        if ended or turns >= MOST_TURNS:
            return half
        turns *= 2.0


def _drifts(values: np.ndarray) -> bool:
    """Whether values rise, or fall, from window to window, by more than 1 %."""
    steps = np.diff(values)
    one_way = (steps > 0.0).all() or (steps < 0.0).all()
    return bool(one_way and np.ptp(values) > 0.01 * values.mean())


def _named(late: np.ndarray, speed: float, bare: float, seconds: float) -> tuple[Kind, int]:
    """What windows of so many seconds show."""
    vibration, means = late[:, 1], late[:, 2::3]
    swing = (late[:, 4::3] - late[:, 3::3]).max() / speed
    mean = means.mean(axis=0)
    slow = mean < (1.0 - SLIPS) * speed
    if not slow.any():
        if vibration[-5:].max() < 0.05 * bare:
            return Kind.BALANCED, 0
        if vibration.std() > 0.02 * vibration.mean():
            return Kind.IRREGULAR, 0
        return (Kind.SYNCHRONOUS if swing < 1e-3 else Kind.TWO_FREQUENCIES), 0
    lag = speed - means[:, slow]
    # a window cuts a swing anywhere; weights that slip at random move away from a steady turning
    off = np.cumsum((lag - lag.mean(axis=0)) * seconds, axis=0)
    turns_steadily = np.ptp(off, axis=0) < 2.0 * np.pi
    steady = (turns_steadily | (lag.std(axis=0) < 0.02 * lag.mean(axis=0))).all()
    rest_turn = (np.abs(mean[~slow] - speed) < 0.004 * speed).all()
    return (Kind.BEHIND, int(slow.sum())) if steady and rest_turn else (Kind.IRREGULAR, 0)


@dataclass
class Row:
    """A machine with the package's name of its motion and those of the witnesses."""

    case: Case
    package: tuple[Kind, int]
    witnesses: list[tuple[Kind, int]]

    @property
    def is_undecided(self) -> bool:
        """Whether the package has not decided."""
        return self.package[0] is Kind.UNDECIDED

    @property
    def is_judged(self) -> bool:
        """Whether the integration agrees with itself."""
        return len(set(self.witnesses)) == 1

    @property
    def is_among(self) -> bool:
        """Whether the package's name is one that the integration finds."""
        return self.package in self.witnesses

    @property
    def agrees(self) -> bool:
        """Whether the package's name is that of the integration."""
        return self.is_judged and self.package == self.witnesses[0]


def study(machines: int, seed: int = SEED, first: int = 0) -> Iterator[Row]:
    """Every machine with its names."""
    library()
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for number in range(first, first + machines):
            one = case(KINDS[number % len(KINDS)], number, seed)
            names: list[tuple[Kind, int]] = []
            for witnesses in (WITNESSES, MORE):
                if len(set(names)) <= 1:
                    own = [pool.submit(by_integration, one, *witness) for witness in witnesses]
                    names += [found.result() for found in own]
            yield Row(one, by_package(one), names)


def main() -> None:
    given = [int(argument) for argument in sys.argv[1:]]
    machines, seed, first = [*given, *(200, SEED, 0)[len(given) :]]
    found = []
    for row in study(machines, seed, first):
        found.append(row)
        if not row.agrees:
            one = row.case
            words = f"{one.seed} {one.machine.kind} {one.start} speed {one.speed:.3f}"
            ours = f"{row.package[0].name} {row.package[1]}"
            theirs = Counter(f"{kind.name} {count}" for kind, count in row.witnesses)
            said = ", ".join(f"{name} ({many})" for name, many in theirs.most_common())
            print(f"{words}: package {ours}, integration {said}", flush=True)
        if len(found) % PART == 0 or len(found) == machines:
            print(summary(found), flush=True)
    names = Counter(f"{row.witnesses[0][0].name.lower()} {row.witnesses[0][1] or ''}"
                    for row in found if row.is_judged)  # fmt: skip
    print("by the integration:", ", ".join(f"{n} {name}" for name, n in names.most_common()))


def summary(found: list[Row]) -> str:
    """How many are judged, decided, and named alike."""
    judged = [row for row in found if row.is_judged]
    decided = [row for row in judged if not row.is_undecided]
    agree = sum(row.agrees for row in decided)
    undecided = sum(row.is_undecided for row in found)
    open_ = [row for row in found if not (row.is_judged or row.is_undecided)]
    among = sum(row.is_among for row in open_)
    share = f"{agree} of {len(decided)} named alike ({100 * agree / max(len(decided), 1):.1f} %)"
    return (
        f"{len(found)} machines: {undecided} undecided by the package, "
        f"{len(found) - len(judged)} not judged (the package's name is found in {among} of "
        f"{len(open_)} that it decides), of the others {share}"
    )


if __name__ == "__main__":
    main()
