"""Compensated: one pass and no rollback; what a step missed is made good in the next one.

The rotor steps on extrapolated forces and the balancers on its answer, as with Gauss-Seidel.  Their
forces differ from those assumed; the loop's Jacobian, measured at the start, gives the forces and
accelerations that would have agreed.  These go on as the signals' ends, and what a unit's signal
lacked is added to its signal of the next step (Benedikt et al. 2013, NEPCE, with the interface
Jacobian of Sicklinger et al. 2014): a cubic that leaves the end of that step alone and gives a free
mass the velocity and the way it missed.

Order: 4.
Stability: any loop gain but 1 in short steps, since the Jacobian takes the loop out of the error.
What is made good is right for a free mass: a mode that turns by more than about a radian a step, or
drag that changes the loop, leaves part of the error, and a gain above 1 multiplies what is left.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from ..loop import QuasiNewton, pack, rescaled, unpack
from ..signals import Cubics, Knots, end_of, interpolated
from ..system import System
from .explicit import Scheme

# integrals over a step, exact to degree 23, so for turns of radians
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(12)
_NODES, _WEIGHTS = 0.5 + 0.5 * _POINTS, 0.5 * _WEIGHTS
# cubics over a step of 1 that rise from nothing to a value or a slope, and that fall from them
_NOTHING, _ONES = np.zeros((2, 2), complex), np.eye(2, dtype=complex)
_RISING = interpolated(_NOTHING, _ONES, 1.0).real.T
_FALLING = interpolated(_ONES, _NOTHING, 1.0).real.T
_POWERS = _NODES ** np.arange(4)[:, None] / np.array([1.0, 1.0, 2.0, 6.0])[:, None]


class Compensated(Scheme):
    """Explicit scheme that carries its errors on.

    Args:
        jacobian: of the loop at the start, from `loop.consistent_start` with `step` [s].
        response: of the rotor's accelerations to forces, from there as well.
        speed: of the rotor [rad/s] at a time [s]; the signals' axes turn with it.
    """

    startup_halvings = 2  # what the first part misses is then below what a full step misses later

    def __init__(
        self,
        jacobian: np.ndarray,
        response: np.ndarray,
        step: float,
        speed: Callable[[float], float],
    ) -> None:
        inverse = QuasiNewton(jacobian, step).inverse
        self._solution, self._solved_step = np.vstack([inverse, response @ inverse]), step
        self._speed = speed
        self._missed: Knots | None = None  # value, and slope times the step, of the step before

    def step(self, system: System, time: float, step: float, jump: bool = False) -> float:
        """One step; what was missed before a jump of the drive says nothing after it."""
        count, past = len(system.force_names), system.forces.last_step
        assumed, missed = system.forces.predicted(3), self._missed
        if jump or not past or missed is None:
            missed = np.zeros((count + len(system.accelerations.now), 2), complex)
        given = _added(assumed, missed[:count], self._speed(time) * past, past, step)
        motion = system.rotor_pass(given, time, step)
        accelerations = system.accelerations.to(motion, step)
        given = _added(accelerations, missed[count:], 0.0, past, step)
        answers = system.balancer_pass(given, time, step)
        if step != self._solved_step:
            self._solution = rescaled(self._solution, step / self._solved_step)
            self._solved_step = step
        gap = pack(answers, step) - pack(end_of(assumed, step), step)
        found = (self._solution @ gap.view(float)).view(complex)
        self._missed = found.reshape(-1, 2)
        more = unpack(found, step)
        forces, motion = end_of(assumed, step) + more[:count], motion + more[count:]
        system.accept(motion, forces, time, step)
        return 0.0


def _added(cubics: Cubics, missed: Knots, turn: float, past: float, step: float) -> Cubics:
    """Signals with what they missed in the past step, which `carried` makes good."""
    return cubics + missed @ carried(turn, past, step).T if past else cubics


@lru_cache(maxsize=64)
def carried(turn: float, past: float, step: float) -> np.ndarray:
    """Cubic over a step that gives a free mass what it missed in the step before.

    Missed was the cubic that starts from nothing and ends with value and slope; the one found ends
    in nothing.  Both leave the mass with the same velocity in the same place.

    Args:
        turn: of the signals' axes in the past step [rad].
        past, step: lengths of the past step and of this one [s].

    Returns:
        (4, 2): value and derivatives at the start of the step, per missed value and per missed
        slope times `past`.
    """
    ratio, moments = step / past, np.arange(2)[:, None]
    # impulse and its moment about the end of this step, in axes of the start of the past one
    before = _WEIGHTS * np.exp(1j * turn * _NODES) * (1.0 - _NODES + ratio) ** moments
    after = _WEIGHTS * ratio * np.exp(1j * turn * (1.0 + ratio * _NODES))
    after = after * (ratio * (1.0 - _NODES)) ** moments
    missed, given = before @ (_RISING.T @ _POWERS).T, after @ (_FALLING.T @ _POWERS).T
    return _FALLING @ np.linalg.solve(given, missed) / step ** np.arange(4)[:, None]
