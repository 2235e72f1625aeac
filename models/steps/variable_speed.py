"""Step of the linear rotor while its speed changes at a constant rate w'.

The system is then linear with time-varying matrices (internal damping and gyroscopic coupling grow
with the speed, Dubovik 2006 (5) has the w' terms of the unbalance).  Radau IIA with three stages is
used: order 5, one linear solve a part, and L-stable, so that stiff supports set no step-size limit.
Hairer & Wanner 1996, table IV.5.6.

L-stable is not right: a free vibration faster than the step would die at once.  A step is therefore
taken in 1, 2, 4, ... equal parts until halving them changes the displacements by no more than
`STEP_ACCURACY` allows (step doubling, Hairer, Norsett & Wanner 1993, II.4).  The error of a step
stays about that share of the displacements, whatever the supports' stiffness: below 1e-6 of them is
left after a thousand steps of an undamped rotor.  Motion smaller than that, of a stiff axis beside
a soft one, costs no parts.  Long parts agree that a fast vibration is dead, so the parts must also
be short for the motion at hand.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import cubic
from ..rotor import LinearRotor
from .radau import radau

STAGES = 3  # of the Radau method, order 5: as good as the cubic forces
STEP_ACCURACY = 1e-10  # of the largest displacement: 10,000 steps stay below 1e-6
PART_HALVINGS = 12  # 4096 parts: modes 4000 times as fast as a rotor of 40 steps per turn
HALVED_ERRORS = 31.0  # 2^5 - 1: halved parts differ from whole ones by so many of their errors

NODES, COEFFICIENTS = radau(STAGES)


Turning = tuple[complex, float, float]  # turn as a unit vector, w, w'


class Drive(NamedTuple):
    """What moves the rotor over a step.

    Attributes:
        forces: (4, p) complex forces on the planes in the rotor frame at the start and their
            derivatives; in fixed axes when `turning_force` is False.
        angle, speed: of the rotor at the start [rad, rad/s].
        angular_acceleration: w' [rad/s^2].
    """

    forces: NDArray
    angle: float
    speed: float
    angular_acceleration: float


class VariableSpeedStep:
    """The rotor's matrices split by powers of the speed, and the step that uses them."""

    def __init__(self, rotor: LinearRotor, turning_force: bool = True) -> None:
        self.turning_force = turning_force
        self.falling = rotor.falling if rotor.gravity else None
        self.axes = 1 if rotor.isotropic else 2
        mass, damping, stiffness = rotor.coefficients(0.0)
        _, damping_1, stiffness_1 = rotor.coefficients(1.0)
        self.inverse = inverse = np.linalg.inv(mass)
        self.dof = len(mass)
        self.still = np.hstack([-inverse @ stiffness, -inverse @ damping])
        self.per_speed = np.hstack(
            [-inverse @ (stiffness_1 - stiffness), -inverse @ (damping_1 - damping)]
        )
        self.planes = np.kron(np.eye(self.axes), rotor.planes)
        self.force = inverse @ self.planes.T
        self.unbalance = inverse @ rotor.unbalance_columns
        # of a part's stages: what does not depend on the time
        self._matrices = np.zeros((STAGES, 2 * self.dof, 2 * self.dof), self.still.dtype)
        self._matrices[:, : self.dof, self.dof :] = np.eye(self.dof)

    def _axes_of(self, value: NDArray) -> NDArray:
        return value if self.axes == 1 else np.concatenate([value.real, value.imag])

    def _sum_drive(self, force: NDArray, unbalance: NDArray) -> NDArray:
        """Acceleration by forces on the planes (p,) and by what the unbalance pulls (1,)."""
        return self.force @ self._axes_of(force) + self.unbalance @ self._axes_of(unbalance)

    def _drive(self, turning: Turning, force: NDArray) -> NDArray:
        """Acceleration by unbalance, forces on the planes (p,) and gravity."""
        turn, w, w1 = turning
        pull = np.array([w * w - 1j * w1]) * turn
        push = self._sum_drive(force * turn if self.turning_force else force, pull)
        return push if self.falling is None else push + self.falling

    def _drive_slope(self, turning: Turning, force: NDArray, slope: NDArray) -> NDArray:
        """Derivative of that acceleration."""
        turn, w, w1 = turning
        if self.turning_force:
            slope = (slope + 1j * w * force) * turn
        return self._sum_drive(slope, np.array([3.0 * w * w1 + 1j * w**3]) * turn)

    def advance(self, state: NDArray, drive: Drive, step: float) -> NDArray:
        """State (q, v) one `step` [s] later, displacements to `STEP_ACCURACY`.

        Args:
            state: (2 dof,) displacements and velocities, complex for an isotropic rotor.

        Raises:
            ArithmeticError: the motion is too fast for 2^`PART_HALVINGS` parts of the step.
        """
        turning, forces = _at(drive, 0.0)
        push = self._drive(turning, forces[0])
        acceleration = _largest((self.still + turning[1] * self.per_speed) @ state + push)
        before, rate = _largest(state[: self.dof]), _largest(state[self.dof :])
        whole = self.parts(state, drive, step, 1)
        for halving in range(1, PART_HALVINGS + 1):
            halved = self.parts(state, drive, step, 2**halving)
            error = _largest((halved - whole)[: self.dof]) / HALVED_ERRORS
            reach, part = max(before, _largest(halved[: self.dof])), step / 2**halving
            passed = part * max(rate, part * acceleration)
            # what is not finite is returned as it is
            if not (error > STEP_ACCURACY * reach or passed > reach):
                return halved
            whole = halved
        raise ArithmeticError(
            f"the rotor vibrates too fast for a step of {step:.6g} s at changing speed: "
            f"{2**PART_HALVINGS} parts of it still have an error of {error:.6g} m; use smaller "
            "communication steps"
        )

    def parts(self, state: NDArray, drive: Drive, step: float, count: int) -> NDArray:
        """As `advance`, in `count` equal parts of which nothing is asked."""
        part = step / count
        for number in range(count):
            state = self._part(state, drive, number * part, part)
        return state

    def _part(self, state: NDArray, drive: Drive, begin: float, step: float) -> NDArray:
        """State one `step` later than at the time `begin` into the cubic forces."""
        size = 2 * self.dof
        matrices, right = self._matrices.copy(), np.empty((STAGES, size), self.still.dtype)
        for matrix, row, node in zip(matrices, right, NODES, strict=True):
            turning, forces = _at(drive, begin + node * step)
            matrix[self.dof :] = self.still + turning[1] * self.per_speed
            row[:] = matrix @ state
            row[self.dof :] += self._drive(turning, forces[0])
        coupled = (step * COEFFICIENTS)[:, None, :, None] * matrices[:, :, None]
        system = np.eye(STAGES * size) - coupled.reshape(STAGES * size, -1)
        stages = np.linalg.solve(system, right.ravel()).reshape(STAGES, size)
        return state + step * (COEFFICIENTS[-1] @ stages)

    def plane_motion(self, state: NDArray, drive: Drive, t: float = 0.0) -> tuple[NDArray, NDArray]:
        """Acceleration and jerk of the planes in fixed axes, (axes p,), at time t into the step.

        `state` belongs to that time.
        """
        turning, forces = _at(drive, t)
        _, w, w1 = turning
        matrix = self.still + w * self.per_speed
        acceleration = matrix @ state + self._drive(turning, forces[0])
        jerk = matrix @ np.concatenate([state[self.dof :], acceleration])
        jerk += w1 * (self.per_speed @ state) + self._drive_slope(turning, *forces)
        return self.planes @ acceleration, self.planes @ jerk


def _at(drive: Drive, t: float) -> tuple[Turning, NDArray]:
    """How the rotor turns at t, and the forces with their slopes, (2, p)."""
    forces, angle, speed, spin_up = drive
    turn = np.exp(1j * (angle + speed * t + 0.5 * spin_up * t * t))
    # in plain numbers: for a few planes arrays take two to four times as long
    values = list(zip(*(cubic.at(plane, t) for plane in forces.T.tolist()), strict=True))
    return (turn, speed + spin_up * t, spin_up), np.array(values)


def _largest(values: NDArray) -> float:
    """Largest modulus."""
    return float(np.abs(values).max())
