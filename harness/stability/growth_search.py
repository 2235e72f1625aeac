"""The largest growth rate about a main motion, in steps fine enough to decide its sign."""

from __future__ import annotations

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...models.linear.growth import Growth, eigenvalues_with_errors, largest
from ..errors import SimulationError
from .crossings import Measured
from .main_motion import MOST_REFINED, MainMotion
from .revolution import PERTURBATION, TIGHT

# times its error, that decide by three numbers of steps or by two, which can agree by chance
DECIDED, CLEARLY_DECIDED = 2.0, 30.0
# rounding of the map of one revolution in the given number of steps, relative to the scale of a
# state; it grows with the number of steps
MAP_ROUNDING = 3e-14
LEAST_SHRINKING = 8.0  # of a change, by half the steps: signals are of order 4
MOVED_BESIDE_OTHERS = 1e-4  # of a state's scale: weights must not touch
OTHER_DISTANCE = 0.7  # times that, with every other number of steps
OTHER_TOLERANCE = 10.0  # times that of a machine in one piece, there: its steps are its own


@dataclass(frozen=True)
class Accuracy:
    """How well a growth rate is looked for.

    Attributes:
        least, most: times the given steps per revolution.
        moved, order: as of `derivative`.
    """

    least: float
    most: float
    moved: float
    order: int


IN_ONE_FILE = Accuracy(1.0, MOST_REFINED, 1e-3, 4)
SEPARATE = Accuracy(0.5, 4.0, PERTURBATION, 2)  # they take 100 times as long


class GrowthSearch:
    """Growth rates [1/s] of small deviations from a main motion, by its coupled units."""

    def __init__(self, motion: MainMotion) -> None:
        self._motion, self._units = motion, motion.units
        self._accuracy = SEPARATE if motion.units.is_separate else IN_ONE_FILE
        if any(balancer.can_meet for balancer in motion.units.scene.balancer):
            self._accuracy = replace(self._accuracy, moved=MOVED_BESIDE_OTHERS)

    def find(self, speed: float) -> Measured:
        """Largest growth rate with its error, in steps fine enough to decide its sign.

        The error is what the last halving of the steps changed, or an eighth of what the one before
        did, for two numbers of steps can agree by chance; and rounding.  Steps are halved until the
        rate exceeds it, or until the rest is rounding.  A machine in one piece has steps of its
        own: every other time it has another tolerance instead.

        Raises:
            SimulationError: the units refuse the finest steps too.
        """
        given, best = self._units.steps, None
        rates: list[float] = []
        parts, most = self._accuracy.least, self._accuracy.most
        while parts <= (most if best else MOST_REFINED):
            steps = math.ceil(parts * given)
            parts *= 2.0
            try:
                rate, rounding = self._rate(speed, steps)
            except SimulationError:  # too long for the coupling
                if parts > MOST_REFINED:
                    raise
                rates.clear()
                continue
            rates.append(rate)
            change = _change(rates)
            found = Measured(Growth(rate, change + rounding), steps)
            if best is None or found.growth.error <= best.growth.error:
                best = found
            clear = DECIDED if len(rates) > 2 else CLEARLY_DECIDED
            if abs(rate) > clear * found.growth.error or change < rounding:
                break
        assert best is not None
        return best

    def rate(self, speed: float, steps: int) -> float:
        """Largest growth rate [1/s] by a number of steps per revolution."""
        return self._rate(speed, steps)[0]

    def _rate(self, speed: float, steps: int) -> tuple[float, float]:
        """Largest growth rate and its rounding [1/s], by a number of steps per revolution."""
        given, self._units.steps = self._units.steps, steps
        # another distance and tolerance for every other number of steps: what they change belongs
        # to the error
        is_other = round(math.log2(steps / given)) % 2 == 0
        moved = self._accuracy.moved * (OTHER_DISTANCE if is_other else 1.0)
        self._units.tolerance = TIGHT * (OTHER_TOLERANCE if is_other else 1.0)
        try:
            reduced = self._motion.reduced_map(speed, moved, self._accuracy.order)
        finally:
            self._units.steps, self._units.tolerance = given, TIGHT
        noise = MAP_ROUNDING * max(1.0, steps / given) / moved / sys.float_info.epsilon
        values, errors = eigenvalues_with_errors(reduced[None], roundings=noise)
        sizes = np.maximum(np.abs(values), sys.float_info.min)
        found = largest(np.log(sizes), np.minimum(errors / sizes, 1.0))
        rate, rounding = (float(each[0]) * speed / math.tau for each in found)
        return rate, rounding


def _change(rates: Sequence[float]) -> float:
    """Error of the last of rates, of which each is by twice as many steps as the one before."""
    if len(rates) < 2:
        return math.inf
    change = abs(rates[-1] - rates[-2])
    before = abs(rates[-2] - rates[-3]) / LEAST_SHRINKING if len(rates) > 2 else 0.0
    return max(change, before)
