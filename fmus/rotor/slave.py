"""The rotor on its supports as a unit: forces on its planes in, accelerations of the planes out."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ...models.rotor import LinearRotor
from ...models.steps.propagator import step_matrix
from ...models.steps.variable_speed import Drive, VariableSpeedStep
from ..python.slave import Slave
from .angle import total, turned
from .kinds import ROTORS
from .parameters import RotorSizes
from .variables import ROTOR


class RotorOnSupports(Slave):
    """Linear rotor with n stations and p planes; exact step at constant speed.

    Its `memory` is the angle (whole turns, remainder, rounding carried along), then displacements
    and velocities of the stations, x and y alternating.
    """

    unit = ROTOR
    sizes: RotorSizes

    def parameters(self) -> None:
        values = self.parameter_values()
        self.gravity = complex(values["gravity_x"], values["gravity_y"])
        self.rotor = replace(ROTORS[self.sizes.kind](values, self.sizes), gravity=self.gravity)
        if self.gravity:
            self.rotor.sag(0.0)  # refuses supports that carry nothing
        self.turning = self.sizes.frame == "rotor"
        self._vector = np.empty(4 * self.sizes.stations + 8 * self.sizes.planes + 2)
        # an isotropic rotor computes with complex numbers over the same memory
        self._operand = self._vector.view(complex) if self.rotor.isotropic else self._vector

    def begin(self) -> None:
        first = self.layout.parameters.stop - 4 * self.sizes.stations - 1
        angle, *motion = self.real[first : self.layout.parameters.stop]
        self.memory = [*turned([0.0, 0.0, 0.0], angle), *motion]

    def step(self, step: float) -> None:
        speed, spin_up = self._drive()
        motion, planes = self._propagate(step)
        angle = turned(self.memory[:3], step * (speed + 0.5 * spin_up * step))
        self.memory = [*angle, *motion]
        self._set_outputs(planes, angle[1], speed + spin_up * step)

    def outputs(self) -> None:
        _, planes = self._propagate(0.0)
        self._set_outputs(planes, self.memory[1], self._drive()[0])

    def observe(self) -> None:
        angle, *motion = total(self.memory[:3]), *self.memory[3:]
        places, bending = self._shape(motion[: 2 * self.sizes.stations])
        self.real[self.layout.observed] = [angle, *motion, *places, bending]

    def _shape(self, stations: list[float]) -> tuple[list[float], float]:
        """Displacements of the planes and largest bending, from those of the stations."""
        if self.sizes.kind == "planar":  # one station, the disc, and every plane a port at it
            return stations * self.sizes.planes, math.hypot(*stations)
        place = np.array(stations).reshape(-1, 2)
        bending = self.rotor.deflection @ place
        largest = float(np.hypot(bending[:, 0], bending[:, 1]).max(initial=0.0))
        return (self.rotor.planes @ place).ravel().tolist(), largest

    def _drive(self) -> list[float]:
        """Speed and angular acceleration at the start of the step."""
        first = self.layout.inputs.start + self.sizes.planes
        return self.real[first : first + 2]

    def _propagate(self, step: float) -> tuple[list[float], list[float]]:
        """Motion of the stations, acceleration and jerk of the planes, after `step`.

        All in fixed axes, x and y alternating; the acceleration is less gravity's, which every body
        on the rotor feels: what an accelerometer would read.
        """
        inputs, p = self.real[self.layout.inputs], self.sizes.planes
        changing = self._propagate_variable if inputs[p + 1] else self._propagate_steady
        motion, planes = changing(step, inputs)
        if self.gravity:
            for k in range(0, 2 * p, 2):
                planes[k] -= self.gravity.real
                planes[k + 1] -= self.gravity.imag
        return motion, planes

    def _propagate_steady(
        self, step: float, inputs: list[float]
    ) -> tuple[list[float], list[float]]:
        """At constant speed: exact, by one matrix."""
        p, rest = self.sizes.planes, self.memory[1]
        speed, forces = inputs[p], inputs[p + 5 :]
        c, s = math.cos(rest), math.sin(rest)
        if self.turning:
            forces = _rotated(forces, c, s)
        self._vector[:] = [*self.memory[3:], *forces, c, s]
        n = 4 * self.sizes.stations
        if self.gravity:  # the rotor moves about its sag as it would about zero without gravity
            sag = _sag(self.rotor, tuple(inputs[:p]), speed)
            self._vector[: n // 2] -= sag
        matrix = _matrix(self.rotor, tuple(inputs[:p]), speed, step, self.turning)
        result = matrix.dot(self._operand).view(float)
        if self.gravity:
            result[: n // 2] += sag
        result = result.tolist()
        return result[:n], result[n:]

    def _propagate_variable(
        self, step: float, inputs: list[float]
    ) -> tuple[list[float], list[float]]:
        """In a run-up."""
        p = self.sizes.planes
        method = _variable(self.rotor, tuple(inputs[:p]), self.turning)
        forces = np.array(inputs[p + 5 :]).view(complex).reshape(-1, p)
        drive = Drive(forces, self.memory[1], *inputs[p : p + 2])
        state = _to_axes(np.array(self.memory[3:]), method.axes)
        if step:
            state = method.advance(state, drive, step)
        planes = np.concatenate(method.plane_motion(state, drive, step))
        return _from_axes(state, method.axes), _from_axes(planes, method.axes)

    def _set_outputs(self, planes: list[float], angle: float, speed: float) -> None:
        """Computed outputs from what the planes do in fixed axes, see `_propagate`."""
        if self.turning:
            n = 2 * self.sizes.planes
            a, j = planes[:n], planes[n:]
            # (a e^{-i beta})' = (j - i w a) e^{-i beta}
            for k in range(0, n, 2):
                j[k] += speed * a[k + 1]
                j[k + 1] -= speed * a[k]
            planes = _rotated(a + j, math.cos(angle), -math.sin(angle))
        self.real[self.layout.computed] = planes


def _rotated(pairs: list[float], c: float, s: float) -> list[float]:
    """Vectors (x, y alternating) turned by the angle with this cosine and sine."""
    rotated = pairs[:]
    for k in range(0, len(pairs), 2):
        x, y = pairs[k], pairs[k + 1]
        rotated[k] = x * c - y * s
        rotated[k + 1] = x * s + y * c
    return rotated


@lru_cache(maxsize=256)
def _loaded(rotor: LinearRotor, added_mass: tuple[float, ...]) -> LinearRotor:
    lightest = min(added_mass, default=0.0)
    if lightest < 0.0:
        raise ValueError(f"added_mass = {lightest!r} kg: must be a finite number, at least 0 kg")
    return rotor.with_added_mass(added_mass)


@lru_cache(maxsize=256)
def _matrix(
    rotor: LinearRotor,
    added_mass: tuple[float, ...],
    speed: float,
    step: float,
    turning: bool,
) -> NDArray:
    """Step matrix with x and y alternating in rows and columns."""
    matrix = step_matrix(_loaded(rotor, added_mass), speed, step, turning)
    if not rotor.isotropic:
        n, p = rotor.stations, rotor.plane_count
        rows = _alternating([n, n, p, p])
        columns = _alternating([n, n, p, p, p, p, 1])
        matrix = matrix[np.ix_(rows, columns)]
    return np.ascontiguousarray(matrix)


@lru_cache(maxsize=256)
def _sag(rotor: LinearRotor, added_mass: tuple[float, ...], speed: float) -> NDArray:
    """Sag of the stations, x and y alternating [m]."""
    axes = 1 if rotor.isotropic else 2
    sag = _loaded(rotor, added_mass).sag(speed)
    return np.array(_from_axes(sag, axes, 1))


@lru_cache(maxsize=64)
def _variable(
    rotor: LinearRotor, added_mass: tuple[float, ...], turning: bool
) -> VariableSpeedStep:
    return VariableSpeedStep(_loaded(rotor, added_mass), turning)


def _alternating(blocks: list[int]) -> list[int]:
    """Where x_1, y_1, x_2, ... of each block stand when it is ordered (x..., y...)."""
    order: list[int] = []
    for size in blocks:
        first = len(order)
        for k in range(size):
            order += [first + k, first + size + k]
    return order


def _to_axes(pairs: NDArray, axes: int) -> NDArray:
    """Complex numbers, or (x..., y...) a half, from x and y alternating."""
    if axes == 1:
        return pairs.view(complex)
    return pairs.reshape(2, -1, 2).transpose(0, 2, 1).ravel()


def _from_axes(values: NDArray, axes: int, blocks: int = 2) -> list[float]:
    """The inverse of `_to_axes`, of so many blocks."""
    if axes == 1:
        return np.ascontiguousarray(values).view(float).tolist()
    return values.reshape(blocks, 2, -1).transpose(0, 2, 1).ravel().tolist()
