"""Drags above the stated limit at which weights can be left behind: there should be none.

`python -m tests.studies.left_behind.gaps [MACHINES] [SEED]` draws machines of every kind, asks the
closed form for its limit of the drag, and then at 63 drags up to 12 times that of all weights
whether any weights can be left behind.  It prints machines where they can above the limit.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator

import numpy as np

from autobalancer.models.capture import capture
from autobalancer.models.linear.modes import modes

from .draw import KINDS, draw

DRAGS = np.exp(np.linspace(0.02, 2.5, 63))  # over the limit
ABOVE = 1.01  # of the limit: its own accuracy


def gaps(machines: int, seed: int) -> Iterator[tuple[str, int, float, list[float]]]:
    """By machine its kind, number, limit, and drags over it at which weights are left behind."""
    for number in range(machines):
        random = np.random.default_rng([seed, number])
        kind = KINDS[number % len(KINDS)]
        drawn = draw(kind, random)
        lowest = float(modes(drawn.assembly.loaded_rotor, 0.0).natural_frequencies.min())
        drawn = drawn.with_drag(float(np.exp(random.uniform(np.log(0.1), np.log(10.0)))))
        speed = lowest * random.uniform(2.0, 5.0)
        limit = capture(drawn.assembly, speed).drag_ratio
        if not limit:
            continue
        held = [
            float(drag)
            for drag in DRAGS[DRAGS > ABOVE]
            if capture(drawn.with_drag(drag * limit).assembly, speed).all_pass is False
        ]
        yield kind, number, limit, held


def main() -> None:
    given = [int(argument) for argument in sys.argv[1:]]
    machines, seed = [*given, *(200, 7)[len(given) :]]
    asked = found = 0
    for kind, number, limit, held in gaps(machines, seed):
        asked += 1
        found += bool(held)
        if held:
            where = ", ".join(f"{drag:.3f}" for drag in held)
            print(f"{number} {kind}: limit {limit:.4g}, weights left behind at {where} of it")
    print(f"{found} of {asked} machines with weights left behind above the limit")


if __name__ == "__main__":
    main()
