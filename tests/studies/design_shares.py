"""Shares that `design` states, against run-ups of the weights that it recommends.

`python -m tests.studies.design_shares [MACHINES] [RUN-UPS] [--from K]` draws rotors with their
drive and the drag of a weight, lets `design` recommend balls, and runs its worst corner up from
other starts.  `--from` starts at that machine, so that a long study can be run in parts.
These are judged by the rules of `motions`, which share nothing with those of `design`.  A stated
share holds where its interval and that of the run-ups overlap.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

import autobalancer as ab
from autobalancer.harness.design.answer import sure
from autobalancer.harness.design.scenes import with_balls
from autobalancer.harness.design.trials import Trial, corner_scenes
from autobalancer.harness.motions.kinds import Kind
from autobalancer.harness.motions.outcome import wilson
from autobalancer.harness.motions.starts import perturbed
from autobalancer.harness.motions.study import _runs

MACHINES, RUN_UPS, SEED, CHUNK = 20, 400, 977, 50
MOST_BALLS, RESERVE = 4, 1.5


@dataclass
class Case:
    """A machine, what `design` is asked, and the drive."""

    scene: ab.Scene
    unbalance: float
    race: float
    width: float
    run_up: float
    drag: float


def case(number: int) -> Case:
    """Fans and spindles: 2 to 50 kg on 5 to 20 Hz, 2.5 to 5 times that, up within 1 to 30 s."""
    random = np.random.default_rng([43, number])
    mass = float(np.exp(random.uniform(np.log(2.0), np.log(50.0))))
    natural = math.tau * random.uniform(5.0, 20.0)
    zeta = float(np.exp(random.uniform(np.log(0.01), np.log(0.08))))
    ratio = random.uniform(1.0, 1.6) if number % 2 else 1.0
    stiffness = [mass * natural**2, ratio * mass * natural**2]
    speed = natural * random.uniform(2.5, 5.0)
    unbalance = mass * random.uniform(3e-6, 3e-5)
    rotor = {"kind": "planar", "mass": mass, "stiffness": stiffness,
             "damping": [2.0 * zeta * math.sqrt(k * mass) for k in stiffness],
             "unbalance": unbalance}  # fmt: skip
    race, width = random.uniform(0.05, 0.12), random.uniform(0.01, 0.02)
    drag = float(np.exp(random.uniform(np.log(1e-3), np.log(0.1))))
    run_up = float(np.exp(random.uniform(np.log(1.0), np.log(30.0))))
    scene = ab.Scene(rotor=rotor, operation={"speed": speed})
    return Case(scene, unbalance, race, width, run_up, drag)


def recommended(one: Case) -> tuple[Trial | None, str]:
    """What `design` recommends, and its first word."""
    found = one.scene.design(
        one.unbalance, race=one.race, width=one.width, run_up=one.run_up, drag=one.drag,
        reserve=RESERVE, most=MOST_BALLS,
    )  # fmt: skip
    good = sure(found)
    word = next(w for w in found.words() if w.startswith(("Take", "None", "Cannot")))
    return (good[0] if good else None), word.split()[0].strip(":")


def share(one: Case, trial: Trial, run_ups: int) -> tuple[int, int]:
    """Run-ups that balance in the worst corner, and that have not decided."""
    profile = [[0.0, 0.0], [one.run_up, one.scene.profile().end]]
    driven = one.scene.replace({"operation.speed": None, "operation.profile": profile})
    corner = trial.worst
    ((scene, _),) = corner_scenes(
        with_balls(driven, one.race, one.width), trial.candidate, [corner.drag], [corner.unbalance]
    )
    scene, _ = perturbed(scene)
    speed = one.scene.profile().end
    kinds = np.concatenate(
        [
            _runs((scene, speed, "run-up", SEED, first, min(CHUNK, run_ups - first)))[0]
            for first in range(0, run_ups, CHUNK)
        ]
    )
    return int((kinds == Kind.BALANCED).sum()), int((kinds == Kind.UNDECIDED).sum())


def study(numbers: range, run_ups: int) -> Iterator[tuple[str, Trial | None, int, int]]:
    """By machine the word, the trial, and the run-ups that balance or have not decided."""
    for number in numbers:
        one = case(number)
        trial, word = recommended(one)
        yield (word, trial, *(share(one, trial, run_ups) if trial else (0, 0)))


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("machines", type=int, nargs="?", default=MACHINES)
    parser.add_argument("run_ups", type=int, nargs="?", default=RUN_UPS)
    parser.add_argument("--from", type=int, default=0, dest="first")
    given = parser.parse_args()
    machines, run_ups = given.machines, given.run_ups
    numbers = range(given.first, given.first + machines)
    print("| machine | says | stated (95 %) | run-ups that balance (95 %) | undecided | holds |")
    print("|---:|---|---|---|---:|---|")
    held = taken = 0
    for k, (word, trial, balanced, open_) in zip(numbers, study(numbers, run_ups), strict=True):
        if trial is None:
            print(f"| {k} | {word} | | | | |", flush=True)
            continue
        (low, high), (from_, to) = trial.interval, wilson(balanced, run_ups)
        holds = low <= to and from_ <= high
        taken, held = taken + 1, held + holds
        stated = f"{trial.worst.balanced}/{trial.worst.of} ({100 * low:.0f} to {100 * high:.0f})"
        seen = f"{balanced}/{run_ups} ({100 * from_:.1f} to {100 * to:.1f})"
        print(
            f"| {k} | {word} | {stated} | {seen} | {open_} | {'yes' if holds else 'NO'} |",
            flush=True,
        )
    print(f"\n{held} of {taken} stated shares hold; {machines - taken} without a recommendation")


if __name__ == "__main__":
    main()
