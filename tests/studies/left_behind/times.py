"""Time of the closed form: `python -m tests.studies.left_behind.times [MACHINES] [SEED]`.

Draws machines of every kind and prints by kind the median and the largest processor time, the
smallest of five for each machine [ms].
"""

from __future__ import annotations

import sys
import time

import numpy as np

from autobalancer.models.assembly import Assembly
from autobalancer.models.capture import capture
from autobalancer.models.linear.modes import modes

from .draw import KINDS, draw

REPEATS = 5


def smallest(assembly: Assembly, speed: float) -> float:
    """Processor time [ms]."""
    found = []
    for _ in range(REPEATS):
        begun = time.process_time()
        capture(assembly, speed)
        found.append(1e3 * (time.process_time() - begun))
    return min(found)


def times(kind: str, machines: int, seed: int) -> list[float]:
    """Of machines of one kind, at 2 to 5 times their lowest natural frequency."""
    found = []
    for number in range(machines):
        random = np.random.default_rng([seed, KINDS.index(kind), number])
        drawn = draw(kind, random)
        lowest = float(modes(drawn.assembly.loaded_rotor, 0.0).natural_frequencies.min())
        drawn = drawn.with_drag(float(np.exp(random.uniform(np.log(0.1), np.log(10.0)))))
        found.append(smallest(drawn.assembly, lowest * random.uniform(2.0, 5.0)))
    return found


def main() -> None:
    given = [int(argument) for argument in sys.argv[1:]]
    machines, seed = [*given, *(20, 12)[len(given) :]]
    for kind in KINDS:
        found = times(kind, machines, seed)
        print(f"{kind}: median {np.median(found):.1f} ms, largest {max(found):.1f} ms", flush=True)


if __name__ == "__main__":
    main()
