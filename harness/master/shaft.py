"""The shaft: a motor of limited power, and the units that it drives and whose torque it takes.

Its angular acceleration is one more thing that is assumed for a step and answered at its end, as
the balancers' forces are; the torques lie between, as the planes' accelerations do.  It counts as a
force by `Plan.spin_scale`; the imaginary part of what is complex elsewhere is 0.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from .fmu import Fmu
from .names import derivatives
from .plan import MOTOR, Plan
from .signals import ZERO, Cubic, Knot, SignalState, interpolated


class Shaft:
    """The motor and all that it drives.

    Args:
        plan: units and connections.
        units: the loaded units by name.
        order: of the exchanged signals, 0, 1 or 3.

    Attributes:
        spin: angular acceleration, counted as a force.
        name: of this signal.
        speed: of the rotor at the present time [rad/s].
    """

    name = f"{MOTOR}.acceleration"

    def __init__(self, plan: Plan, units: Mapping[str, Fmu], order: int) -> None:
        self.motor, self.order, self._scale = units[MOTOR], order, plan.spin_scale
        self.spin, slopes = SignalState(), min(order, 1)
        spin = ["speed", *derivatives("acceleration", order)]
        events = {one.name for one in plan.units if one.meets}
        driven = [units[c.target.unit] for c in plan.of_kind("spin")]
        self._driven = [(unit, unit.group(spin), unit.name in events) for unit in driven]
        sources = [units[c.source.unit] for c in plan.of_kind("torque")]
        self._sources = [(unit, unit.group(derivatives("torque", slopes))) for unit in sources]
        self._torque = self.motor.group(derivatives("torque", order))
        self._answer = self.motor.group([*derivatives("acceleration", slopes), "speed"])
        self.speed = self._next_speed = 0.0
        self._now = self._end = ZERO  # torque on the shaft

    def restart(self) -> None:
        """The speed of a motor that was restarted."""
        self.motor.fetch(self._answer)
        self.speed = self._answer.reals[-1]

    def write(self, spin: Cubic, step: float = 0.0) -> None:
        """Write to all driven units how the rotor turns in the step to come [s].

        Weights that can touch or stick get the mean of its acceleration: of order 1, as contacts
        are.
        """
        rates = [k.real / self._scale for k in spin[: self.order + 1]]
        mean = sum(rate * step**k / math.factorial(k + 1) for k, rate in enumerate(rates))
        for unit, group, constant in self._driven:
            used = [mean] + [0.0] * self.order if constant else rates
            unit.set(group, [self.speed, *used])

    def begin(self) -> Knot:
        """The angular acceleration of units in initialisation mode, and its slope."""
        self._now = self._end = self._torques()
        self.motor.set(self._torque, [k.real for k in (*self._now, 0j, 0j)[: self.order + 1]])
        self.motor.fetch(self._answer)
        return self._knot()

    def step(self, time: float, step: float) -> Knot:
        """Step the motor once all others have done the step; its acceleration at the end."""
        self._end = self._torques()
        torque = interpolated(self._now, self._end, step, self.order)
        self._torque.reals[:] = [k.real for k in torque[: self.order + 1]]
        self.motor.exchange(self._torque, self._answer, time, step)
        return self._knot()

    def accept(self) -> None:
        """Go on from the end of the step last taken."""
        self._now, self.speed = self._end, self._next_speed

    def _torques(self) -> Knot:
        value = slope = 0.0
        for unit, group in self._sources:
            found = unit.get(group)
            value += found[0]
            slope += found[1] if self.order else 0.0
        return complex(value), complex(slope)

    def _knot(self) -> Knot:
        *spin, self._next_speed = self._answer.reals.tolist()
        return complex(self._scale * spin[0]), complex(self._scale * spin[1] if self.order else 0.0)
