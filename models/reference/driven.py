"""A rotor, its weights and the motor that drives them as one ordinary differential equation.

Formulated apart from the units, which exchange the torque on the shaft: here the motor pulls on one
more coordinate of Lagrange's equations.  Sommerfeld 1902.
"""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..assembly import Assembly, SpeedProfile
from ..motor import Drive, MotorDriven
from .coupled import REST, Monolith, Start, Turning
from .lagrange import Lagrange


class Driven:
    """The coupled equations of `assembly` on the shaft of a motor.

    The state, (4 n + 2 N + 2,) for n stations and N weights, is (x, y, vx, vy, phi, phi', angle,
    speed): that of a `Monolith` and the shaft's.  Weights roll freely, see `Colliding` for those
    that touch; a liquid turns with the rotor and leaves no torque on the shaft.
    """

    def __init__(self, assembly: Assembly, drive: MotorDriven, angle: float = 0.0) -> None:
        self.assembly, self.drive, self.angle = assembly, drive, angle
        self._begun, self._top = (
            Monolith(assembly, SpeedProfile.constant(speed), angle)
            for speed in (drive.start, drive.end)
        )
        self.stations, self.weights = self._begun.stations, self._begun.weights
        self.size = self._begun.size + 2

    @property
    def dry(self) -> bool:
        """Whether anything can stick."""
        return self._begun.dry

    @property
    def fastest_mode(self) -> float:
        """Of the rotor at the speed without load, and of the weights' drag [1/s]."""
        return self._top.fastest_mode

    @property
    def top(self) -> float:
        """Fastest turning that the motor aims at [rad/s]."""
        return max(self.drive.start, self.drive.end)

    @property
    def lagrange(self) -> Lagrange:
        """Inertia and forces without the motor's."""
        return self._begun.lagrange

    def initial(self, start: Start = REST) -> Array:
        """State at time 0, (size,)."""
        return np.append(self._begun.initial(start), [start.angle, self.drive.start])

    def scales(self, start: Start = REST) -> Array:
        """Typical size of each part of the state, (size,)."""
        return np.append(self._top.scales(start), [1.0, self.drive.end])

    def stops(self, end: float) -> list[float]:
        """Times up to which the motion is smooth [s]: the end."""
        return [end] if end else []

    def after(self, _time: float) -> Driven:
        """The same: its unbalance does not change."""
        return self

    def between(self, _begin: float, _stop: float) -> Driven:
        """The same: nothing depends on time."""
        return self

    def rhs(self, t: float, y: Array) -> Array:
        """Derivative of the state, (size,)."""
        return self.array_rhs(t, y)

    def array_rhs(self, _t: float, y: Array, push: Array | float = 0.0) -> Array:
        """Derivative of the state, (size,); `push` as of `accelerations`."""
        n, found = self.stations, self._solved(y, push)
        speeds, rates = y[2 * n : 4 * n], y[4 * n + self.weights : -2]
        lateral, phi2 = np.split(found[:-1], [2 * n])
        return np.concatenate([speeds, lateral, rates, phi2, y[-1:], found[-1:]])

    def accelerations(
        self, _t: float, y: Array, push: Array | float = 0.0
    ) -> tuple[Array, Array, Array]:
        """x'' and y'' of the stations, (..., 2, n), phi'' of the weights, (..., N), and w', (...).

        Args:
            push: what else would accelerate each weight along its track on a rotor and a shaft
                that are held, (..., N) [rad/s^2].
        """
        found, lateral = self._solved(y, push), 2 * self.stations
        a = found[..., :lateral].reshape(*found.shape[:-1], 2, -1)
        return a, found[..., lateral:-1], found[..., -1]

    def accelerations_of(self, _turning: Turning, states: Array) -> tuple[Array, Array]:
        """As `Monolith.accelerations_of`, of states (T, size)."""
        found, lateral = self._solved(states), 2 * self.stations
        return found[:, :lateral].reshape(len(states), 2, -1), found[:, lateral:-1]

    def turning(self, _time: Array, states: Array) -> Turning:
        """Angle, speed and angular acceleration of the shaft, each (T,)."""
        return states[:, -2], states[:, -1], self._solved(states)[:, -1]

    def _solved(self, y: Array, push: Array | float = 0.0) -> Array:
        """Second derivatives of x, y, phi and the shaft's angle, (..., 2 n + N + 1)."""
        motor, gravity = self.drive.motor, self.assembly.rotor.gravity
        inertia, force = self._begun.lagrange(y[..., -2:-1], y[..., -1:], y[..., :-2])
        inertia[..., -1, -1] += motor.inertia
        force[..., -1] += torque_of(motor, y[..., -1])
        lateral, trials = 2 * self.stations, np.shape(push)[:-1]
        force = np.broadcast_to(force, (*(trials or force.shape[:-1]), force.shape[-1])).copy()
        force[..., lateral:-1] += push * self.lagrange.turned_inertia
        found = np.asarray(np.linalg.solve(inertia, force[..., None]), float)[..., 0]
        # gravity acts as if all were accelerated against it
        found[..., :lateral] += np.repeat([gravity.real, gravity.imag], self.stations)
        return found


def torque_of(motor: Drive, speed: Array) -> Array:
    """The motor's torque [N m]: lines through the points, the outer ones continued."""
    speeds, torques = motor.speeds, motor.torques
    steep = np.diff(torques) / np.diff(speeds)
    below, above = np.minimum(0.0, speed - speeds[0]), np.maximum(0.0, speed - speeds[-1])
    return np.interp(speed, speeds, torques) + steep[0] * below + steep[-1] * above
