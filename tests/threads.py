"""Runs one after another and by eight threads: how many times as fast, and with which bits.

python -m tests.threads
"""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor
from functools import partial

from autobalancer.harness import Scene, cosimulate, load_scene

REVOLUTIONS = {True: 100, False: 2000}  # by `separate`: about as long
RUNS, THREADS, REPEATS = 16, 8, 3


def bits(separate: bool, scene: Scene) -> bytes:
    """Everything that a run has recorded."""
    result = cosimulate(scene, separate=separate)
    return b"".join(values.tobytes() for values in result.signals.values())


def main() -> None:
    """Print a line for separate units, and one for the one file."""
    for separate, revolutions in REVOLUTIONS.items():
        scene = load_scene("two_balls").replace({"run.revolutions": revolutions})
        scenes = [scene.replace({"weights.drag": 0.01 + 0.0005 * k}) for k in range(RUNS)]
        run = partial(bits, separate)
        run(scenes[0])  # loads and compiles
        alone, threaded = [], []
        for _ in range(REPEATS):
            begun = time.perf_counter()
            expected = [run(each) for each in scenes]
            alone.append(time.perf_counter() - begun)
            begun = time.perf_counter()
            with ThreadPoolExecutor(THREADS) as executor:
                found = list(executor.map(run, scenes))
            threaded.append(time.perf_counter() - begun)
        print(
            f"{'separate units' if separate else 'one file'}: {RUNS} runs of {revolutions} "
            f"revolutions in {min(alone):.2f} s, by {THREADS} threads in {min(threaded):.2f} s: "
            f"{min(alone) / min(threaded):.2f} times as fast, "
            f"{'the same bits' if found == expected else 'OTHER BITS'}"
        )


if __name__ == "__main__":
    main()
