"""A tolerance that is kept: the error of a whole run, from runs that meet at common points.

The error of a step says little about the error at the end: lightly damped motion gathers errors,
unstable motion multiplies them.  So the run is done twice.  The first run has few steps, in C
chosen by their errors; the second divides each of them in two, and is the result.  At common points
the two differ by 2^p - 1 times the error of the second, where p is the order, 4.  It is 1 where
weights can collide, where a jump falls within a step, and after steps at rest that hold their
signals.  It is 2 at most where weights or supports stick or slide, or a motor meets a corner of its
characteristic, at the end of a step.  Two runs state their error by one order less, under a motor
by two; three runs by the order that they show, or as two do if that is higher than p.  Under a
motor, and with separate FMUs, all state it by order 1 where steps do not follow the rotor's fastest
vibration.  If the error exceeds the tolerance, every step is divided again, into as many parts as
it takes.

Hairer, Norsett & Wanner 1993, II.4: Richardson's extrapolation, here of the run as a whole.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...models.constants import BEYOND_LONGEST_STEP, FEWEST_CHOSEN
from ..errors import SimulationError
from ..scene import Scene
from .names import kin, stations
from .plan import MOTOR
from .recorder import Recorder, Signal
from .scales import least_motion
from .schedule import SLIVER, step_size
from .simulation import Repeated, Simulation

if TYPE_CHECKING:
    from ..output.workers import Progress

ORDER = 4  # of the coupling by cubic signals
# forces or accelerations that jump within a step: three runs may show more by chance; motion with
# collisions, met ones too, is no smooth function of the steps' errors
ORDER_OF_JUMPS = 1
# steps end where something sticks or a motor's slope jumps: the error in the time of a nearly
# missed event is the root of the error of the signals
ORDER_OF_EVENTS = 2
ORDER_HELD = 1  # and all that follows
LEFT = 2  # power of the parts with which what is left in the loop shrinks at least
# of that, under a motor, whose acceleration can be far the largest of the forces, and where weights
# collide: impacts amplify what is left, and by chance two runs can then agree
LEFT_OF_JUMPS = 0.01
ATTEMPTS = 3  # at a first run, each in finer steps
# of the tolerance: what further parts are to leave, and two runs may say, for they do not tell by
# which order errors shrink; if by 1.3 already, the tolerance is still kept within a factor of 3
AIM = 0.3
# by so much lower is the order by which two runs state their error: by the full order 6 of 328 runs
# of the truth study erred by 3 to 6.6 times what they stated; under a motor by more: it starts in
# a few steps that are too long for their order to show
CAUTION, MOTOR_CAUTION = 1, 2
# rad by which a step of the finer run may turn the rotor's fastest vibration: longer ones do not
# follow it.  Under a motor, whose speed vibrates too, 6 of 400 runs erred by 3 to 12 times what
# they stated; separate FMUs do not estimate what signals miss within a step
FOLLOWED = 1.5
MOST_TIMES = 4  # as many parts as in the run before, which is to be confirmed
MOST_STEP_PARTS = 128  # of a step of the first run
PARTING = 32  # parts that should be enough to see runs come together
ASYMPTOTIC = 0.03  # of the motion: runs that differ by more need not differ by their order


class Controlled:
    """The runs of one scene, each finer than the one before, until the tolerance is kept.

    Args:
        cosim: to be run, with a tolerance.
        names: what is recorded.
        uncompared: recorded besides, and left out of the error.

    Attributes:
        error: estimated, the largest of all signals, over the largest value of each; of x and y,
            and of the parts of a vector in the rotor, over the larger; of an angle in rad.
        parts: of each step of the first run.
    """

    def __init__(
        self, cosim: Simulation, names: Sequence[str], uncompared: Sequence[str] = ()
    ) -> None:
        assert cosim.scene.coupling.tolerance is not None
        self.cosim, self.names, self.uncompared = cosim, names, uncompared
        self.tolerance = cosim.scene.coupling.tolerance
        touching = any(balancer.can_meet for balancer in cosim.scene.balancer)
        motor = cosim.scene.operation.motor
        bent = motor is not None and len(motor.table or ()) > 2
        jumping = touching or (cosim.scene.has_events and not cosim.meets_events)
        self._ends_at_events = cosim.scene.has_events or bent
        self._left = LEFT_OF_JUMPS if motor or touching else 1.0
        self._caution = MOTOR_CAUTION if motor else CAUTION
        self.highest_order = ORDER_OF_JUMPS if jumping else ORDER
        follows = motor or not cosim.estimates_errors
        self._fastest = _fastest(cosim.scene) if follows else 0.0  # rad/s
        self._longest = 0.0  # step of the first run [s]
        self._steepest = max(self.highest_order, ORDER_OF_EVENTS) if bent else math.inf
        self.order: float = self.highest_order
        self.parts, self.error = 1, math.inf
        self._judged = math.inf  # the error by the order that is expected
        self._largest_difference = self._times = (
            0.0  # how far the last two runs were, and by how many parts
        )
        self._done = 0  # work, in first runs
        self._attempt = 0

    def run(self, progress: Progress | None) -> Recorder:
        """Run as often as it takes; what the last run recorded.

        Raises:
            SimulationError: as `CoSimulation.run`.
        """
        recorder = self._first(progress)
        grid, signals = recorder.columns()
        signals = {name: each for name, each in signals.items() if name not in self.uncompared}
        held = _first_held(self.cosim.scene, grid)
        self._longest = float(np.diff(grid).max())
        least = least_motion(self.cosim.scene)
        scale = {name: least.get(unit, 0.0) for name, unit in recorder.signal_units.items()}
        parts = 1
        while True:
            parts = max(2 * parts, self._next_parts())
            try:
                recorder = self._run(parts, grid, progress)
            except SimulationError:  # steps that the tolerance allowed are too long for the loop
                if parts >= PARTING:
                    raise
                continue
            points, finer = recorder.columns()
            at = np.searchsorted(points, grid * (1.0 - SLIVER))
            finer = {name: finer[name][at] for name in signals}
            apart = _largest_difference(signals, finer, scale, slice(held))
            at_rest = _largest_difference(signals, finer, scale, slice(held, None))
            far, signals = max(apart, at_rest) >= ASYMPTOTIC, finer
            # of motions that part no run says more than the one before
            if self._keeps_tolerance(apart, at_rest, parts) or parts >= (
                PARTING if far else MOST_STEP_PARTS
            ):
                return recorder

    def _keeps_tolerance(self, apart: float, at_rest: float, parts: int) -> bool:
        """Whether a run keeps the tolerance so far `apart` from the one before, and `at_rest`."""
        times = parts / self.parts
        order, stated, enough = self._orders(apart, parts)
        # where a corner lies in its step, two runs can agree by chance
        least = self._judged / times**self._steepest if self._largest_difference else 0.0
        self._judged = self.error = max(apart, at_rest)
        if self.error < ASYMPTOTIC:
            rested = at_rest / (times**ORDER_HELD - 1.0)
            self._judged = max(apart / (times**order - 1.0), rested, least)
            self.error = max(apart / (times**stated - 1.0), rested, least)
        self.parts, self._times, self._largest_difference = parts, times, apart
        # two runs that hide a fast vibration between their points can agree by chance
        watched = self.cosim.facts().estimated_error
        kept = self._judged <= enough
        self.error, self._judged = max(self.error, watched), max(self._judged, watched)
        return kept and self.error <= self.tolerance

    def _orders(self, apart: float, parts: int) -> tuple[float, float, float]:
        """Order of the errors, the order by which they are stated, and what may be left of them."""
        highest = self.highest_order
        if highest == ORDER_OF_JUMPS:
            stated = highest
        else:
            stated = max(ORDER_OF_EVENTS, highest - self._caution)
        if self._fastest * self._longest > FOLLOWED * parts:
            return ORDER_OF_JUMPS, ORDER_OF_JUMPS, self.tolerance
        if self._largest_difference and apart:  # three runs show by which order errors shrink
            shown = math.log1p(self._largest_difference / apart) / math.log(self._times)
            self.order = min(highest, max(shown, ORDER_OF_JUMPS))
            # the first runs may show the errors of steps, and the last one those of events
            order = min(self.order, ORDER_OF_EVENTS) if self._ends_at_events else self.order
            # a higher order than there is: the errors of the first run did not shrink by order yet
            return order, min(order, stated) if shown > highest else order, self.tolerance
        if highest == ORDER_OF_JUMPS:
            return highest, stated, self.tolerance
        if self._ends_at_events:
            return ORDER_OF_EVENTS, ORDER_OF_EVENTS, AIM * self.tolerance
        return highest, stated, AIM * self.tolerance

    def _first(self, progress: Progress | None) -> Recorder:
        """The first run; where its steps are too long, in shorter ones."""
        for self._attempt in range(ATTEMPTS - 1):
            try:
                return self._run(1, None, progress)
            except SimulationError:
                continue
        self._attempt = ATTEMPTS - 1
        return self._run(1, None, progress)

    def _next_parts(self) -> int:
        """Parts of each step of the first run that should keep the tolerance."""
        if self.parts == 1:
            return 2
        wanted = self.parts * (self._judged / (AIM * self.tolerance)) ** (1.0 / self.order)
        return math.ceil(min(MOST_TIMES * self.parts, wanted))

    def _run(
        self,
        parts: int,
        grid: Signal | None,
        progress: Progress | None,
    ) -> Recorder:
        """One run, of all that is asked for and all that is compared."""
        cosim = self.cosim
        watched = [*_motion(cosim.scene), *self.uncompared]
        recorder = Recorder(cosim.units, self.names, watched)
        if grid is None:
            cosim.start(attempt=self._attempt)
        else:
            # what is left in the loop must shrink with the rest, or no run would show it
            share = self._left / parts ** max(self.highest_order, LEFT)
            cosim.start(attempt=self._attempt, again=Repeated(grid, parts, share))
        # of a first run it is certain that another follows
        done, work = self._done, max(3, self._done + parts)
        report = progress and (lambda part: progress((done + part * parts) / work))
        cosim.record(recorder, report)
        self._done += parts
        return recorder


def _motion(scene: Scene) -> list[str]:
    """Signals that together are the motion of a scene."""
    prefixes = stations(len(scene.rotor.stations))
    names = [f"rotor.{prefix}{axis}" for prefix in prefixes for axis in "xy"]
    names += [f"{MOTOR}.speed"] if scene.operation.motor else []
    return names + [f"{b.label}.{v}" for b in scene.balancer for v in b.records if v != "clearance"]


def _fastest(scene: Scene) -> float:
    """Of the rotor's vibrations without damping [rad/s]."""
    rotor = scene.assembly().loaded_rotor
    squares = (np.linalg.solve(rotor.mass, k) for k in (rotor.stiffness_x, rotor.stiffness_y))
    return math.sqrt(max(0.0, *(np.linalg.eigvals(each).real.max() for each in squares)))


def _first_held(scene: Scene, grid: Signal) -> int:
    """The first point that a step with held signals led to; the number of points if none did."""
    lengths = np.append(np.diff(grid), math.inf)
    longest = BEYOND_LONGEST_STEP * step_size(scene, FEWEST_CHOSEN)
    return int(np.argmax(lengths > longest)) + 1


def _largest_difference(
    one: Mapping[str, Signal], other: Mapping[str, Signal], least: Mapping[str, float], at: slice
) -> float:
    """Largest difference of signals at some common times, each over the largest value of its kind.

    `least` is by signal the smallest that this value is taken to be.
    """
    # the rotor's angle is exact, and a clearance what is left of a gap
    compared = [n for n in other if n != "rotor.angle" and not n.endswith(".clearance")]
    sizes = {n: max(least[n], float(np.abs(other[n]).max())) for n in compared}
    worst = 0.0
    for name in compared:
        gap = float(np.abs(other[name] - one[name])[at].max(initial=0.0))
        scale = max(sizes[related] for related in kin(name, compared))
        worst = max(worst, gap / scale if scale else gap)
    return worst
