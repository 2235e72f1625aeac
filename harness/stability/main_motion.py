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
from collections.abc import Callable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ...models.linear.balanced import CannotBalance, balanced_angles
from ...models.linear.on_race import has_lobes, main_motion
from ...models.linear.weight_table import WeightTable, moment_slopes
from ..errors import SimulationError
from ..master.closing import Closing
from ..scene import Scene
from .revolution import PERTURBATION, RANK, Matrix, Revolution, Vector, derivative

Outcome = TypeVar("Outcome")

AT_REST = 1e-6  # of each state's scale: what a revolution may move a main motion
NEUTRAL_RETURN = 1e-5  # what a revolution may change a neutral turn; differences and steps err less
MOST_REFINED = 32  # times the given steps per revolution


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

    def reduced_map(self, speed: float, moved: float = PERTURBATION, order: int = 2) -> Matrix:
        """Derivative of the one-revolution map modulo the neutral turns, in the states' scales.

        `moved` and `order` are those of `derivative`.
        """
        return self._rows @ self._map(self._columns, speed, moved, order)

    def _map(
        self, columns: Matrix, speed: float, moved: float = PERTURBATION, order: int = 2
    ) -> Matrix:
        """Derivative of the one-revolution map along given directions, in the states' scales."""
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
        reduced = self._resolved(lambda: self.reduced_map(speed))
        values = np.linalg.eigvals(reduced).astype(complex)
        return values[np.argsort(-np.abs(values), kind="stable")]

    def growth(self, speed: float) -> float:
        """Largest growth rate [1/s] of a small deviation; negative means stable."""
        largest = float(np.abs(self.multipliers(speed)[0]))
        # what dies within a revolution underflows to 0: as fast as a double can tell
        return math.log(max(largest, sys.float_info.min)) * speed / (2.0 * math.pi)

    def close(self) -> None:
        """Free the units."""
        self.units.close()
