"""Release speeds: the closed form against slow run-ups that share no code with it.

`python -m tests.studies.left_behind.release [MACHINES] [STARTS]` draws machines of every kind with
a drag at which weights are let go at 1.4 to 4 times the lowest natural frequency, raises the speed
slowly, and prints the speed at which the last weight is let go over that of the closed form.  A
weight is left behind while it is nearer to the natural frequency than to the rotor's speed.
"""

from __future__ import annotations

import math
import os
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np

from autobalancer.models.capture import LeftBehind, capture
from autobalancer.models.linear.modes import modes

from .draw import KINDS, Drawn, draw
from .machine import library, run

SECONDS, WINDOWS = 12_000.0, 1500
APART = 1e-4  # relative: drags of weights that are alike
LATEST = 1.05


def possible(machine: Drawn, speed: float) -> list[LeftBehind]:
    """Motions beside natural frequencies below the rotor's speed.

    Beside one above it, which a gyroscopic rotor may never reach, bunched weights lag by little
    and count as turning with the rotor.
    """
    motions = capture(machine.assembly, speed).motions
    return [motion for natural, motion in motions if natural.frequency < speed]


def predicted(machine: Drawn, top: float) -> float:
    """Speed from which on, up to 1.3 times it, no weights can be left behind; NaN: none below."""
    natural = capture(machine.assembly, top).natural
    below = [motion for one in natural if one.frequency < top for motion in one.motions]
    at = max((motion.release_speed for motion in below), default=0.0)
    if not 0.0 < at < top or not possible(machine, 0.99 * at):
        return math.nan
    beyond = (1.01, 1.05, 1.1, 1.15, 1.2, 1.25, 1.3)
    return math.nan if any(possible(machine, factor * at) for factor in beyond) else at


def suitable(kind: str, random: np.random.Generator) -> tuple[Drawn, float, float]:
    """A machine, its lowest natural frequency, and its release speed by the closed form."""
    while True:
        machine = draw(kind, random)
        lowest = float(modes(machine.assembly.loaded_rotor, 0.0).natural_frequencies.min())
        machine = machine.with_drag(float(np.exp(random.uniform(np.log(0.1), np.log(10.0)))))
        at = predicted(machine, 5.0 * lowest)
        if 1.4 * lowest < at < 4.0 * lowest:
            return machine, lowest, at


def measured(machine: Drawn, lowest: float, at: float, seed: int) -> float:
    """Speed of the rotor at which the last weight is let go in a slow rise."""
    random = np.random.default_rng(seed)
    count = len(machine.weights)
    start, top = 0.3 * lowest, 1.3 * at
    # alike to the last bit they would stay together for ever
    weights = [replace(w, drag=w.drag * (1.0 + APART * k)) for k, w in enumerate(machine.weights)]
    last = max(motion.frequency for motion in possible(machine, 0.99 * at))
    windows, _ = run(
        machine.rotor, weights, [(0.0, start), (SECONDS, top)], random.uniform(0, 6.28, count),
        np.full(count, start), SECONDS, WINDOWS,
    )  # fmt: skip
    behind = (windows[:, 2::3] < 0.5 * (last + windows[:, :1])).any(axis=1)
    behind &= windows[:, 0] > 1.1 * last
    return float(windows[np.flatnonzero(behind)[-1], 0]) if behind.any() else float("nan")


def study(
    machines: int, starts: int, seed: int = 43
) -> list[tuple[str, float, float, list[float]]]:
    """By machine its kind, lowest natural frequency, release speed, and ratios of every start."""
    library()
    random = np.random.default_rng(seed)
    drawn = [(k, *suitable(k, random)) for k in (KINDS[i % len(KINDS)] for i in range(machines))]
    jobs = [(m, low, at, s) for _, m, low, at in drawn for s in range(starts)]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found = list(pool.map(lambda job: measured(*job), jobs))
    ratios = np.reshape(found, (machines, starts)) / np.array([d[3] for d in drawn])[:, None]
    return [(k, low, at, r.tolist()) for (k, _, low, at), r in zip(drawn, ratios, strict=True)]


def main() -> None:
    given = [int(argument) for argument in sys.argv[1:]]
    machines, starts = [*given, *(40, 4)[len(given) :]]
    rows = study(machines, starts)
    print("| kind | release/natural | measured/closed form |\n|---|---:|---|")
    for kind, low, at, ratios in rows:
        print(f"| {kind} | {at / low:.3f} | {', '.join(f'{r:.3f}' for r in ratios)} |")
    every = np.array([r for *_, ratios in rows for r in ratios])
    seen = every[~np.isnan(every)]
    late = int((seen > LATEST).sum())
    print(f"\n{len(seen)} of {len(every)} captured; ratio {seen.min():.3f} to {seen.max():.3f}, "
          f"median {np.median(seen):.3f}; later than {LATEST}: {late}")  # fmt: skip


if __name__ == "__main__":
    main()
