"""The shaft: a motor of limited power, and the units that it drives and whose torque it takes.

A scheme predicts and corrects the motor's angular acceleration as it does the balancers' forces: it
is the last row of `System.forces`, times `Plan.spin_scale`, with imaginary part 0.  The torques of
the units stand between, as the accelerations of the planes do.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from .fmu import Fmu
from .names import derivatives
from .plan import MOTOR, Plan
from .signals import Knots, cubics_from_start, interpolated


class Shaft:
    """The motor and all that it drives.

    Args:
        plan: units and connections.
        units: the loaded units by name.
        order: of the exchanged signals, 0, 1 or 3.

    Attributes:
        name: of its acceleration among the names of forces.
        speed: of the rotor at the present time [rad/s].
    """

    name = f"{MOTOR}.acceleration"

    def __init__(self, plan: Plan, units: Mapping[str, Fmu], order: int) -> None:
        self.motor, self.order, self._scale = units[MOTOR], order, plan.spin_scale
        slopes = min(order, 1)
        spin = ["speed", *derivatives("acceleration", order)]
        driven = [units[c.target.unit] for c in plan.of_kind("spin")]
        self._driven = [(unit, unit.group(spin)) for unit in driven]
        sources = [units[c.source.unit] for c in plan.of_kind("torque")]
        self._sources = [(unit, unit.group(derivatives("torque", slopes))) for unit in sources]
        self._torque = self.motor.group(derivatives("torque", order))
        self._answer = self.motor.group([*derivatives("acceleration", slopes), "speed"])
        self.speed = self._next_speed = 0.0
        self._now = self._end = np.zeros((1, 2), complex)  # torque on the shaft

    def restart(self) -> None:
        """The speed of a motor that was restarted."""
        self.motor.fetch(self._answer)
        self.speed = self._answer.reals[-1]

    def write(self, spin: np.ndarray) -> None:
        """Write to all driven units how the rotor turns in the step to come."""
        rates = (spin[: self.order + 1].real / self._scale).tolist()
        for unit, group in self._driven:
            unit.set(group, [self.speed, *rates])

    def answer(self) -> Knots:
        """The angular acceleration of units in initialisation mode, and its slope."""
        self._now = self._end = self._torques()
        self._torque.reals[:] = cubics_from_start(self._now)[0, : self.order + 1].real
        self.motor.send(self._torque)
        self.motor.fetch(self._answer)
        return self._knots()

    def step(self, time: float, step: float) -> Knots:
        """Step the motor once all others have done the step; its acceleration at the end."""
        self._end = self._torques()
        torque = interpolated(self._now, self._end, step, self.order)
        self._torque.reals[:] = torque[0, : self.order + 1].real
        self.motor.exchange(self._torque, self._answer, time, step)
        return self._knots()

    def accept(self) -> None:
        """Go on from the end of the step last taken."""
        self._now, self.speed = self._end, self._next_speed

    def _torques(self) -> Knots:
        found = sum(np.array(unit.get(group)) for unit, group in self._sources)
        return self._as_knots(found)

    def _knots(self) -> Knots:
        *spin, self._next_speed = self._answer.reals.tolist()
        return self._as_knots(self._scale * np.array(spin))

    @staticmethod
    def _as_knots(found: ArrayLike) -> Knots:
        knots = np.zeros((1, 2), complex)
        knots[0, : np.size(found)] = found
        return knots
