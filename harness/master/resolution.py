"""Signals that vary faster than the communication steps: said loudly instead of computed wrongly.

With steps given by the scene nothing else would notice: the loop converges, and the cubics between
the communication points miss what happens there.  The cubic of the step before, taken on to the end
of this one, misses a signal 120 times as far as this step's cubic errs on average
((h + h)^2 h^2/24 over h^4/720), and 4 times as far as it errs itself on average, which is
what an explicit scheme steps on.  What such errors do to the motion is estimated here:

- a force wrong by dF for a time h pushes the rotor by dF h, which within 1/w moves it by
  dF h/(M w), to be compared with how far it moves at all;
- an acceleration wrong by da turns a weight by da h/(kappa R w), drag permitting, to be compared
  with 1 rad.

Errors are added without their signs, since a weight that turns with a signal makes a steady push
of it, and forgotten over a revolution, or as slowly as the rotor's vibrations decay where the loop
between force and acceleration is strong, or where steps turn the slowest vibration by more than
half a radian.  The larger of the two sums is the estimated error.  A signal that is not resolved at
all makes estimates meaningless: such steps are counted.
"""

from __future__ import annotations

import math

import numpy as np

from ...models.constants import (
    MISS_PER_ERROR,
    PERSISTENT_STEPS,
    REFUSED_ERROR,
    SIGNAL_NOISE,
    UNFOLLOWED_TURN,
    UNRESOLVED_ERROR,
    WEAK_LOOP,
)
from ...models.rotor import LinearRotor
from ...models.weights import Weights
from ..errors import SimulationError
from ..scene import Scene
from .system import System

LOST_PREDICTION = MISS_PER_ERROR * UNRESOLVED_ERROR  # of a signal's largest value: then it is lost
_TURN = 2.0 * math.pi


class Resolution:
    """Watches the cubic signals of a run whose steps are given.

    Args:
        scene: what the errors move, and how far it moves.
        system: the coupled units.
        miss_per_error: of the scheme.
        gain: of the loop: a force in place of added mass pushes a rotor that much lighter.

    Attributes:
        estimate: largest estimated error so far, relative to the motion.
        unresolved: steps with a signal that the cubics do not follow.
        strict: whether what is wrong is refused; else it is only noted in `refused`.
    """

    strict = True
    refused = False

    def __init__(
        self, scene: Scene, system: System, miss_per_error: float, gain: float = 0.0
    ) -> None:
        self._miss_per_error, self._answered = miss_per_error, 1.0 + gain
        assembly, profile, start = scene.assembly(), scene.profile(), scene.run.initial
        rotor = assembly.loaded_rotor
        self._speed = profile.top
        # a push moves the rotor for 1/pace: stiff supports turn it back before the rotor turns
        soft = min(_slowest(rotor.mass, k) for k in (rotor.stiffness_x, rotor.stiffness_y))
        self._pace = max(self._speed, soft)
        self._mass = float(rotor.mass.sum())
        self._decay, self._strong = _slowest_decay(rotor, self._speed), gain > WEAK_LOOP
        pull = (assembly.capacity + assembly.largest_unbalance) * self._speed**2
        out = math.hypot(start.x, start.y) + math.hypot(start.vx, start.vy) / self._pace
        self._reach = pull / (self._mass * self._pace**2) + out  # m: how far the rotor moves
        self._system, self._force_names = system, system.force_names[: len(system.exchanges)]
        count = len(system.acceleration_names)
        # by plane: its acceleration drawn back once [m/s] and twice [m], as supports do, its errors
        # over the steps of the last revolution [m/s2], and what they turn a weight by
        self._velocity, self._place = np.zeros(count, complex), np.zeros(count, complex)
        self._swung = np.zeros(count)
        turned = [_turned(scene, system, plane, self._speed) for plane in range(count)]
        self._turned = np.array(turned)
        least = SIGNAL_NOISE * assembly.capacity * self._speed**2
        for signals, smallest in (
            (system.forces, least),
            (system.accelerations, least / self._mass),
        ):
            signals.largest = np.maximum(smallest, np.abs(signals.now[:, 0]))
        self._pushed, self._step, self._blind = 0.0, 0.0, True
        self.estimate, self.unresolved = 0.0, 0

    def check(self, time: float, step: float) -> None:
        """Look at the step just finished.

        Raises:
            SimulationError: what the signals miss moves the units about as much as all the rest, or
                signals have been unresolved for too many steps.
        """
        if step != self._step:
            self._change(step)
        forces, accelerations = self._system.forces, self._system.accelerations
        missed = float(forces.prediction_error[: len(self._force_names)].sum())
        # a first step has no past to be judged by: the second one's miss is its miss too
        times = (2.0 if self._blind else 1.0) / self._miss_per_error
        self._blind = missed == 0.0
        self._pushed = self._kept * self._pushed + times * missed
        self._velocity += self._new * (accelerations.now[:, 0] / self._pace - self._velocity)
        self._place += self._new * (self._velocity / self._pace - self._place)
        self._reach = max(self._reach, float(np.abs(self._place).max(initial=0.0)))
        self._swung = self._kept_turning * self._swung + times * accelerations.prediction_error
        turned = self._swung * self._turned * step  # rad, a weight by the errors
        worst, cause = 0.0, ""
        if turned.any():
            worst = float(turned.max())
            cause = self._system.acceleration_names[turned.argmax()]
        if self._pushed * self._moved > worst * self._reach:
            worst, cause = self._pushed * self._moved / self._reach, self._force_names[0]
        if worst > self.estimate:
            self.estimate = worst
            if worst >= REFUSED_ERROR:
                moves = f"moves the units {worst:.2g} times as far as they move at all"
                self._refuse_run(time, f"what the cubics miss of {cause} {moves}")
        for names, signals in (
            (self._system.acceleration_names, accelerations),
            (self._force_names, forces),
        ):
            errors, largest = signals.prediction_error, signals.largest
            lost = np.flatnonzero((errors > LOST_PREDICTION * largest)[: len(names)])
            if lost.size:
                self._count(time, names[lost[-1]], errors[lost[-1]] / largest[lost[-1]])
                break

    def _change(self, step: float) -> None:
        """Take over another length of the steps [s]."""
        self._step, self._blind = step, True
        # a strong loop goes on pushing a rotor that hardly damps, and steps that do not follow its
        # vibration push it in time with that
        gathers = self._strong or (self._pace > self._speed and step * self._pace > UNFOLLOWED_TURN)
        slowest = self._decay if gathers else math.inf
        self._kept = math.exp(-step * min(self._pace / _TURN, slowest))
        self._kept_turning = math.exp(-step * self._speed / _TURN)
        self._new = 1.0 - math.exp(-step * self._pace)
        # m/N: a force that lasts longer than 1/pace moves the rotor no further
        self._moved = self._answered * min(step, 1.0 / self._pace) / (self._mass * self._pace)

    def _count(self, time: float, name: str, share: float) -> None:
        self.unresolved += 1
        if self.unresolved >= PERSISTENT_STEPS:
            self._refuse_run(
                time,
                f"{name} has ended {self.unresolved} steps far from where the one before led, now "
                f"by {share:.2g} of its largest value",
            )

    def _refuse_run(self, time: float, why: str) -> None:
        self.refused = True
        if not self.strict:
            return
        raise SimulationError(
            f"coupling steps of {self._step:.3g} s are too long at t = {time:g} s: {why}; "
            "use more coupling.steps_per_rev, or a tolerance"
        )


def _slowest(mass: np.ndarray, stiffness: np.ndarray) -> float:
    """Lowest natural frequency along an axis [rad/s]."""
    squares = np.linalg.eigvals(np.linalg.solve(mass, stiffness)).real
    return math.sqrt(max(0.0, float(squares.min())))


def _slowest_decay(rotor: LinearRotor, speed: float) -> float:
    """Rate at which the rotor's longest-lived vibration decays [1/s]; 0 for one that grows."""
    return max(0.0, -float(rotor.free_rates(speed).real.max()))


def _turned(scene: Scene, system: System, plane: int, speed: float) -> float:
    """Angle [rad] by which a push of 1 m/s turns a weight on a plane until it is forgotten."""
    there = {exchange.unit.name for exchange in system.exchanges if exchange.plane == plane}
    angles = [0.0]
    for mounted in scene.assembly().balancers:
        weights = mounted.device
        if mounted.name in there and isinstance(weights, Weights):
            slowing = weights.drag / (weights.kappa * weights.mass)
            angles.append(1.0 / (weights.kappa * weights.track_radius * max(speed, slowing)))
    return max(angles)
