"""SciPy on the same equations with a right-hand side in arrays, as most people write it.

The precision pages take the one in plain numbers, which a planar rotor alone has.
"""

from __future__ import annotations

import time as clock

import numpy as np
from scipy.integrate import solve_ivp

from autobalancer.harness import Scene
from autobalancer.harness.master.recorder import recorded
from autobalancer.harness.master.schedule import end_time
from autobalancer.harness.precision.methods import SOLVERS
from autobalancer.harness.precision.reference import right_motion, signal_ranges
from autobalancer.models.monolith import trajectory
from autobalancer.models.reference.coupled import Monolith

ROUNDS = 3


def solvers(scene: Scene) -> list[tuple[float, float, str]]:
    """Error, processor time [s] and name of every method and tolerance."""
    return [
        (*_measured(scene, method, rtol), f"{method}, tolerance {rtol:g}")
        for method, tolerances in SOLVERS.items()
        for rtol in tolerances
    ]


def _measured(scene: Scene, method: str, rtol: float) -> tuple[float, float]:
    system, names = Monolith(scene.assembly(), scene.profile()), recorded(scene)
    start = scene.run.initial.motion()
    state, tolerance = system.initial(start), rtol * system.scales(start)
    seconds = []
    for _ in range(ROUNDS):
        begun = clock.process_time()
        solved = solve_ivp(
            system.array_rhs, (0.0, end_time(scene)), state, method, rtol=rtol, atol=tolerance
        )
        seconds.append(clock.process_time() - begun)
    found = trajectory(system, solved.t, solved.y.T)
    right, _ = right_motion(scene, names, [solved.t])
    ranges = signal_ranges(scene, right, names)
    gaps = [np.abs(found.signal(n) - right.signal(n)).max() / ranges[n] for n in names]
    return float(max(gaps)), min(seconds)
