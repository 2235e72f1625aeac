"""Forces along fixed axes on the rotor, which takes its forces in axes that turn with it.

A unit in the network like any other, between what pushes and the rotor: it turns the polynomials of
a step, with their exact slopes, by the angle of the prescribed drive.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from ctypes import c_void_p
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
from fmpy.model_description import CoSimulation, ModelDescription, ScalarVariable, Unknown

from ..closing import Closing
from ..names import components, derivatives, plane

NAME = "forces on rotor"  # no unit of a scene can have it
CALLS = ("set", "get", "step", "save", "restore", "reset")
AXES = ("x", "y")


def _unit_of(name: str) -> str:
    """Of a force, or of its derivative: `der(F_x)`, `der(F_x,2)`."""
    if not name.startswith("der("):
        return "N"
    _, comma, order = name.removesuffix(")").partition(",")
    return f"N/s{order}" if comma else "N/s"


class Values:
    """Places of some variables in the unit's memory, and their values."""

    def __init__(self, places: Sequence[int], memory: np.ndarray | None) -> None:
        self.places = np.array(places, int)
        self.reals = np.zeros(len(places)) if memory is None else memory


class FixedForces(Closing):
    """Forces on planes of the rotor along x and y in, along xi and eta out.

    Args:
        planes: numbers of the planes of the rotor's unit.
        angle, speed: of the rotor at a time [s]: [rad], [rad/s].

    Attributes:
        variables, description: as an FMU would declare them.
    """

    name, path = NAME, Path("rotor")

    def __init__(
        self,
        planes: Iterable[int],
        angle: Callable[[float], float],
        speed: Callable[[float], float],
    ) -> None:
        self._angle, self._speed = angle, speed
        pushed = [plane(number, "F") for number in planes]
        given = [f"{force}_{axis}" for force in pushed for axis in AXES]
        turned = [name for force in pushed for name in components(force)]
        inputs = [name for order in zip(*(derivatives(n, 3) for n in given), strict=True)
                  for name in order]  # fmt: skip
        outputs = [*turned, *(f"der({name})" for name in turned)]
        self.variables = {
            name: ScalarVariable(
                name=name, valueReference=place, type="Real",
                causality="input" if place < len(inputs) else "output",
                unit=_unit_of(name),
            )
            for place, name in enumerate([*inputs, *outputs])
        }  # fmt: skip
        self.description = ModelDescription(
            fmiVersion="2.0",
            modelVariables=list(self.variables.values()),
            coSimulation=CoSimulation(
                canGetAndSetFMUstate=True, canHandleVariableCommunicationStepSize=True
            ),
            outputs=[
                Unknown(variable=self.variables[n], dependencies=self._act_on(n)) for n in outputs
            ],
        )
        self.measured_in = {name: v.unit for name, v in self.variables.items()}
        self.calls, self.messages = dict.fromkeys(CALLS, 0), list[str]()
        self._inputs, self._given = len(inputs), len(given)
        self._numbers, self._kept = count(1), dict[int, tuple[np.ndarray, float, float]]()
        self.restart({})

    def _act_on(self, output: str) -> list[ScalarVariable]:
        """Inputs that an output depends on at once."""
        force = output.removeprefix("der(").rpartition("_")[0]
        names = [f"{force}_{axis}" for axis in AXES]
        slopes = [f"der({name})" for name in names] if output.startswith("der(") else []
        return [self.variables[name] for name in (*names, *slopes)]

    def restart(self, _start: Mapping[str, Any]) -> None:
        """No forces, at time 0."""
        self._memory = np.zeros(len(self.variables))
        self.time = self._since = 0.0

    def start(self) -> None:
        """Nothing: it has no initialisation mode."""

    def group(self, names: Iterable[str], memory: np.ndarray | None = None) -> Values:
        """Variables to be read or written together; `memory` holds their values."""
        return Values([self.variables[name].valueReference for name in names], memory)

    def get(self, group: Values) -> list[float]:
        """Values of the group's variables."""
        self.fetch(group)
        return [float(value) for value in group.reals]

    def set(self, group: Values, values: Sequence[float]) -> None:
        """Write the group's variables, as they are at the start of the step to come."""
        self._memory[group.places] = values
        self._since = 0.0

    def fetch(self, group: Values) -> None:
        """Read the group's variables."""
        self._turn()
        group.reals[:] = self._memory[group.places]

    def _turn(self) -> None:
        """The outputs at the time that has been reached."""
        orders = self._memory[: self._inputs].reshape(4, self._given)
        forces = orders[:, 0::2] + 1j * orders[:, 1::2]
        t = self._since
        value, slope = (
            sum(t**k / math.factorial(k) * forces[first + k] for k in range(4 - first))
            for first in (0, 1)
        )
        turn = np.exp(-1j * self._angle(self.time))
        value, slope = turn * value, turn * (slope - 1j * self._speed(self.time) * value)
        parts = (
            np.stack([value.real, value.imag], -1).ravel(),
            np.stack([slope.real, slope.imag], -1).ravel(),
        )
        self._memory[self._inputs :] = np.concatenate(parts)

    def step(self, time: float, step: float) -> None:
        """Advance by `step` [s] from `time` [s]."""
        self.calls["step"] += 1
        self.time, self._since = time + step, step

    def save(self, state: c_void_p) -> None:
        """Copy the state into one that is null, or over an earlier copy."""
        number = state.value or next(self._numbers)
        state.value = number
        self._kept[number] = self._memory.copy(), self.time, self._since

    def restore(self, state: c_void_p) -> None:
        """Roll back to a saved state."""
        memory, self.time, self._since = self._kept[state.value or 0]
        self._memory[:] = memory

    def free(self, state: c_void_p) -> None:
        """Release a saved state, which is null afterwards."""
        self._kept.pop(state.value or 0, None)
        state.value = None

    def close(self) -> None:
        """Nothing is held."""
