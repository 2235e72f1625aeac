"""SciPy on the same equations, in three ways: values at the points of its own steps, or at as many
as a record has, with a right-hand side in plain numbers; and one in arrays, as most people write.

The precision pages take the first, which is the fastest.
"""

from __future__ import annotations

import time as clock
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp

from autobalancer.harness import Scene
from autobalancer.harness.accuracy.precision.methods import SOLVERS
from autobalancer.harness.accuracy.precision.reference import right_motion, signal_ranges
from autobalancer.harness.master.recorder import recorded
from autobalancer.harness.master.schedule import end_time, step_size
from autobalancer.models.monolith import trajectory
from autobalancer.models.reference.coupled import Monolith
from autobalancer.models.reference.trajectory import Trajectory

RECORDED = 20  # points a revolution
ROUNDS = 5


class Way(NamedTuple):
    """How SciPy is asked."""

    said: str
    in_arrays: bool = False
    recorded: bool = False


WAYS = (
    Way("plain numbers"),
    Way(f"plain numbers, {RECORDED} points a revolution", recorded=True),
    Way("arrays", in_arrays=True),
)


class Solved(NamedTuple):
    """A method at a tolerance: its error and processor time [s]."""

    error: float
    seconds: float
    method: str


def solvers(scene: Scene, way: Way) -> list[Solved]:
    """Every method of the precision pages at every tolerance."""
    runs = [
        (f"{method} {rtol:g}", *_solved(scene, way, method, rtol))
        for method, tolerances in SOLVERS.items()
        for rtol in tolerances
    ]
    names = recorded(scene)
    right, _ = right_motion(scene, names, [run.time for _, run, _ in runs])  # dear: once for all
    ranges = signal_ranges(scene, right, names)

    def error(run: Trajectory) -> float:
        at = np.searchsorted(right.time, run.time)
        return max(np.abs(run.signal(n) - right.signal(n)[at]).max() / ranges[n] for n in names)

    return [Solved(error(run), seconds, said) for said, run, seconds in runs]


def _solved(scene: Scene, way: Way, method: str, rtol: float) -> tuple[Trajectory, float]:
    """The motion, and the least of its processor times [s]."""
    system = Monolith(scene.assembly(), scene.profile())
    end, start = end_time(scene), scene.run.initial.motion()
    right_hand_side = system.array_rhs if way.in_arrays else system.rhs
    count = round(end / step_size(scene, RECORDED))
    times = np.linspace(0.0, end, count + 1) if way.recorded else None
    options = {"rtol": rtol, "atol": rtol * system.scales(start)}
    seconds = []
    for _ in range(ROUNDS):
        begun = clock.process_time()
        found = solve_ivp(
            right_hand_side, (0.0, end), system.initial(start), method, times, **options
        )
        seconds.append(clock.process_time() - begun)
    return trajectory(system, found.t, found.y.T), min(seconds)
