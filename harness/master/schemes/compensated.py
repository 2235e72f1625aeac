"""Compensated: one pass and no rollback; what a step missed is made good in the next one.

The rotor steps on extrapolated forces and the balancers on its answer, as with Gauss-Seidel.  Their
forces differ from those assumed; the loop's Jacobian, measured at the start, tells from this which
forces and accelerations would have agreed.  These go on as the signals' ends, and what each unit
was not told is added to its signal of the next step (Benedikt et al. 2013, NEPCE, with the
interface Jacobian of Sicklinger et al. 2014): a cubic that leaves the end of that step alone and
gives a free mass the velocity and the way it missed.

Order: 4, with cubic signals only.
Stability: any loop gain but 1 in short steps, since the Jacobian takes the loop out of the error.
What is made good is right for a free mass: a mode that turns by more than about a radian a step, or
drag that changes the loop, leaves part of the error, and a gain above 1 multiplies what is left.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np

from ..loop import QuasiNewton, rescaled
from ..signals import Cubic, Knot, end_of, hermite, joined, predicted
from ..system import System
from .explicit import Explicit

# exact to degree 23, so for turns of radians
_POINTS, _SHARES = np.polynomial.legendre.leggauss(12)
_NODES, _SHARES = 0.5 + 0.5 * _POINTS, 0.5 * _SHARES


class Compensated(Explicit):
    """Explicit scheme that carries its errors on.

    Args:
        jacobian: of the loop at the start, from `loop.consistent_start` with `step` [s].
        response: of the rotor's accelerations to forces, from `loop.rotor_response` with `step`.
        speed: of the rotor [rad/s] at a time [s]; the signals' axes turn with it.
    """

    name = "compensated"
    startup_halvings = 2  # what the first part misses is then below what a full step misses later

    def __init__(
        self,
        jacobian: np.ndarray,
        response: np.ndarray,
        step: float,
        speed: Callable[[float], float],
    ) -> None:
        super().__init__()
        inverse = QuasiNewton(jacobian, step).inverse
        self._solution, self._solved_step = np.vstack([inverse, response @ inverse]), step
        # value, and slope times step: of forces, and of forces followed by accelerations
        self._gaps = np.zeros((len(self._solution.T) // 4, 2), complex)
        self._found = np.zeros((len(self._solution) // 4, 2), complex)
        self._gap_parts, self._found_parts = (
            pairs.reshape(-1).view(float) for pairs in (self._gaps, self._found)
        )
        self._speed = speed
        self._missed: list[list[complex]] = []  # pairs as found
        self._missed_step = 0.0

    @classmethod
    def amplification(cls, eigenvalues: Sequence[complex], order: int) -> float:
        """Largest factor by which a short step repeats a disturbance: the loop is solved."""
        return 0.0

    def advance(self, system: System, time: float, step: float, jump: bool = False) -> None:
        """One step; what was missed before a jump of the drive says nothing after it."""
        if jump:
            self._missed = []
        missed, past = self._missed, self._missed_step
        sent = assumed = predicted(system.forces, 3)
        if missed:
            rows = carried(self._speed(time) * past, past, step)
            sent = _made_good(assumed, missed[: len(assumed)], rows)
        felt = system.rotor_pass(sent, time, step)
        motion = [
            hermite(state.now, end, step)
            for state, end in zip(system.accelerations, felt, strict=True)
        ]
        if missed:
            motion = _made_good(motion, missed[len(assumed) :], carried(0.0, past, step))
        answers = system.balancer_pass(motion, time, step)
        ends = [end_of(cubic, step) for cubic in assumed]
        self.detect_divergence(system, ends, answers, time, step)

        missed = self._solve(ends, answers, step)
        right = [
            (value + v, slope + w / step)
            for (value, slope), (v, w) in zip(ends + felt, missed, strict=True)
        ]
        self._missed, self._missed_step = ([] if jump else missed), step
        system.accept(
            joined(system.accelerations, right[len(ends) :], step),
            joined(system.forces, right[: len(ends)], step),
            time,
            step,
        )

    def _solve(
        self, assumed: Sequence[Knot], answers: Sequence[Knot], step: float
    ) -> list[list[complex]]:
        """Forces and accelerations that would have agreed, less those assumed and answered."""
        if step != self._solved_step:
            self._solution = rescaled(self._solution, step / self._solved_step)
            self._solved_step = step
        gaps = self._gaps
        for k, ((f, d), (g, e)) in enumerate(zip(answers, assumed, strict=True)):
            gaps[k] = f - g, (d - e) * step
        self._solution.dot(self._gap_parts, self._found_parts)
        return self._found.tolist()


def _made_good(
    signals: Sequence[Cubic], missed: Sequence[Sequence[complex]], rows: Sequence[Knot]
) -> list[Cubic]:
    """Signals over the step with what was missed in the past one added, `carried` on."""
    (a, b), (c, d), (e, f), (g, h) = rows
    return [
        (
            s0 + a * value + b * slope,
            s1 + c * value + d * slope,
            s2 + e * value + f * slope,
            s3 + g * value + h * slope,
        )
        for (s0, s1, s2, s3), (value, slope) in zip(signals, missed, strict=True)
    ]


@lru_cache(maxsize=64)
def carried(turn: float, past: float, step: float) -> tuple[Knot, ...]:
    """Cubic over a step that gives a free mass what it missed in the step before.

    Missed was the cubic that starts from nothing and ends with a value and a slope; the one found
    ends in nothing, and both leave the mass with the same velocity in the same place.

    Args:
        turn: of the signals' axes in the past step [rad].
        past, step: lengths of the past step and of this one [s].

    Returns:
        (4, 2): value and derivatives of order 1 to 3 at the start of the step, per missed value and
        per missed slope times `past`.
    """
    s = _NODES
    rising = np.array([s * s * (3.0 - 2.0 * s), s * s * (s - 1.0)])
    falling = np.array([1.0 - rising[0], s * (s - 1.0) ** 2])
    ratio = step / past
    # impulse, and its moment about the end of this step, in axes of the start of the past one
    before = _SHARES * np.exp(1j * turn * s)
    after = _SHARES * ratio * np.exp(1j * turn * (1.0 + ratio * s))
    missed = np.array([rising @ before, rising @ (before * (1.0 - s + ratio))])
    given = np.array([falling @ after, falling @ (after * ratio * (1.0 - s))])
    start = np.linalg.solve(given, missed)  # value, and slope times step
    shape = np.array([[1.0, 0.0], [0.0, 1.0], [-6.0, -4.0], [12.0, 6.0]])
    orders = shape @ start / step ** np.arange(4)[:, None]
    return tuple((value, slope) for value, slope in orders.tolist())
