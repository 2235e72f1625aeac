"""Shares of run-ups by the package and by an integration, from the same starts.

`python -m tests.studies.left_behind.shares [STARTS]` runs three machines up: a light ball balancer,
supports with two natural frequencies, and a drag above the closed form's limit.  It prints the
shares of the package with their intervals, those of `integrate.c`, and how many starts end in the
same motion.
"""

from __future__ import annotations

import os
import sys
from collections import Counter
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import autobalancer as ab
from autobalancer.harness.motions.kinds import Kind
from autobalancer.harness.motions.outcome import wilson
from autobalancer.harness.motions.starts import job, perturbed
from autobalancer.harness.motions.study import _runs
from autobalancer.harness.scene.quantities import each_of

from .machine import Weight, library, planar, run

STEPS, WINDOWS, LATE, BEHIND = 120, 60, 10, 0.98
MACHINES = {  # stiffness, damping, drag, seconds of the run-up, speed
    "light ball balancer": (1.0, 0.02, 0.001, 60.0, 3.0),
    "two natural frequencies": ((1.0, 4.0), (0.1, 0.2), 0.006, 60.0, 4.0),
    "drag above the limit": (1.0, 0.1, 0.0075, 300.0, 4.0),
}
MASS, UNBALANCE = 0.0327, 0.01


def scene_of(name: str) -> ab.Scene:
    """One of `MACHINES`."""
    stiffness, damping, drag, seconds, speed = MACHINES[name]
    rotor = {"kind": "planar", "mass": 1.0, "stiffness": stiffness, "damping": damping,
             "unbalance": UNBALANCE}  # fmt: skip
    balls = {"name": "balls", "kind": "balls", "count": 2, "mass": MASS, "track_radius": 1.0,
             "drag": drag}  # fmt: skip
    drive = {"profile": [[0.0, 0.0], [seconds, speed]]}
    return perturbed(ab.Scene(rotor=rotor, balancer=[balls], operation=drive))[0]


def compare(name: str, starts: int) -> list[tuple[int, int]]:
    """By start the number of balls left behind: of the package (-1: another motion), and own."""
    library()
    stiffness, damping, _, seconds, speed = MACHINES[name]
    scene = scene_of(name)
    kind, count, *_ = _runs((scene, speed, "run-up", 1, 0, starts))
    made, _ = job(scene, speed, "run-up", 1, 0, starts)
    named = np.where(np.isin(kind, [Kind.BALANCED, Kind.BEHIND]), count, -1).astype(int)
    rotor = planar(1.0, stiffness, damping, UNBALANCE)
    weights = [Weight(0, MASS, 1.0, d) for d in each_of(scene.balancer[0].drag)]

    def own(angles: np.ndarray) -> int:
        profile = [(0.0, 0.0), (seconds, speed)]
        windows, _ = run(
            rotor, weights, profile, angles, np.zeros(2), seconds + 1200.0, WINDOWS, STEPS
        )
        return int((windows[-LATE:, 2::3].mean(axis=0) < BEHIND * speed).sum())

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found = list(pool.map(own, made.values[:, 0::2]))
    return list(zip(named.tolist(), found, strict=True))


def main() -> None:
    starts = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    print("| machine | balls left behind | package (95 %) | integration |\n|---|---:|---|---:|")
    for name in MACHINES:
        pairs = compare(name, starts)
        package, own = (Counter(column) for column in zip(*pairs, strict=True))
        for k in sorted(package | own):
            low, high = wilson(package[k], starts)
            share = f"{100 * package[k] / starts:.1f} % ({100 * low:.1f} to {100 * high:.1f})"
            print(f"| {name} | {k} | {share} | {100 * own[k] / starts:.1f} % |")
        print(f"{name}: {sum(a == b for a, b in pairs)} of {starts} starts end in the same motion")


if __name__ == "__main__":
    main()
