"""The rotor on its supports as a unit: forces on its planes in, accelerations of the planes out."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ...models import quintic
from ...models.rotor import LinearRotor
from ...models.spin import Drift, drift
from ...models.steps.friction import FrictionStep, Held, held_at_start
from ...models.steps.propagator import step_matrix
from ...models.steps.variable_speed import Drive, VariableSpeedStep
from ..python.slave import Slave
from .angle import total, turned
from .kinds import rotor_of
from .parameters import RotorSizes
from .variables import ROTOR


class RotorOnSupports(Slave):
    """Linear rotor with n stations and p planes; exact step at constant speed.

    Its `memory` is the angle (whole turns, remainder, rounding carried along), then displacements
    and velocities of the stations, x and y alternating, then of every slider along x and y its
    direction of slip (0: it sticks) and its force, and how long ago the inputs were set.
    """

    unit = ROTOR
    sizes: RotorSizes

    def parameters(self) -> None:
        values = self.parameter_values()
        if shortest := values.get("shortest_stopped_step"):
            raise ValueError(
                f"shortest_stopped_step = {shortest!r} s: must be 0 s, a step of a Python unit "
                "cannot end early"
            )
        self.gravity = complex(values["gravity_x"], values["gravity_y"])
        self.rotor = replace(rotor_of(values, self.sizes), gravity=self.gravity)
        if self.gravity:
            self.rotor.sag(0.0)  # refuses supports that carry nothing
        self.turning = self.sizes.frame == "rotor"
        if self.sizes.sliders:
            self._friction()
            return
        size = 4 * self.sizes.stations + 2 * (self.sizes.order + 1) * self.sizes.planes + 2
        self._vector = np.empty(size)
        # an isotropic rotor computes with complex numbers over the same memory
        self._operand = self._vector.view(complex) if self.rotor.isotropic else self._vector

    def begin(self) -> None:
        first = self.layout.parameters.stop - 4 * self.sizes.stations - 1
        angle, *motion = self.real[first : self.layout.parameters.stop]
        if self.sizes.sliders:
            rates = _to_axes(np.array(motion), 2)[len(motion) // 2 :]
            motion += _pairs(held_at_start(self.rotor, rates))
        self.memory = turned([0.0, 0.0, 0.0], angle) + motion + [0.0]

    def step(self, step: float) -> None:
        speed, spin_up = self._drive()
        gone, faster, _, _ = self._drift(step)
        motion, planes = self._propagate(step)
        angle = turned(self.memory[:3], step * (speed + 0.5 * spin_up * step) + gone)
        self.memory = [*angle, *motion, step]
        self._put(planes, angle[1], speed + spin_up * step + faster)

    def outputs(self) -> None:
        self.memory = [*self.memory[:-1], 0.0]
        _, planes = self._propagate(0.0)
        self._put(planes, self.memory[1], self._drive()[0])

    def observe(self) -> None:
        angle, motion = total(self.memory[:3]), self._motion()
        places, bending = self._shape(motion[: 2 * self.sizes.stations])
        forces = self.memory[4 + len(motion) : -1 : 2]
        self.real[self.layout.observed] = [
            angle, *motion, *places, bending, *forces, *self._torque()
        ]  # fmt: skip

    def _motion(self) -> list[float]:
        """Displacements and velocities of the stations, x and y alternating."""
        return self.memory[3 : 3 + 4 * self.sizes.stations]

    def _torque(self) -> tuple[float, float]:
        """Torque on the shaft and its slope, of inputs that were set `memory[-1]` ago."""
        inputs, t = self.real[self.layout.inputs], self.memory[-1]
        speed, spin_up = self._drive()
        more = self._drift(t)
        angle = turned(self.memory[:3], -t * (speed + 0.5 * spin_up * t) - more.angle)[1]
        drive = self._drive_of(inputs, angle)
        if self.sizes.order == 5:  # the speed is constant: begin at the present
            now = [*quintic.at(list(drive.forces), t), np.zeros(self.sizes.planes)]
            drive, t = drive._replace(forces=np.array(now), angle=self.memory[1]), 0.0
        if self.sizes.sliders:
            state, held = self._held()
            return self._friction().torque(state, held, drive, t)
        method = self._changing(inputs)
        return method.torque(_to_axes(np.array(self._motion()), method.axes), drive, t)

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

    def _drift(self, time: float) -> Drift:
        """What the change of the angular acceleration has done `time` after the inputs were set."""
        first = self.layout.inputs.start + self.sizes.planes + 2
        one, two, three = self.real[first : first + 3]
        return drift((one, two, three), time)

    def _propagate(self, step: float) -> tuple[list[float], list[float]]:
        """Motion of the stations (and sliders), acceleration and jerk of the planes, after `step`.

        With signals of order 5 the jerk's derivative follows.  All in fixed axes, x and y
        alternating; the acceleration is less gravity's, which every body on the rotor feels: what
        an accelerometer would read.
        """
        motion, planes = self._propagate_all(step)
        if self.gravity:
            for k in range(0, 2 * self.sizes.planes, 2):
                planes[k] -= self.gravity.real
                planes[k + 1] -= self.gravity.imag
        return motion, planes

    def _propagate_all(self, step: float) -> tuple[list[float], list[float]]:
        """As `_propagate`, the acceleration with gravity's."""
        inputs = self.real[self.layout.inputs]
        p = self.sizes.planes
        speed = inputs[p]
        if self.sizes.sliders:
            return self._propagate_friction(step, inputs)
        if any(inputs[p + 1 : p + 5]):
            if self.sizes.order == 5:
                raise ValueError(
                    "acceleration: must be 0, as its derivatives, with signals of order = 5"
                )
            return self._propagate_variable(step, inputs)
        rest = self.memory[1]
        c, s = math.cos(rest), math.sin(rest)
        forces = inputs[p + 5 :]
        if self.turning:
            forces = _rotated(forces, c, s)
        self._vector[:] = [*self.memory[3:-1], *forces, c, s]
        n = 4 * self.sizes.stations
        if self.gravity:  # the rotor moves about its sag as it would about zero without gravity
            sag = _sag(self.rotor, tuple(inputs[:p]), speed)
            self._vector[: n // 2] -= sag
        matrix = _matrix(self.rotor, tuple(inputs[:p]), speed, step, self.turning, self.sizes.order)
        result = matrix.dot(self._operand).view(float)
        if self.gravity:
            result[: n // 2] += sag
        result = result.tolist()
        return result[:n], result[n:]

    def _propagate_variable(
        self, step: float, inputs: list[float]
    ) -> tuple[list[float], list[float]]:
        method, drive = self._changing(inputs), self._drive_of(inputs, self.memory[1])
        state = _to_axes(np.array(self._motion()), method.axes)
        if step:
            state = method.advance(state, drive, step)
        acceleration, jerk = method.plane_motion(state, drive, step)
        planes = np.concatenate([acceleration, jerk])
        return _from_axes(state, method.axes), _from_axes(planes, method.axes)

    def _propagate_friction(
        self, step: float, inputs: list[float]
    ) -> tuple[list[float], list[float]]:
        method, drive = self._friction(), self._drive_of(inputs, self.memory[1])
        state, held = self._held()
        if step:
            state, held = method.advance(state, held, drive, step)
        else:
            held = method.resolved(state, held, drive, 0.0)
        acceleration, jerk, held = method.plane_motion(state, held, drive, step)
        planes = np.concatenate([acceleration, jerk])
        return _from_axes(state, 2) + _pairs(held), _from_axes(planes, 2)

    def _friction(self) -> FrictionStep:
        first = self.layout.inputs.start
        added = tuple(self.real[first : first + self.sizes.planes])
        return _frictional(self.rotor, added, self.turning)

    def _held(self) -> tuple[NDArray, Held]:
        """State (q, v), x before y, and sliders."""
        motion = self._motion()
        pairs = np.array(self.memory[3 + len(motion) : -1])
        return _to_axes(np.array(motion), 2), Held(pairs[::2], pairs[1::2])

    def _changing(self, inputs: list[float]) -> VariableSpeedStep:
        return _variable(self.rotor, tuple(inputs[: self.sizes.planes]), self.turning)

    def _drive_of(self, inputs: list[float], angle: float) -> Drive:
        """What moves the rotor from this angle on."""
        p = self.sizes.planes
        speed, spin_up, *rates = inputs[p : p + 5]
        forces = np.array(inputs[p + 5 :]).view(complex).reshape(-1, p)
        return Drive(forces, angle, speed, spin_up, (rates[0], rates[1], rates[2]))

    def _put(self, planes: list[float], angle: float, speed: float) -> None:
        """Computed outputs from what the planes do in fixed axes, see `_propagate`."""
        n = 2 * self.sizes.planes
        a, j, s = planes[:n], planes[n : 2 * n], planes[2 * n :]
        if self.turning:
            # (a e^{-i beta})'' = (s - 2 i w j - w^2 a) e^{-i beta}
            for k in range(0, len(s), 2):
                s[k] += speed * (2.0 * j[k + 1] - speed * a[k])
                s[k + 1] -= speed * (2.0 * j[k] + speed * a[k + 1])
            # (a e^{-i beta})' = (j - i w a) e^{-i beta}
            for k in range(0, n, 2):
                j[k] += speed * a[k + 1]
                j[k + 1] -= speed * a[k]
            planes = _rotated(a + j + s, math.cos(angle), -math.sin(angle))
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
    order: int,
) -> NDArray:
    """Step matrix with x and y alternating in rows and columns."""
    matrix = step_matrix(_loaded(rotor, added_mass), speed, step, turning, order)
    if not rotor.isotropic:
        n, p = rotor.stations, rotor.plane_count
        rows = _alternating([n, n, *[p] * (order // 2 + 1)])
        columns = _alternating([n, n, *[p] * (order + 1), 1])
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


@lru_cache(maxsize=64)
def _frictional(rotor: LinearRotor, added_mass: tuple[float, ...], turning: bool) -> FrictionStep:
    return FrictionStep(_loaded(rotor, added_mass), turning)


def _pairs(held: Held) -> list[float]:
    """Direction of slip and force of every slider."""
    return np.stack(held, axis=1).ravel().tolist()


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
