"""Compensated: one pass and no rollback; what a step missed is made good in the next one.

The rotor steps on extrapolated forces and the balancers on its answer, as with Gauss-Seidel.  Their
forces differ from those assumed; the loop's Jacobian, measured at the start, tells from this which
forces and accelerations would have agreed.  These go on as the signals' ends, and what each unit
was not told is added to its signal of the next step (Benedikt et al. 2013, NEPCE, with the
interface Jacobian of Sicklinger et al. 2014): a cubic, or quintic, that leaves the end of that step
alone and gives a free mass the velocity and the way it missed.

Order: 4 with cubic signals, 6 with quintic ones.
Stability: any loop gain but 1 in short steps, since the Jacobian takes the loop out of the error.
What is made good is right for a free mass: a mode that turns by more than about a radian a step, or
drag that changes the loop, leaves part of the error, and a gain above 1 multiplies what is left.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ..loop import QuasiNewton, rescaled
from ..signals import EXACT
from ..system import System
from .compensated_maps import CompensatedMaps, kept_of
from .explicit import Explicit

_MOST_MAPS = 64  # a run has a handful of step lengths
_QUINTIC_HALVINGS = 4
# of the quintic that `compensated_maps` continues: 0.0245 h^6 over 0.00484 h^6, times f^(6)
_QUINTIC_MISS_PER_ERROR = 5.06


class Compensated(Explicit):
    """Explicit scheme that carries its errors on.

    Args:
        jacobian: of the loop at the start, from `loop.consistent_start` with `step` [s].
        response: of the rotor's accelerations to forces, from `loop.rotor_response` with `step`.
        speed: of the rotor [rad/s] at a time [s]; the signals' axes turn with it.
        order: of the exchanged signals.
    """

    name = "compensated"
    startup_halvings = 2  # what the first part misses is then below what a full step misses later

    def __init__(
        self,
        jacobian: np.ndarray,
        response: np.ndarray,
        step: float,
        speed: Callable[[float], float],
        order: int = 3,
    ) -> None:
        super().__init__()
        self._parts = parts = EXACT[order] + 1
        if order == 5:
            self.miss_per_error = _QUINTIC_MISS_PER_ERROR
            self.startup_halvings = _QUINTIC_HALVINGS
        inverse = QuasiNewton(jacobian, step, parts).inverse
        self._solution, self._solved_step = np.vstack([inverse, response @ inverse]), step
        self._speed = speed
        self._maps: dict[tuple[float, float], CompensatedMaps] = {}
        self._past = 0.0  # s, length of the step before; 0 where nothing of it can be used
        forces, every = len(inverse) // (2 * parts), len(self._solution) // (2 * parts)
        self._keeps = keeps = kept_of(parts)
        sizes = np.cumsum([every * keeps, parts * (every - forces), parts * forces])
        self._numbers = np.zeros(sizes[-1], complex)
        self._kept, *answered = np.split(self._numbers, sizes[:-1])
        self._reals, self._felt, self._answers = (
            part.view(float) for part in (self._numbers, *answered)
        )
        self._found = np.zeros(every * keeps + 2 * forces, complex)
        self._found_reals = self._found.view(float)

    @classmethod
    def amplification(cls, eigenvalues: Sequence[complex], order: int) -> float:
        """Largest factor by which a short step repeats a disturbance: the loop is solved."""
        return 0.0

    def advance(self, system: System, time: float, step: float, jump: bool = False) -> None:
        """One step; what was missed before a jump of the drive says nothing after it."""
        if jump or system.has_no_past:
            self._forget(system)
        past, reals = self._past, self._reals
        maps = self._maps.get((past, step)) or self._new_maps(system, past, step, jump)
        maps.turn(self._speed(time) * past)
        maps.pushed.dot(reals, system.pushed)
        system.step_rotor(time, step)
        self._felt[:] = system.felt
        maps.told.dot(reals, system.told)
        system.step_balancers(time, step)
        self._answers[:] = system.answers
        maps.found.dot(reals, self._found_reals)

        numbers = self._found.tolist()
        count, first = len(system.forces), 0
        self.detect_divergence(system, numbers[-count:], numbers[-2 * count : -count], time, step)
        for state in (*system.forces, *system.accelerations):
            own = numbers[first : first + self._keeps]
            first += self._keeps
            cubic = (*state.now, *own[self._parts : 2 * self._parts])
            missed = abs(own[-1]) if step == past else 0.0
            state.arrive(cubic, tuple(own[: self._parts]), step, missed)
        self._kept[:] = self._found[:first]
        self._past = step
        system.accepted(time + step)

    def _forget(self, system: System) -> None:
        """Start anew from the present values and slopes."""
        self._past, self._kept[:] = 0.0, 0.0
        for kept, state in zip(
            self._kept.reshape(-1, self._keeps),
            (*system.forces, *system.accelerations),
            strict=True,
        ):
            kept[: self._parts] = state.now

    def _new_maps(self, system: System, past: float, step: float, jump: bool) -> CompensatedMaps:
        if len(self._maps) >= _MOST_MAPS:
            self._maps.clear()
        solution = rescaled(self._solution, step / self._solved_step, self._parts)
        planes = [exchange.plane for exchange in system.exchanges]
        self._maps[past, step] = maps = CompensatedMaps(
            self._parts, planes, solution, past, step, jump
        )
        return maps
