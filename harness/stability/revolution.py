"""Stability from the co-simulated units: the map of one revolution and its multipliers.

Nothing here knows an equation.  The units are started from perturbed start values, coupled for one
revolution, and read; differences of the outcomes are the columns of the monodromy matrix.  Start
values are used rather than an edited copy of the units' states because every FMI tool has them.
The starts of one matrix run together in C, as one file each, where the scene's units allow it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...fmus.composite.batch import BatchRuns
from ..errors import SimulationError
from ..master.closing import Closing
from ..master.cosimulation import CoSimulation
from ..master.names import by_unit, stations, weight
from ..master.one_file import composition_in_c, why_separate
from ..master.plan import plan
from ..master.schedule import at_fixed_steps, steps_per_rev
from ..scene import Scene

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

PERTURBATION = 1e-4  # of each state's scale: central differences err by 1e-8, rounding by 1e-12
RANK = 1e-6  # smaller singular values of a derivative are zero: central differences err by 1e-8
FIXED_POINT_TOLERANCE = 1e-9  # of each state's scale; iterated coupling is converged to 1e-10
FIXED_POINT_ITERATIONS = 20
TIGHT = 1e-14  # of a machine in one piece: what differences of its starts bear


@dataclass(frozen=True)
class State:
    """One state of one unit: the parameter that starts it, the output that shows it, its scale."""

    unit: str
    start: str
    output: str
    is_rate: bool
    scale: float


def states(scene: Scene) -> list[State]:
    """All states of a scene's units; scales are those of displacements caused by the unbalance."""
    assembly = scene.assembly()
    rotor = assembly.rotor
    moment = float(np.abs(rotor.unbalance).max(initial=0.0))
    moment += assembly.capacity
    length = moment / float(np.trace(rotor.mass)) or 1.0  # a linear rotor alone: any length will do
    result = [
        State("rotor", f"{prefix}{rate}{axis}0", f"{prefix}{rate}{axis}", bool(rate), length)
        for rate in ("", "v")
        for axis in "xy"
        for prefix in stations(rotor.stations)
    ]
    for mounted in assembly.rings:
        for what, is_rate in (("wave", False), ("wave_speed", True)):
            for axis in ("xi", "eta"):
                name = f"{what}_{axis}"
                result.append(State(mounted.name, f"{name}0", name, is_rate, length))
    for mounted in assembly.weights:
        for k in range(1, len(mounted.angles) + 1):
            for what, is_rate in (("angle", False), ("speed", True)):
                name = weight(k, what)
                result.append(State(mounted.name, f"{name}0", name, is_rate, 1.0))
    return result


def derivative(
    function: Callable[[Matrix], Matrix],
    state: Vector,
    directions: Matrix,
    scale: Vector,
    moved: float = PERTURBATION,
    order: int = 2,
) -> Matrix:
    """Central differences of a function of the states along `directions` (n, d), one a column.

    Args:
        function: values (k, m) of states (k, n).
        scale: (n,) size of each state.
        moved: no state is moved by more than this part of it, or twice that at order 4.
        order: of the differences, 2 or 4.
    """
    steps = moved / np.abs(directions.T / scale).max(axis=1, keepdims=True)
    moves = steps * directions.T
    times = [1.0, -1.0] if order == 2 else [1.0, -1.0, 2.0, -2.0]
    ends = np.split(function(np.concatenate([state + t * moves for t in times])), len(times))
    near: Matrix = ((ends[0] - ends[1]) / (2.0 * steps)).T
    if order == 2:
        return near
    far: Matrix = ((ends[2] - ends[3]) / (4.0 * steps)).T
    return (4.0 * near - far) / 3.0


class Revolution(Closing):
    """One revolution of a scene's coupled units as a map of their states.

    Args:
        scene: whose units.
        steps: communication steps per revolution of separate FMUs; default: the scene's.
        separate: couple separate FMUs in Python even where the scene can run as one file.

    Attributes:
        rotor: parameters that every start gives the rotor on top of the scene's.
        tolerance: of a machine in one piece, whose steps are its own.
    """

    def __init__(self, scene: Scene, *, steps: int | None = None, separate: bool = False) -> None:
        scene.refuse_friction("the map of one revolution and the steady response are those")
        scene.refuse_changes("the map of one revolution")
        # the map is that of a constant speed, and every start must meet the same points
        changes = {"operation.speed": scene.profile().end}
        self.scene = scene = at_fixed_steps(scene.replace(changes))
        self.steps = steps or steps_per_rev(scene)
        self._one_file = None if separate or why_separate(scene) else composition_in_c(scene)
        self.states = states(scene)
        self.rotor: dict[str, float] = {}
        self.tolerance = TIGHT
        units = plan(scene).units
        self._drives = [one.name for one in units if one.driven]
        start = {one.name: one.start for one in units}
        self.first = np.array([float(start[s.unit].get(s.start, 0.0)) for s in self.states])

    @property
    def is_separate(self) -> bool:
        """Whether separate FMUs are coupled in Python."""
        return self._one_file is None

    @cached_property
    def cosim(self) -> CoSimulation:
        """The separate units: one file runs without them."""
        return CoSimulation(self.scene)

    def scale(self, speed: float) -> Vector:
        """Size of each state at a speed [rad/s]: lengths and angles, rates times the speed."""
        return np.array([s.scale * (abs(speed) if s.is_rate else 1.0) for s in self.states])

    def __call__(self, states: Matrix, speed: float) -> Matrix:
        """States (k, n) one revolution after each of (k, n), rotor at the same angle."""
        if self._one_file is None:
            return np.array([self._turned(state, speed) for state in states])
        changed = {"coupling.tolerance": self.tolerance, "speed": speed}
        changed |= {f"rotor.{name}": value for name, value in self.rotor.items()}
        starts, outputs = (
            [f"{s.unit}.{name}" for s, name in zip(self.states, names, strict=True)]
            for names in ([s.start for s in self.states], [s.output for s in self.states])
        )
        runs = BatchRuns(self._one_file, [*changed, *starts], outputs, 1)
        values = np.hstack([np.tile([*changed.values()], (len(states), 1)), states])
        found, reasons = runs(values, np.full(len(states), math.tau / abs(speed)))
        for reason in filter(None, reasons):
            raise SimulationError(f"{self.scene.label}: {reason}")
        return found[:, -1]

    def _turned(self, state: Vector, speed: float) -> Vector:
        self.begin(state, speed)
        step = self._step(speed)
        for _ in range(self.steps):
            self.cosim.step(step)
        outputs = by_unit(f"{s.unit}.{s.output}" for s in self.states)
        units = ((self.cosim.units[name], names) for name, names in outputs.items())
        return np.concatenate([unit.get(unit.group(names)) for unit, names in units])

    def begin(self, state: Vector, speed: float) -> None:
        """Start the units from a state, rotor at its starting angle."""
        changes: dict[str, dict[str, float | bool]] = {
            name: {"speed": speed, "acceleration": 0.0} for name in self._drives
        }
        changes.setdefault("rotor", {}).update(self.rotor)
        for value, s in zip(state, self.states, strict=True):
            changes.setdefault(s.unit, {})[s.start] = float(value)
        self.cosim.start(changes, self._step(speed))

    def record(
        self, state: Vector, speed: float, outputs: Sequence[str], revolutions: int = 1
    ) -> Matrix:
        """Outputs of the rotor after every step of a motion from a state, (steps, outputs)."""
        self.begin(state, speed)
        unit, step, rows = self.cosim.units["rotor"], self._step(speed), []
        watched = unit.group(list(outputs))
        for _ in range(revolutions * self.steps):
            self.cosim.step(step)
            rows.append(unit.get(watched))
        return np.array(rows)

    def _step(self, speed: float) -> float:
        return 2.0 * math.pi / (abs(speed) * self.steps)

    def monodromy(self, state: Vector, speed: float) -> Matrix:
        """Derivative of the map at a state, (n, n), in units of the states' scales."""
        scale = self.scale(speed)
        slopes = derivative(lambda s: self(s, speed), state, np.diag(scale), scale)
        return slopes / scale[:, None]

    def _linear_map(self, speed: float) -> Matrix:
        """As `monodromy`, of a linear machine: a unit of each state, and none, say it exactly."""
        scale = self.scale(speed)
        rest, *ends = self(np.vstack([np.zeros(len(scale)), np.diag(scale)]), speed)
        return (np.array(ends) - rest).T / scale[:, None]

    def steady(self, speed: float, monodromy: Matrix | None = None) -> Vector:
        """States that one revolution of a linear machine returns to: a rotor, with liquid or not.

        Args:
            monodromy: where it is known; the same everywhere.

        Raises:
            SimulationError: there is no such motion.
        """
        state, scale = np.zeros(len(self.states)), self.scale(speed)
        slopes = self._linear_map(speed) if monodromy is None else monodromy
        for _ in range(FIXED_POINT_ITERATIONS):
            residual = (self(state[None], speed)[0] - state) / scale
            step = np.linalg.lstsq(np.eye(len(state)) - slopes, residual, rcond=RANK)[0]
            state = state + step * scale
            if np.abs(residual).max() <= FIXED_POINT_TOLERANCE * (1 + np.abs(state / scale).max()):
                return state
        raise SimulationError(
            f"no steady motion found at {speed:g} rad/s: one revolution still moves the states by "
            f"{np.abs(residual).max():.3g} of their scale after {FIXED_POINT_ITERATIONS} iterations"
        )

    def close(self) -> None:
        """Free the units."""
        if "cosim" in vars(self):
            self.cosim.close()
