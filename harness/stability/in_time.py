"""Stability seen in time: growth fitted to a run, and where a run from rest ends."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...models.linear.balanced import golden_parts
from ..errors import SimulationError
from ..master.run import cosimulate
from ..scene import Scene
from .main_motion import MainMotion

DISTURBANCE = 1e-6  # of each state's scale
LARGEST = 1e-3  # deviation beyond which the equations are no longer linear to that part
SMALLEST = 1e-10  # change per revolution that the coupling's own error may fake
SHARE = 1e-4  # of the motion in the window: what is below is noise of the fit
FEWEST = 6  # revolutions in the window
LATE = 10  # last part of a run in which it is judged: one tenth
SETTLING = 9.0  # times 1/growth rate: e^-9 leaves 1e-4 of what the main motion is missed by
TRANSIENT = 60.0  # revolutions before that: the weights find their places
LONGEST = 3000.0  # revolutions of a run: what settles later, e^-0.003 per revolution, is a boundary
FITTED_RUN = 120  # revolutions: in its first half what dies 5 % faster falls to a twentieth


def growth_in_run(motion: MainMotion, speed: float, revolutions: int = FITTED_RUN) -> float:
    """Growth rate [1/s] of a small disturbance, fitted to one run of the units.

    Costs one run whatever the number of states, and needs no derivative: for many weights and for
    units too rough for differences.  States once per revolution obey x' = A x; the part of A that
    the run shows is found by least squares (dynamic mode decomposition) over the second half, in
    which the slowest motion prevails.

    Raises:
        SimulationError: the disturbance vanished or became large within a few revolutions.
    """
    pattern, units = golden_parts(len(motion.state)), motion.units
    units.begin(motion.state + DISTURBANCE * pattern * units.scale(speed), speed)
    deviations = [motion.deviation(units.turn(speed), speed)]
    changes: list[NDArray] = []  # they obey the same map, and do not ask where the run ends
    while len(changes) < revolutions:
        deviations.append(motion.deviation(units.turn(speed), speed))
        change = deviations[-1] - deviations[-2]
        if np.abs(change).max() < SMALLEST or np.abs(deviations[-1]).max() > LARGEST:
            break
        changes.append(change)
    window = np.array(changes[len(changes) // 2 :])
    if len(window) < FEWEST:
        raise SimulationError(
            f"{units.scene.name}: at {speed:g} rad/s the disturbance has vanished or grown large "
            f"after {len(deviations)} revolutions: too few to fit a growth rate; use method cosim"
        )
    return math.log(_largest_multiplier(window)) * speed / (2.0 * math.pi)


def _largest_multiplier(window: NDArray) -> float:
    """Largest modulus among the multipliers that a sequence of states (k, d) shows."""
    before, after = window[:-1].T, window[1:].T
    length = np.linalg.norm(before, axis=0)  # every revolution counts alike
    left, values, right = np.linalg.svd(before / length, full_matrices=False)
    kept = values > SHARE * values[0]
    reduced = left[:, kept].T @ (after / length) @ right[kept].T / values[kept]
    return float(np.abs(np.linalg.eigvals(reduced)).max())


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
