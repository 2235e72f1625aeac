"""A rotor, its weights and the motor that drives them as one ordinary differential equation.

Formulated apart from the units, which exchange the torque on the shaft: here the angle of the shaft
is one more coordinate of Lagrange's equations, beside the stations and the weights' absolute
angles.  Sommerfeld 1902; Filimonikhina 2017 (4), with the shaft's row.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array
from ..assembly import Assembly, SpeedProfile, weights_of
from ..liquid import Liquid
from ..motor import Drive
from .coupled import REST, Monolith, Start, Turning


@dataclass(frozen=True)
class MotorDriven:
    """A speed that a motor of limited power makes, from `start` on [rad/s]."""

    motor: Drive
    start: float = 0.0

    @property
    def end(self) -> float:
        """Without load [rad/s]."""
        return self.motor.top_speed

    @property
    def top(self) -> float:
        """Highest speed that a load leaves [rad/s]."""
        return max(abs(self.start), self.end)


class Driven:
    """The coupled equations of `assembly` on the shaft of a motor.

    The state, (4 n + 2 N + 2,) for n stations and N weights, is (x, y, vx, vy, phi, phi', angle,
    speed): that of a `Monolith` and the shaft's.  Weights are points that roll freely; a liquid
    turns with the rotor and leaves no torque on the shaft.
    """

    def __init__(self, assembly: Assembly, drive: MotorDriven, angle: float = 0.0) -> None:
        self.assembly, self.drive, self.angle = assembly, drive, angle
        self._begun, self._top = (
            Monolith(assembly, SpeedProfile.constant(speed), angle)
            for speed in (drive.start, drive.end)
        )
        self.stations, self.weights = self._begun.stations, self._begun.weights
        self.size, self.shaft = self._begun.size + 2, 2 * self.stations
        liquids = tuple(m for m in assembly.balancers if isinstance(m.device, Liquid))
        self._mass = replace(assembly, balancers=liquids).loaded_rotor.mass
        self._each = [(m, one) for m in assembly.weights for one in weights_of(m).each]

    @property
    def dry(self) -> bool:
        """Whether anything can stick."""
        return self._begun.dry

    @property
    def fastest_mode(self) -> float:
        """Of the rotor at the speed without load, and of the weights' drag [1/s]."""
        return self._top.fastest_mode

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

    def rhs(self, _t: float, y: Array) -> Array:
        """Derivative of the state, (size,)."""
        n, found = self.stations, self._solved(y)
        speeds, rates = y[2 * n : 4 * n], y[4 * n + self.weights : -2]
        lateral, spin, phi2 = found[: 2 * n], found[2 * n], found[2 * n + 1 :]
        return np.concatenate([speeds, lateral, rates, phi2, [y[-1], spin]])

    def accelerations_of(self, _turning: Turning, states: Array) -> tuple[Array, Array]:
        """As `Monolith.accelerations_of`, of states (T, size)."""
        found = np.array([self._solved(y) for y in states])
        return found[:, : self.shaft].reshape(len(states), 2, -1), found[:, self.shaft + 1 :]

    def turning(self, _time: Array, states: Array) -> Turning:
        """Angle, speed and angular acceleration of the shaft, each (T,)."""
        spin = np.array([self._solved(y)[self.shaft] for y in states])
        return states[:, -2], states[:, -1], spin

    def _solved(self, y: Array) -> Array:
        """Second derivatives of x, y, the shaft's angle and phi, (2 n + 1 + N,)."""
        n, shaft, rotor, motor = self.stations, self.shaft, self.assembly.rotor, self.drive.motor
        (angle, w), rates = y[-2:], y[4 * n + self.weights : -2]
        x, yy, v_x, v_y = y[: 4 * n].reshape(4, n)
        z, speeds = x + 1j * yy, np.concatenate([v_x, v_y, [w], rates])
        u = rotor.unbalance * np.exp(1j * angle)
        v = v_x + 1j * v_y
        sheared = rotor.internal_damping @ (v - 1j * w * z)
        inertia = np.zeros((len(speeds),) * 2)
        inertia[:n, :n] = inertia[n:shaft, n:shaft] = self._mass
        inertia[shaft, :shaft] = inertia[:shaft, shaft] = np.concatenate([-u.imag, u.real])
        inertia[shaft, shaft] = motor.inertia
        right = np.zeros(len(speeds))
        push = w * w * u - sheared + 1j * w * (rotor.gyroscopic @ v)
        right[:n] = push.real - rotor.stiffness_x @ x - rotor.damping_x @ v_x
        right[n:shaft] = push.imag - rotor.stiffness_y @ yy - rotor.damping_y @ v_y
        right[shaft] = torque_of(motor, w) + (z.conj() @ sheared).imag
        for k, (mounted, device) in enumerate(self._each):
            phi, path = y[4 * n + k], np.zeros(len(speeds), complex)
            row, centre = rotor.planes[mounted.plane], mounted.offset * np.exp(1j * angle)
            arm = device.track_radius * np.exp(1j * phi)
            path[:n], path[n:shaft], path[shaft], path[shaft + 1 + k] = (
                row,
                1j * row,
                1j * centre,
                1j * arm,
            )
            bias = -w * w * centre - rates[k] ** 2 * arm
            inertia += device.mass * np.outer(path.conj(), path).real
            right -= device.mass * (path.conj() * bias).real
            # a body that rolls turns by (1 + r/R) w - phi', times R/r; kappa - 1 = J/(m r^2)
            roll, slip = np.zeros((2, len(speeds)))
            roll[shaft], roll[shaft + 1 + k] = -1.0 - device.radius / device.track_radius, 1.0
            slip[shaft], slip[shaft + 1 + k] = -1.0, 1.0
            square = device.track_radius**2
            inertia += (device.kappa - 1.0) * device.mass * square * np.outer(roll, roll)
            right -= device.drag * square * (slip @ speeds) * slip
        found = np.asarray(np.linalg.solve(inertia, right), float)
        # gravity acts as if all were accelerated against it
        found[:shaft] += np.repeat([rotor.gravity.real, rotor.gravity.imag], n)
        return found


def torque_of(motor: Drive, speed: float) -> float:
    """The motor's torque [N m]: lines through the points, the outer ones continued."""
    speeds, torques = motor.speeds, motor.torques
    steep = np.diff(torques) / np.diff(speeds)
    below, above = min(0.0, speed - speeds[0]), max(0.0, speed - speeds[-1])
    return float(np.interp(speed, speeds, torques) + steep[0] * below + steep[-1] * above)
