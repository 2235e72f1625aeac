"""The motor of limited power as a unit: the torque on its shaft in, speed and acceleration out."""

from __future__ import annotations

from ...models import motor as equations
from ...models.cubic import at
from ..python.slave import Slave
from ..rotor.angle import total, turned
from .variables import MOTOR, MotorSizes


class Motor(Slave):
    """Motor of limited power: the torque on its shaft in, speed and acceleration out.

    Its `memory` is the angle (whole turns, remainder, rounding carried along) and the speed.
    """

    unit = MOTOR
    sizes: MotorSizes

    def parameters(self) -> None:
        inertia, *points = self.real[: 1 + 2 * self.sizes.points]
        self.motor = equations.Drive(inertia, tuple(points[::2]), tuple(points[1::2]))

    def begin(self) -> None:
        angle, speed = self.real[self.layout.parameters][-2:]
        self.memory = [*turned([0.0, 0.0, 0.0], angle), speed]

    def step(self, step: float) -> None:
        torque = self.real[self.layout.inputs]
        speed, angle = equations.advance(self.motor, self.memory[3], torque, step)
        self.memory = [*turned(self.memory[:3], angle), speed]
        self._put(*at(torque, step))

    def outputs(self) -> None:
        self._put(*self.real[self.layout.inputs][:2])

    def observe(self) -> None:
        speed = self.memory[3]
        torque = self.motor.torque(speed)
        self.real[self.layout.observed] = [total(self.memory[:3]), torque, torque * speed]

    def _put(self, torque: float, torque_slope: float) -> None:
        """Computed outputs under a torque on the shaft and its slope."""
        speed = self.memory[3]
        rate = self.motor.acceleration(speed, torque, torque_slope)
        self.real[self.layout.computed] = [*rate, speed]
