"""The coupled units: rotor, balancers, and the signals between them at the present time.

What a scheme needs of them: `rotor_pass`, `balancer_pass`, `save` and `restore`, and the
signals (`forces`, `accelerations`) with `accept` at the end of a step.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from ctypes import c_void_p
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..errors import SimulationError
from .fmu import Fmu, Variables
from .names import components, signals
from .plan import MOTOR, ROTOR, Plan
from .shaft import Shaft
from .signals import Cubics, Knots, Signals


def _knots(group: Variables, order: int) -> Knots:
    """A group's buffer, all values and then the slopes that are exchanged, as knots."""
    return group.vectors.reshape(2 if order else 1, -1).T


@dataclass(slots=True)
class Exchange:
    """A balancer that exchanges force with a plane of the rotor.

    Attributes:
        plane: index into the planes that exchange force.
        answers: what `outputs` fetched, as knots.
        force: what the rotor is sent of the plane's force; `others` is what the balancers before
            have added to it.
    """

    unit: Fmu
    plane: int
    inputs: Variables
    outputs: Variables
    answers: Knots
    force: NDArray[np.complex128]
    others: NDArray[np.complex128] | float


class System:
    """Units of a scene with their connections.

    Args:
        plan: units and connections.
        units: the loaded units by name.
        order: of the exchanged signals, 0, 1 or 3.

    Attributes:
        exchanges: balancers that exchange force, in order.
        shaft: the motor with all that it drives; None at a prescribed speed.
        forces: of the exchanges, and of the shaft its acceleration; `force_names` as well.
        kinds: rows of `forces` that measure the same thing.
        accelerations: of every plane that exchanges force.
        most: modulus of the largest force that is taken for one [N].
    """

    def __init__(self, plan: Plan, units: Mapping[str, Fmu], order: int) -> None:
        self.plan, self.units, self.order, self.most = plan, dict(units), order, math.inf
        self.rotor = units[ROTOR]
        self._connect_planes()
        self.members = [self.rotor, *(e.unit for e in self.exchanges)]
        self.shaft = Shaft(plan, units, order) if MOTOR in units else None
        if self.shaft:
            self.force_names.append(self.shaft.name)
            self.members.append(self.shaft.motor)
        self.forces = Signals(len(self.force_names))
        rows = [range(len(self.exchanges)), range(len(self.exchanges), len(self.force_names))]
        self.kinds = [slice(each.start, each.stop) for each in rows if each]
        self._states = [c_void_p() for _ in self.members]  # null: not saved yet
        self._follow_places()
        driven = [units[one.name] for one in plan.units if one.driven]
        self._driven = [(unit, unit.group(["speed", "acceleration"])) for unit in driven]

    @property
    def coupled(self) -> bool:
        """Whether there is a loop: something is assumed for a step and answered at its end."""
        return bool(self.force_names)

    @property
    def has_no_past(self) -> bool:
        """Whether no step has been taken since the start or the last jump of the drive."""
        return not self.forces.last_step

    def _connect_planes(self) -> None:
        """Find the variables of forces and accelerations, of the rotor and of the balancers."""
        plan, units, order = self.plan, self.units, self.order
        exchanged, slopes = plan.of_kind("signal"), min(order, 1)
        sources = {c.target.unit: c.source.variable for c in exchanged if c.source.unit == ROTOR}
        targets = {c.source.unit: c.target.variable for c in exchanged if c.target.unit == ROTOR}
        acceleration_of = {targets[unit]: sources[unit] for unit in targets}  # by a plane's force
        # in the order in which the rotor declares them they are one slice
        planes = sorted(
            acceleration_of,
            key=lambda name: self.rotor.group(components(name)).references[0],
        )
        self._forces = self.rotor.group(signals(planes, order))
        # the values of all planes, then the slopes of all planes: of each plane a column
        force_rows = self._forces.vectors.reshape(order + 1, len(planes)).T
        names = [acceleration_of[force] for force in planes]
        self._accelerations = self.rotor.group(signals(names, slopes))
        self._answers = _knots(self._accelerations, order)
        self.accelerations = Signals(len(planes))
        self.exchanges: list[Exchange] = []
        for name, force in targets.items():
            unit, plane = units[name], planes.index(force)
            outputs = unit.group(signals(["F"], slopes))
            row, shared = force_rows[plane], any(one.plane == plane for one in self.exchanges)
            self.exchanges.append(
                Exchange(
                    unit=unit,
                    plane=plane,
                    inputs=unit.group(signals(["a"], order)),
                    outputs=outputs,
                    answers=_knots(outputs, order),
                    force=row,
                    others=row if shared else 0.0,
                )
            )
        self.force_names = [f"{exchange.unit.name}.F" for exchange in self.exchanges]

    def _follow_places(self) -> None:
        """Connect the places that balancers follow: variables of both units over one buffer."""
        values = self.plan.of_kind("value")
        self._places: dict[str, tuple[Variables, Variables]] = {}
        for name in dict.fromkeys(c.target.unit for c in values):
            mine = [c for c in values if c.target.unit == name]
            source = self.rotor.group([c.source.variable for c in mine])
            target = self.units[name].group([c.target.variable for c in mine], source.reals)
            self._places[name] = source, target
        self._alone = [self.units[n] for n in self._places if self.units[n] not in self.members]

    def _send_place(self, unit: Fmu) -> None:
        if unit.name in self._places:
            source, target = self._places[unit.name]
            self.rotor.fetch(source)
            unit.send(target)

    def follow(self, time: float, step: float) -> None:
        """Step the balancers that exchange no force, once the others have finished the step."""
        for unit in self._alone:
            self._send_place(unit)
            unit.step(time, step)

    def rotor_pass(self, forces: Cubics, time: float, step: float) -> Knots:
        """Step the rotor under the cubics of `forces`; accelerations of the planes."""
        if self.shaft:
            self.shaft.write(forces[-1])
        if not self.exchanges:
            self.rotor.step(time, step)
            return self.accelerations.now
        self._sum_forces(forces)
        self.rotor.exchange(self._forces, self._accelerations, time, step)
        return self._fetched(self._answers)

    def balancer_pass(self, accelerations: Cubics, time: float, step: float) -> Knots:
        """Step every exchanging balancer under its plane's acceleration; what `forces` become."""
        ends = []
        for exchange in self.exchanges:
            self._send_place(exchange.unit)
            exchange.inputs.vectors[:] = accelerations[exchange.plane, : self.order + 1]
            exchange.unit.exchange(exchange.inputs, exchange.outputs, time, step)
            ends.append(self._fetched(exchange.answers))
        if self.shaft:
            ends.append(self.shaft.step(time, step))
        if len(ends) == 1:
            return ends[0]
        return np.concatenate(ends) if ends else self.forces.now

    def balancer_answer(self, accelerations: Cubics) -> Knots:
        """What `forces` are of units in initialisation mode under accelerations of the planes."""
        knots = []
        for exchange in self.exchanges:
            exchange.inputs.vectors[:] = accelerations[exchange.plane, : self.order + 1]
            exchange.unit.send(exchange.inputs)
            exchange.unit.fetch(exchange.outputs)
            knots.append(self._fetched(exchange.answers))
        if self.shaft:
            knots.append(self.shaft.answer())
        return np.concatenate(knots)

    def rotor_answer(self, forces: Cubics) -> Knots:
        """What `accelerations` become of units in initialisation mode under forces."""
        if self.shaft:
            self.shaft.write(forces[-1])
        self._sum_forces(forces)
        self.rotor.send(self._forces)
        self.rotor.fetch(self._accelerations)
        self.accelerations.now = self._fetched(self._answers)
        return self.accelerations.now

    def _sum_forces(self, forces: Cubics) -> None:
        for exchange, cubic in zip(self.exchanges, forces, strict=False):  # behind them the shaft
            np.add(exchange.others, cubic[: self.order + 1], out=exchange.force)

    def _fetched(self, answers: Knots) -> Knots:
        """A copy of what was fetched; slopes that are not exchanged are zero."""
        return answers.copy() if self.order else np.column_stack((answers, np.zeros_like(answers)))

    def drive(self, speed: float, acceleration: float) -> None:
        """Write the speed at the start of a step, and its rate of change, to units that need it."""
        for unit, group in self._driven:
            unit.set(group, (speed, acceleration))

    def save(self) -> None:
        """Keep the states of all members of the coupling loop, for `restore`."""
        for unit, state in zip(self.members, self._states, strict=True):
            unit.save(state)

    def restore(self) -> None:
        """Roll all members back to the states kept last."""
        for unit, state in zip(self.members, self._states, strict=True):
            unit.restore(state)

    def free_states(self) -> None:
        """Give back the memory of the states."""
        for unit, state in zip(self.members, self._states, strict=True):
            unit.free(state)

    def accept(self, accelerations: Knots, forces: Knots, time: float, step: float) -> None:
        """Take over the ends of the signals of a finished step.

        Raises:
            SimulationError: a force is beyond `most`, or no number: a step repeats its own error.
        """
        for k, (value, name) in enumerate(
            zip(forces[:, 0].tolist(), self.force_names, strict=True)
        ):
            # what the shaft's acceleration can be nobody knows ahead
            if not abs(value) <= (self.most if k < len(self.exchanges) else sys.float_info.max):
                raise SimulationError(
                    f"coupling steps of {step:.3g} s are too long at t = {time:g} s: {name} is "
                    "beyond all that the scene can make of it: the coupling diverges; use "
                    'scheme = "iterated" or "auto", more coupling.steps_per_rev, or a tolerance'
                )
        self.accelerations.accept(accelerations, step)
        self.forces.accept(forces, step)
        if self.shaft:
            self.shaft.accept()

    def drop_past(self) -> None:
        """Drop what the signals did before now: it says nothing of what comes."""
        self.accelerations.drop_past()
        self.forces.drop_past()

    def restart(self, changes: Mapping[str, Mapping[str, float | bool]]) -> None:
        """Reset every unit with its start values (`changes` by unit name override the scene's).

        Leaves the units in initialisation mode with the added masses handed to the rotor.
        """
        rotor, *balancers = ({**u.start, **changes.get(u.name, {})} for u in self.plan.units)
        for one, start in zip(self.plan.units[1:], balancers, strict=True):
            self.units[one.name].restart(start)
        for target, sources in self.plan.inputs("mass").items():
            units = [(self.units[source.unit], source.variable) for source in sources]
            rotor[target.variable] = sum(u.get(u.group([mass]))[0] for u, mass in units)
        self.rotor.restart(rotor)
        if self.shaft:
            self.shaft.restart()
