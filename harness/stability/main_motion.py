"""The main motion of a scene's coupled units, and how small deviations from it grow.

Known of the units is only what their FMUs declare: start values, the acceleration of the rotor's
planes, the static moment of each balancer's weights.

Main motion.  The rotor rests, the weights turn with it where the planes' acceleration vanishes;
that position does not depend on the speed.  The search starts from the scene's angles.  Units
refuse positions in which weights of finite size overlap: with such weights it starts from the
balanced angles of the equations.

Neutral directions.  Weights act on the rotor through their static moment alone.  Turns that change
the moment of no station (N - 2 for N >= 3 weights in a plane) meet no reaction, lead to another
main motion and have multiplier 1 by structure.  They are the kernel of the measured derivative of
moments by angles: the map is taken modulo them, so that no multiplier has to be judged by its
distance from 1.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ...models.linear.balanced import CannotBalance, balanced_angles, restart_angles
from ..errors import SimulationError
from ..master.fmu import Closing, Fmu, Variables
from ..master.revolution import RANK, Matrix, Revolution, Vector, derivative
from ..scene import Scene

Outputs = list[tuple[Fmu, Variables]]
Outcome = TypeVar("Outcome")

BALANCED_ACCELERATION = 1e-9  # of a plane, over that of the whole unbalance and all weights
AT_REST = 1e-6  # of each state's scale: what a revolution may move a main motion
NEUTRAL_RETURN = 1e-5  # what a revolution may change a neutral turn; differences and steps err less
MOST_REFINED = 32  # times the given steps per revolution
_LONGEST_TURN = 0.5  # rad per iteration: a longer one leaves the neighbourhood of the start
_ITERATIONS = 30  # of half a radian: twice around, and Newton's last few
_STARTS = 5  # the second leaves a line of symmetry, on which Newton stands still


class NoMainMotion(SimulationError):
    """The weights cannot undo the unbalance, or the rotor cannot rest."""


class MainMotion(Closing):
    """Multipliers and growth about the main motion, measured on the coupled units at any speed.

    Args:
        scene: the weights' angles are the first guess of the balanced ones.
        separate: as of `Revolution`.

    Attributes:
        state: (n,) states of the units in the main motion.
        neutral: (n, m) turns of the weights with multiplier 1 by structure.

    Raises:
        NoMainMotion: no balanced position of the weights was found.
        SceneError: gravity swings the weights.
    """

    def __init__(self, scene: Scene, *, separate: bool = False) -> None:
        scene.refuse_unrest("a main motion")
        self.units = Revolution(scene, separate=separate)
        try:
            self._speed = abs(scene.profile().end)  # any will do for what follows
            self._angles = self._places_of_angles()
            self.state = self._balanced()
            self._rows, self._columns, self.neutral = self._split()
            self._refuse_false_neutral()
        except BaseException:
            self.units.close()
            raise

    def _places_of_angles(self) -> list[int]:
        """Which states are angles of weights."""
        states = enumerate(self.units.states)
        return [i for i, s in states if s.unit != "rotor" and not s.is_rate]

    def _read(self, states: Matrix, groups: Outputs) -> Matrix:
        """Outputs (k, m) of the units at the very start of motions from states (k, n)."""
        rows = []
        for state in states:
            self.units.begin(state, self._speed)
            rows.append([value for unit, group in groups for value in unit.get(group)])
        return np.array(rows)

    def _slopes(self, state: Vector, which: list[int], groups: Outputs) -> Matrix:
        """Derivative of outputs at the start by some states."""
        directions = np.eye(len(state))[:, which]
        scale = self.units.scale(self._speed)
        return derivative(lambda s: self._read(s, groups), state, directions, scale)

    def _balanced(self) -> Vector:
        """Rotor at rest, every weight at rest in the rotor where no plane is accelerated.

        Of the family of positions of three and more weights it is the one next to the scene's
        angles: the stability of its members differs.
        """
        rest = np.zeros(len(self.units.states))
        if not self._angles:
            return rest  # a linear rotor: deviations grow alike from any motion
        rotor = self.units.cosim.system.rotor
        names = [n for n in rotor.variables if n.startswith("plane[") and ".a_" in n]
        outputs = [(rotor, rotor.group(names))]
        scale = self.units.states[0].scale * self._speed**2
        first = self._first_angles()
        for attempt in range(_STARTS):
            rest[self._angles] = restart_angles(first, attempt)
            balanced = self._newton(rest, outputs, scale)
            if balanced is not None and self._rests(balanced):
                return balanced
        raise NoMainMotion(
            f"{self.units.scene.name}: no angles of the weights were found at which the rotor "
            "rests: they cannot undo its unbalance"
        )

    def _first_angles(self) -> Vector:
        """Angles of the weights to start the search from."""
        assembly = self.units.scene.assembly()
        if not any(mounted.half_angle for mounted in assembly.weights):
            return self.units.first[self._angles]
        try:
            return balanced_angles(assembly)
        except (CannotBalance, ArithmeticError) as error:
            raise NoMainMotion(f"{self.units.scene.name}: {error}") from error

    def _rests(self, state: Vector) -> bool:
        """Whether a revolution leaves a state as it is."""
        end = self._resolved(lambda: self.units(state[None], self._speed)[0])
        moved = (end - state) / self.units.scale(self._speed)
        return bool(np.abs(moved).max() <= AT_REST)

    def _newton(self, state: Vector, outputs: Outputs, scale: float) -> Vector | None:
        """Least turns that take away the planes' acceleration; None when that does not converge."""
        state = state.copy()
        for _ in range(_ITERATIONS):
            acceleration = self._read(state[None], outputs)[0]
            near = np.abs(acceleration).max() <= BALANCED_ACCELERATION * scale
            slopes = self._slopes(state, self._angles, outputs)
            turn = np.linalg.lstsq(slopes, -acceleration, rcond=RANK)[0]
            state[self._angles] += turn / max(1.0, float(np.abs(turn).max()) / _LONGEST_TURN)
            if near:
                return state  # its last turn has squared the error
        return None

    def _split(self) -> tuple[Matrix, Matrix, Matrix]:
        """Coordinates L (d, n) that neutral turns do not change, a right inverse (n, d), and them.

        L keeps every state but the angles; of those it keeps what the stations' moments see.
        """
        count = len(self.units.states)
        if not self._angles:
            return np.eye(count), np.eye(count), np.zeros((count, 0))
        moments = self._moment_slopes()
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

    def _moment_slopes(self) -> Matrix:
        """Moment on every station by the angle of every weight, (2 stations, K)."""
        cosim = self.units.cosim
        planes = cosim.plan.planes
        rotor = cosim.system.rotor
        stations = [
            i
            for i, s in enumerate(self.units.states)
            if s.unit == "rotor" and s.output[-1] == "x" and not s.is_rate
        ]
        blocks = []
        for name, unit in cosim.units.items():
            mine = [i for i in self._angles if self.units.states[i].unit == name]
            if not mine:
                continue
            plane = [(rotor, rotor.group([f"plane[{planes[name]}].x"]))]
            share = self._slopes(self.state, stations, plane)  # (1, stations): force's way back
            moment = [(unit, unit.group(["moment_xi", "moment_eta"]))]
            blocks.append(np.kron(share.T, self._slopes(self.state, mine, moment)))
        return np.hstack(blocks)

    def _map(self, columns: Matrix, speed: float) -> Matrix:
        """Derivative of the one-revolution map along given directions, in the states' scales."""
        scale = self.units.scale(speed)[:, None]
        turned = derivative(
            lambda s: self.units(s, speed), self.state, columns * scale, scale[:, 0]
        )
        return turned / scale

    def _resolved(self, measure: Callable[[], Outcome]) -> Outcome:
        """What `measure` gives; steps are halved as often as the coupling refuses them as too long.

        Far below the natural frequencies, or under heavy drag, a given number of steps per
        revolution does not resolve what the units do.
        """
        given = self.units.steps
        try:
            while True:
                try:
                    return measure()
                except SimulationError:
                    if self.units.steps >= MOST_REFINED * given:
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
                f"{self.units.scene.name}: turns of the weights that change no moment still change "
                f"by {error:.2g} of themselves in a revolution at {self._speed:g} rad/s: the units "
                "do more than their moments say, or the coupling is too coarse"
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

    def deviation(self, state: Vector, speed: float) -> Vector:
        """A state's deviation from the main motion in scaled coordinates, neutral turns apart."""
        return self._rows @ ((state - self.state) / self.units.scale(speed))

    def close(self) -> None:
        """Free the units."""
        self.units.close()
