"""The rotor on its supports as a unit: forces on its planes in, accelerations of the planes out."""

from __future__ import annotations

import cmath
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ...models.rotor import LinearRotor
from ...models.steps.propagator import step_matrix
from ...models.steps.variable_speed import Drive, VariableSpeedStep
from ..python.slave import Slave
from .angle import total, turned
from .kinds import FORCES, ROTORS
from .sizes import RotorSizes
from .variables import ROTOR

Complex = NDArray[np.complex128]  # x + i y

_matrix = lru_cache(maxsize=256)(step_matrix)  # rotors, speeds and steps of a run
_variable = lru_cache(maxsize=64)(VariableSpeedStep)


class RotorOnSupports(Slave):
    """Linear rotor with n stations and p planes; exact step at constant speed.

    Its `memory` is the angle (whole turns, remainder, rounding carried along), then displacements
    and velocities of the stations, x and y alternating.
    """

    unit = ROTOR
    sizes: RotorSizes

    def parameters(self) -> None:
        values = self.parameter_values()
        gravity = complex(values["gravity_x"], values["gravity_y"])
        self.rotor = replace(ROTORS[self.sizes.kind](values, self.sizes), gravity=gravity)
        if gravity:
            self.rotor.sag(0.0)  # refuses supports that carry nothing
        self.turning = self.sizes.frame == "rotor"
        self.forces = FORCES[self.sizes.kind](values, self.sizes, self.rotor)

    def begin(self) -> None:
        first = self.layout.parameters.stop - 4 * self.sizes.stations - 1
        angle, *motion = self.real[first : self.layout.parameters.stop]
        self.memory = [*turned([0.0, 0.0, 0.0], angle), *motion]

    def step(self, step: float) -> None:
        speed, spin_up = self._drive()
        motion, planes = self._propagate(step)
        angle = turned(self.memory[:3], step * (speed + 0.5 * spin_up * step))
        self.memory = [*angle, *_pairs(motion)]
        self._set_outputs(planes, angle[1], speed + spin_up * step)

    def outputs(self) -> None:
        _, planes = self._propagate(0.0)
        self._set_outputs(planes, self.memory[1], self._drive()[0])

    def observe(self) -> None:
        angle, motion = total(self.memory[:3]), self._motion()
        places, bending = self.rotor.planes @ motion[0], self.rotor.deflection @ motion[0]
        largest = float(np.abs(bending).max(initial=0.0))
        # by displacements, then velocities of the stations, x and y alternating
        forces = (self.forces @ np.array(self.memory[3:])).tolist()
        self.real[self.layout.observed] = [
            *(angle, *_pairs(motion), *_pairs(places), largest),
            *forces,
        ]

    def _motion(self) -> Complex:
        """Displacements and velocities of the stations, (2, n)."""
        return np.array(self.memory[3:]).view(complex).reshape(2, -1)

    def _drive(self) -> list[float]:
        """Speed and angular acceleration at the start of the step."""
        first = self.layout.inputs.start + self.sizes.planes
        return self.real[first : first + 2]

    def _propagate(self, step: float) -> tuple[Complex, Complex]:
        """Motion of the stations (2, n), acceleration and jerk of the planes (2, p), after `step`.

        All in fixed axes; the acceleration is less gravity's, which every body on the rotor feels:
        what an accelerometer would read.
        """
        inputs, p, angle = self.real[self.layout.inputs], self.sizes.planes, self.memory[1]
        speed, spin_up = self._drive()
        forces = np.array(inputs[p + 5 :]).view(complex).reshape(-1, p)
        rotor = _loaded(self.rotor, tuple(inputs[:p]))
        state = _to_axes(self._motion(), rotor)
        if spin_up:
            method, drive = _variable(rotor, self.turning), Drive(forces, angle, speed, spin_up)
            if step:
                state = method.advance(state, drive, step)
            planes = np.concatenate(method.plane_motion(state, drive, step))
        else:
            state, planes = self._propagate_steady(rotor, state, forces, speed, step)
        planes = _from_axes(planes, rotor)
        planes[0] -= rotor.gravity
        return _from_axes(state, rotor), planes

    def _propagate_steady(
        self, rotor: LinearRotor, state: NDArray, forces: Complex, speed: float, step: float
    ) -> tuple[NDArray, NDArray]:
        """At constant speed: exact, by one matrix."""
        turn, dof = np.array([[cmath.rect(1.0, self.memory[1])]]), len(state) // 2
        if self.turning:
            forces = forces * turn
        # the rotor moves about its sag as it would about zero without gravity
        sag = np.zeros_like(state)
        if rotor.gravity:
            sag[:dof] = rotor.sag(speed)
        matrix = _matrix(rotor, speed, step, self.turning)
        parts = [state - sag, _to_axes(forces, rotor), _to_axes(turn, rotor)]
        result = matrix.dot(np.concatenate(parts))  # in silence, as what is not finite is refused
        return result[: 2 * dof] + sag, result[2 * dof :]

    def _set_outputs(self, planes: Complex, angle: float, speed: float) -> None:
        """Computed outputs from what the planes do in fixed axes, see `_propagate`."""
        if self.turning:
            a, jerk = planes
            # (a e^{-i beta})' = (j - i w a) e^{-i beta}
            with np.errstate(over="ignore", invalid="ignore"):  # refused when it is not finite
                planes = np.array([a, jerk - 1j * speed * a]) * cmath.rect(1.0, -angle)
        self.real[self.layout.computed] = _pairs(planes)


@lru_cache(maxsize=256)
def _loaded(rotor: LinearRotor, added_mass: tuple[float, ...]) -> LinearRotor:
    lightest = min(added_mass, default=0.0)
    if lightest < 0.0:
        raise ValueError(f"added_mass = {lightest!r} kg: must be a finite number, at least 0 kg")
    return rotor.with_added_mass(added_mass)


def _pairs(values: Complex) -> list[float]:
    """x and y alternating."""
    return np.ascontiguousarray(values).view(float).ravel().tolist()


def _to_axes(rows: Complex, rotor: LinearRotor) -> NDArray:
    """Rows (k, n) one after the other, each as x..., y... unless the rotor is isotropic."""
    return (rows if rotor.isotropic else np.hstack([rows.real, rows.imag])).ravel()


def _from_axes(values: NDArray, rotor: LinearRotor) -> Complex:
    """The inverse of `_to_axes`, of two rows."""
    if rotor.isotropic:
        return values.reshape(2, -1)
    x, y = values.reshape(2, 2, -1).transpose(1, 0, 2)
    return x + 1j * y
