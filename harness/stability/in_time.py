"""Stability seen in time: where a run from rest ends."""

from __future__ import annotations

import math

import numpy as np

from ..master.run import cosimulate
from ..scene import Scene

LATE = 10  # last part of a run in which it is judged: one tenth
SETTLING = 9.0  # times 1/growth rate: e^-9 leaves 1e-4 of what the main motion is missed by
TRANSIENT = 60.0  # revolutions before that: the weights find their places
LONGEST = 3000.0  # revolutions of a run: what settles later, e^-0.003 per revolution, is a boundary


def needed_revolutions(growth: float, speed: float) -> float:
    """Length of a run that shows whether a motion of this growth rate [1/s] comes to balance."""
    each = abs(growth) * 2.0 * math.pi / speed  # ln of what a revolution leaves of it
    if each * (LONGEST - TRANSIENT) <= SETTLING:
        return LONGEST
    return math.ceil(TRANSIENT + SETTLING / each)


def run_from_rest(scene: Scene, speed: float, revolutions: float) -> tuple[float, float]:
    """Run a scene at a speed, rotor at rest in the middle, weights where the scene puts them.

    Returns:
        Largest unbalance left at any station in the last tenth of the run [kg m], and that over the
        unbalance at the start, weights included.

    Raises:
        SimulationError: the run cannot be completed correctly.
    """
    scene = scene.replace({"operation.speed": speed, "run.revolutions": revolutions})
    rotor, weights = scene.assembly().rotor, scene.assembly().weights
    moments = [[f"{w.name}.moment_{axis}" for axis in ("xi", "eta")] for w in weights]
    result = cosimulate(scene, record=[name for pair in moments for name in pair])
    unbalance = np.tile(rotor.unbalance, (len(result.time), 1)).astype(complex)
    for mounted, (xi, eta) in zip(weights, moments, strict=True):
        unbalance += (result[xi] + 1j * result[eta])[:, None] * rotor.planes[mounted.plane]
    size = np.abs(unbalance).max(axis=1)
    residual = float(size[-(len(result.time) // LATE) :].max())
    return residual, residual / float(size[0])
