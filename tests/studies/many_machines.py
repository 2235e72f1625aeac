"""Study: how long do many machines take, and do they agree with machines that run one by one?

    python -m tests.studies.many_machines [COUNT]

Two-ball machines of 50 revolutions with other drag, unbalance and stiffness (10,000 unless a
count is given), by `scene.run.many` in one thread.  Prints processor time a machine for some
tolerances, and the largest difference of `residual` and `largest` from runs whose tolerance is
1e-11, over the largest amplitude; then the time of the same machines in lanes of 1, 2 and 4, whose
bits must be the same.
"""

from __future__ import annotations

import math
import sys
import time

import numpy as np

from autobalancer.fmus.composite.batch import BatchRuns
from autobalancer.harness import Scene, cosimulate_many, load_scene
from autobalancer.harness.master.one_file import composition

REVOLUTIONS, COUNT, FEWER, SEED = 50, 10_000, 200, 1
TOLERANCES, FINEST = (1e-3, 1e-5, 1e-7), 1e-11
RESULTS = ["residual", "largest"]


def machine(tolerance: float) -> Scene:
    """The scene of all machines."""
    steps = {"coupling.scheme": "auto", "coupling.steps_per_rev": None}
    steps |= {"coupling.corrections": None, "coupling.tolerance": tolerance}
    return load_scene("two_balls").replace({**steps, "run.revolutions": REVOLUTIONS})


def table(count: int) -> dict[str, np.ndarray]:
    """What differs: factors of the scene's own values."""
    rng = np.random.default_rng(SEED)
    return {
        "weights.drag": 0.0125 * rng.uniform(0.5, 2.0, count),
        "rotor.unbalance": 0.025 * rng.uniform(0.3, 1.2, count),
        "rotor.stiffness_x": rng.uniform(0.7, 1.4, count),
        "rotor.stiffness_y": 49.0 * rng.uniform(0.7, 1.4, count),
    }


def print_times(count: int) -> None:
    """Processor time a machine by tolerance, and how far results are from the finest."""
    few = table(FEWER)
    finest = cosimulate_many(machine(FINEST), few, results=RESULTS, threads=1)
    for tolerance in TOLERANCES:
        scene = machine(tolerance)
        found = cosimulate_many(scene, few, results=RESULTS, threads=1)
        error = max(float(np.abs(found[name] - finest[name]).max()) for name in RESULTS)
        begun = time.process_time()
        cosimulate_many(scene, table(count), threads=1)
        spent = (time.process_time() - begun) / count
        relative = error / float(finest["largest"].max())
        print(f"tolerance {tolerance:g}: {spent * 1e6:.0f} us a machine, error {relative:.1e}")


def print_lanes() -> None:
    """Time of the same machines with 1, 2 and 4 side by side; their bits are the same."""
    scene, columns = machine(1e-5), table(FEWER)
    made = composition(scene)
    values = np.column_stack(list(columns.values()))
    ends = np.full(FEWER, math.tau * REVOLUTIONS / scene.operation.speed)
    seen = set()
    for side in (1, 2, 4):
        runs = BatchRuns(
            made, list(columns), ["rotor.x", "rotor.y"], 20 * REVOLUTIONS, side_by_side=side
        )
        spent = []
        for _ in range(3):
            begun = time.process_time()
            signals, _ = runs(values, ends)
            spent.append((time.process_time() - begun) / FEWER)
        seen.add(signals.tobytes())
        print(f"{side} side by side: {min(spent) * 1e6:.0f} us a machine, by the library alone")
    print("bits:", "the same" if len(seen) == 1 else "NOT the same")


if __name__ == "__main__":
    print_times(int(sys.argv[1]) if len(sys.argv) > 1 else COUNT)
    print_lanes()
