"""How small deviations from the main motion of a scene's coupled units grow.

Main motion.  The rotor rests, and the weights turn with it where they undo its unbalance: a matter
of statics, which does not depend on the speed (`models.linear.balanced`).  The units confirm it:
one revolution leaves that state as it is.

On races with lobes the weights rest elsewhere at each speed, and the rotor whirls by what they
leave (`models.linear.on_race`): after one revolution the state is the same as before it.  There no
direction is neutral.

Neutral directions.  Weights act on the rotor through their static moment alone.  Turns that change
the moment of no station (N - 2 for N >= 3 weights in a plane) meet no reaction, lead to another
main motion and have multiplier 1 by structure.  The map is taken modulo them, so that no multiplier
has to be judged by its distance from 1.  A revolution of the units confirms that it does not change
these turns.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ...models.linear.balanced import (
    CannotBalance,
    WeightTable,
    balanced_angles,
    moment_slopes,
)
from ...models.linear.growth import Growth, eigenvalues_with_errors, largest
from ...models.linear.on_race import has_lobes, main_motion
from ..errors import SimulationError
from ..master.closing import Closing
from ..scene import Scene
from .crossings import Measured
from .revolution import PERTURBATION, RANK, TIGHT, Matrix, Revolution, Vector, derivative

Outcome = TypeVar("Outcome")

AT_REST = 1e-6  # of each state's scale: what a revolution may move a main motion
NEUTRAL_RETURN = 1e-5  # what a revolution may change a neutral turn; differences and steps err less
MOST_REFINED = 32  # times the given steps per revolution
# times its error, that decide by three numbers of steps or by two, which can agree by chance
DECIDED, CLEARLY_DECIDED = 2.0, 30.0
MAP_ROUNDING = 3e-14  # of a state's scale, after a revolution in the given steps; more in more
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


class NoMainMotion(SimulationError):
    """The weights cannot undo the unbalance, or the rotor cannot rest."""


class MainMotion(Closing):
    """Multipliers and growth about the main motion, measured on the coupled units at any speed.

    Args:
        scene: of three and more weights the balanced position next to its angles is judged.
        separate: as of `Revolution`.

    Attributes:
        state: (n,) states of the units in the main motion; with lobes at the last speed asked for.
        neutral: (n, m) turns of the weights with multiplier 1 by structure.

    Raises:
        NoMainMotion: the weights cannot balance, or the units do not rest where they do.
        SceneError: gravity swings the weights.
    """

    def __init__(self, scene: Scene, *, separate: bool = False) -> None:
        scene.refuse_unrest("a main motion")
        if scene.assembly().rings:
            scene.refuse_lobes("main motions beside a ring of liquid are those")
        self.units = Revolution(scene, separate=separate)
        try:
            self._accuracy = SEPARATE if self.units.is_separate else IN_ONE_FILE
            if any(balancer.can_meet for balancer in scene.balancer):
                self._accuracy = replace(self._accuracy, moved=MOVED_BESIDE_OTHERS)
            self._speed = abs(scene.profile().end)  # any will do for what follows
            states = enumerate(self.units.states)
            self._angles = [i for i, s in states if s.start.startswith("weight[") and not s.is_rate]
            self._on_lobes = has_lobes(scene.assembly())
            self._rests_at: dict[float, Vector] = {}  # by speed, where weights rest on lobes
            self.state = self._on_race(self._speed) if self._on_lobes else self._balanced()
            self._rests_at.clear()  # speeds are followed from the first that is asked for
            self._rows, self._columns, self.neutral = self._split()
            self._refuse_false_neutral()
        except BaseException:
            self.units.close()
            raise

    def _balanced(self) -> Vector:
        """Rotor at rest, every weight at rest in the rotor where they undo its unbalance."""
        rest, scene = np.zeros(len(self.units.states)), self.units.scene
        if not self._angles:
            return rest  # a linear rotor: deviations grow alike from any motion
        try:
            rest[self._angles] = balanced_angles(scene.assembly())
        except (CannotBalance, ArithmeticError) as error:
            raise NoMainMotion(f"{scene.label}: {error}") from error
        if not self._rests(rest, self._speed):
            raise NoMainMotion(
                f"{scene.label}: the rotor does not rest over one revolution at "
                f"{self._speed:g} rad/s with its weights at the balanced angles"
            )
        return rest

    def _on_race(self, speed: float) -> Vector:
        """The rotor whirls by what weights at rest on races with lobes leave.

        Raises:
            NoMainMotion: no rest was found, or the units do not stay there.
        """
        scene, known = self.units.scene, self._rests_at
        near = known[min(known, key=lambda other: abs(other - speed))] if known else None
        try:
            machine, angles = main_motion(scene.assembly().at_speed(speed), speed, near)
        except (ValueError, ArithmeticError) as error:
            raise NoMainMotion(f"{scene.label}: {error}") from error
        whirl = machine.whirl(angles) * np.exp(1j * scene.run.initial.angle)
        rate = 1j * speed * whirl
        state = np.zeros(len(self.units.states))
        state[: 4 * len(whirl)] = np.concatenate([whirl.real, whirl.imag, rate.real, rate.imag])
        state[self._angles] = angles
        if speed not in known and not self._rests(state, speed):
            raise NoMainMotion(
                f"{scene.label}: the motion at rest on the races does not come back after a "
                f"revolution at {speed:g} rad/s"
            )
        known[speed] = angles
        return state

    def _rests(self, state: Vector, speed: float) -> bool:
        """Whether a revolution leaves a state as it is."""
        end = self._resolved(lambda: self.units(state[None], speed)[0])
        moved = (end - state) / self.units.scale(speed)
        return bool(np.abs(moved).max() <= AT_REST)

    def _split(self) -> tuple[Matrix, Matrix, Matrix]:
        """Coordinates L (d, n) that neutral turns do not change, a right inverse (n, d), and them.

        L keeps every state but the angles; of those it keeps what the stations' moments see.
        """
        count = len(self.units.states)
        if self._on_lobes or not self._angles:
            return np.eye(count), np.eye(count), np.zeros((count, 0))
        assembly = self.units.scene.assembly()
        table = WeightTable.of(assembly)
        moments = moment_slopes(assembly, table, self.state[self._angles])
        size = np.linalg.norm(moments, axis=0)  # light and heavy weights alike
        size[size == 0.0] = 1.0
        _, values, seen = np.linalg.svd(moments / size)
        rank = int((values > RANK * values.max(initial=0.0)).sum())
        kept = np.delete(np.eye(count), self._angles, axis=0)
        rows = np.vstack([kept, np.zeros((rank, count))])
        columns = rows.T.copy()
        rows[len(kept) :, self._angles] = seen[:rank] * size
        columns[self._angles, len(kept) :] = (seen[:rank] / size).T
        neutral = np.zeros((count, len(seen) - rank))
        neutral[self._angles] = (seen[rank:] / size).T
        return rows, columns, neutral / np.abs(neutral).max(axis=0)

    def _map(
        self, columns: Matrix, speed: float, moved: float = PERTURBATION, order: int = 2
    ) -> Matrix:
        """Derivative of the one-revolution map along given directions, in the states' scales.

        `moved` and `order` are those of `derivative`.
        """
        if self._on_lobes:
            self.state = self._on_race(speed)
        scale = self.units.scale(speed)[:, None]
        turned = derivative(
            lambda s: self.units(s, speed), self.state, columns * scale, scale[:, 0], moved, order
        )
        return turned / scale

    def _resolved(self, measure: Callable[[], Outcome]) -> Outcome:
        """What `measure` gives; separate FMUs halve steps that they refuse as too long.

        Far below the natural frequencies, or under heavy drag, a given number of steps per
        revolution does not resolve what the units do.
        """
        given = self.units.steps
        try:
            while True:
                try:
                    return measure()
                except SimulationError:
                    if not self.units.is_separate or self.units.steps >= MOST_REFINED * given:
                        raise
                    self.units.steps *= 2
        finally:
            self.units.steps = given

    def _refuse_false_neutral(self) -> None:
        """What is taken for neutral must come back unchanged."""
        if not self.neutral.shape[1]:
            return
        ends = self._resolved(lambda: self._map(self.neutral, self._speed))
        error = np.abs(ends - self.neutral).max()
        if not error <= NEUTRAL_RETURN:
            raise SimulationError(
                f"{self.units.scene.label}: weights that turn without a change of their moment "
                f"should stay turned, but change by {error:.2g} of the turn in one revolution at "
                f"{self._speed:g} rad/s: a unit acts by more than its static moment, or the "
                "coupling is too coarse: use more coupling.steps_per_rev"
            )

    def multipliers(self, speed: float) -> NDArray[np.complex128]:
        """Multipliers of one revolution but the neutral ones, largest modulus first."""
        reduced = self._rows @ self._resolved(lambda: self._map(self._columns, speed))
        values = np.linalg.eigvals(reduced).astype(complex)
        return values[np.argsort(-np.abs(values), kind="stable")]

    def growth(self, speed: float) -> float:
        """Largest growth rate [1/s] of a small deviation; negative means stable."""
        largest = float(np.abs(self.multipliers(speed)[0]))
        # what dies within a revolution underflows to 0: as fast as a double can tell
        return math.log(max(largest, sys.float_info.min)) * speed / (2.0 * math.pi)

    def find_growth(self, speed: float) -> Measured:
        """Largest growth rate with its error, in steps fine enough to decide its sign.

        The error is what the last halving of the steps changed, or an eighth of what the one before
        did, for two numbers of steps can agree by chance; and rounding.  Steps are halved until the
        rate exceeds it, or until the rest is rounding.  A machine in one piece has steps of its
        own: every other time it has another tolerance instead.

        Raises:
            SimulationError: the units refuse the finest steps too.
        """
        given, best = self.units.steps, None
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
        given, self.units.steps = self.units.steps, steps
        # another distance and tolerance for every other number of steps: what they change belongs
        # to the error
        is_other = round(math.log2(steps / given)) % 2 == 0
        moved = self._accuracy.moved * (OTHER_DISTANCE if is_other else 1.0)
        self.units.tolerance = TIGHT * (OTHER_TOLERANCE if is_other else 1.0)
        try:
            reduced = self._rows @ self._map(self._columns, speed, moved, self._accuracy.order)
        finally:
            self.units.steps, self.units.tolerance = given, TIGHT
        noise = MAP_ROUNDING * max(1.0, steps / given) / moved / sys.float_info.epsilon
        values, errors = eigenvalues_with_errors(reduced[None], roundings=noise)
        sizes = np.maximum(np.abs(values), sys.float_info.min)
        found = largest(np.log(sizes), np.minimum(errors / sizes, 1.0))
        rate, rounding = (float(each[0]) * speed / math.tau for each in found)
        return rate, rounding

    def close(self) -> None:
        """Free the units."""
        self.units.close()


def _change(rates: Sequence[float]) -> float:
    """Error of the last of rates, of which each is by twice as many steps as the one before."""
    if len(rates) < 2:
        return math.inf
    change = abs(rates[-1] - rates[-2])
    before = abs(rates[-2] - rates[-3]) / LEAST_SHRINKING if len(rates) > 2 else 0.0
    return max(change, before)
