"""Run-ups of machines of which the closed form says that no weights can be left behind.

`python -m tests.studies.left_behind.passes [MACHINES] [STARTS] [FIRST] [SEED]` draws machines of
every kind with 1.02 to 3 times the drag of the closed form, runs each up from random angles within
20 to 100 periods of the lowest natural frequency by `integrate.c`, and counts weights that are left
behind.  A run-up that ends with weights behind the rotor is continued: they may still be on their
way.  A machine depends on its number alone, so the parts 0 to 99 and 100 to 199 are the whole.
"""

from __future__ import annotations

import math
import os
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np

from autobalancer.models.capture import capture
from autobalancer.models.linear.modes import modes

from .draw import KINDS, Drawn, draw
from .machine import library, run

SEED = 5
HELD = 60.0  # turns at the speed, and 60 kappa m/h
APART = 1e-4  # relative: drags of weights that are alike
STIFFEST = 10.0  # rate of the drag over the speed: steeper ones need shorter steps
CONTINUED, LATE = 10.0, 10  # times as long, and the windows of 40 that decide then
BEHIND = 0.98  # of the rotor's speed


def suitable(kind: str, random: np.random.Generator) -> tuple[Drawn, float, float]:
    """A machine that passes at its speed, the speed, and its lowest natural frequency."""
    while True:
        machine = draw(kind, random)
        lowest = float(modes(machine.assembly.loaded_rotor, 0.0).natural_frequencies.min())
        speed = lowest * random.uniform(2.0, 5.0)
        factor = capture(machine.assembly, speed).drag_ratio * random.uniform(1.02, 3.0)
        if not 0.0 < factor < math.inf:
            continue
        machine = machine.with_drag(factor)
        stiffest = max(w.drag / (w.kappa * w.mass) for w in machine.weights)
        if stiffest < STIFFEST * speed and capture(machine.assembly, speed).all_pass:
            return machine, speed, lowest


def left_behind(machine: Drawn, speed: float, lowest: float, seed: int) -> bool:
    """Whether a run-up ends with weights behind the rotor."""
    random = np.random.default_rng(seed)
    count = len(machine.weights)
    rise = random.uniform(20.0, 100.0) * math.tau / lowest
    slowest = max(60.0 * w.kappa * w.mass / w.drag for w in machine.weights)
    end = rise + max(HELD * math.tau / speed, slowest)
    angles = random.uniform(0.0, math.tau, count)
    profile = [(0.0, 0.0), (rise, speed)]
    # alike to the last bit they would stay together for ever
    weights = [replace(w, drag=w.drag * (1.0 + APART * k)) for k, w in enumerate(machine.weights)]
    start = angles, np.zeros(count)
    windows, _ = run(machine.rotor, weights, profile, *start, end, 40)
    if not (windows[-2:, 2::3].mean(axis=0) < BEHIND * speed).any():
        return False
    windows, _ = run(machine.rotor, weights, profile, *start, CONTINUED * end, 40)
    return bool((windows[-LATE:, 2::3].mean(axis=0) < BEHIND * speed).any())


def study(
    machines: int, starts: int, first: int = 0, seed: int = SEED
) -> Iterator[tuple[int, str, int]]:
    """By machine its number, its kind and the number of run-ups with weights left behind."""
    library()
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for number in range(first, first + machines):
            kind = KINDS[number % len(KINDS)]
            drawn = suitable(kind, np.random.default_rng([seed, number]))
            found = pool.map(lambda k, drawn=drawn: left_behind(*drawn, k), range(starts))
            yield number, kind, sum(found)


def main() -> None:
    given = [int(argument) for argument in sys.argv[1:]]
    machines, starts, first, seed = [*given, *(200, 20, 0, SEED)[len(given) :]]
    rows = []
    for number, kind, behind in study(machines, starts, first, seed):
        rows.append((kind, behind))
        if behind or number % 20 == 19:
            total = sum(n for _, n in rows)
            print(f"machine {number}, {kind}: {behind} of {starts}; {total} so far", flush=True)
    for kind in KINDS:
        counts = [n for name, n in rows if name == kind]
        print(f"{kind}: {sum(counts)} of {starts * len(counts)} run-ups with weights left behind")
    print(f"{sum(n for _, n in rows)} of {machines * starts}")


if __name__ == "__main__":
    main()
