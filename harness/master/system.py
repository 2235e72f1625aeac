"""The coupled units: rotor, balancers, and the signals between them at the present time.

What a scheme needs of them: `rotor_pass`, `balancer_pass`, `save` and `restore`, and the
signals (`forces`, `accelerations`) with `accept` at the end of a step.
"""

from __future__ import annotations

from cmath import isfinite
from collections.abc import Mapping
from ctypes import c_void_p
from dataclasses import dataclass

import numpy as np

from ..errors import SimulationError
from .fmu import Fmu, Variables
from .names import components, signals
from .plan import ROTOR, Plan
from .signals import Cubics, Knots, Signals


@dataclass(slots=True)
class Exchange:
    """A balancer that exchanges force with a plane of the rotor.

    Attributes:
        plane: index into the planes that exchange force.
        place: variables of its plane's place, of the rotor and its own over one buffer, where it
            follows that.
    """

    unit: Fmu
    plane: int
    inputs: Variables
    outputs: Variables
    place: tuple[Variables, Variables] | None = None


class System:
    """Units of a scene with their connections.

    Args:
        plan: units and connections.
        units: the loaded units by name.
        order: of the exchanged signals, 0, 1 or 3.
        watch: also step balancers that exchange no force, for their clearance.

    Attributes:
        exchanges: balancers that exchange force, in order.
        forces: of the exchanges; `force_names` as well.
        accelerations: of every plane that exchanges force; `acceleration_names` as well.
        has_no_past: no step has been taken since the start or the last jump of the drive.
    """

    def __init__(self, plan: Plan, units: Mapping[str, Fmu], order: int, watch: bool) -> None:
        self.plan, self.units, self.order, self.has_no_past = plan, dict(units), order, True
        self.rotor = units[ROTOR]
        self._connect_planes()
        self.members = [self.rotor, *(e.unit for e in self.exchanges)]
        self.forces = Signals(len(self.force_names))
        self._states: list[c_void_p] = []
        self.watched: list[tuple[Fmu, Variables, Variables]] = []
        if watch:
            self._follow_places()
        driven = [units[one.name] for one in plan.units if one.driven]
        self._driven = [(unit, unit.group(["speed", "acceleration"])) for unit in driven]

    @property
    def coupled(self) -> bool:
        """Whether there is a loop: something is assumed for a step and answered at its end."""
        return bool(self.exchanges)

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
            key=lambda name: self.rotor.group(components(name, plan.axes)).references[0],
        )
        self._forces = self.rotor.group(signals(planes, order, plan.axes))
        # the values of all planes, then the slopes of all planes: of each plane a column
        self._force_rows = self._forces.vectors.reshape(order + 1, len(planes)).T
        names = [acceleration_of[force] for force in planes]
        self._accelerations = self.rotor.group(signals(names, slopes, plan.axes))
        self.acceleration_names = [f"{ROTOR}.{name}" for name in names]
        self.accelerations = Signals(len(planes))
        self.exchanges = [
            Exchange(
                units[name],
                planes.index(force),
                units[name].group(signals(["a"], order, plan.axes)),
                units[name].group(signals(["F"], slopes, plan.axes)),
            )
            for name, force in targets.items()
        ]
        self.force_names = [f"{exchange.unit.name}.F" for exchange in self.exchanges]

    def _follow_places(self) -> None:
        """Connect what balancers need of their plane's place."""
        values = self.plan.of_kind("value")
        exchanging = {exchange.unit.name: exchange for exchange in self.exchanges}
        for name in dict.fromkeys(c.target.unit for c in values):
            mine = [c for c in values if c.target.unit == name]
            unit, source = self.units[name], self.rotor.group([c.source.variable for c in mine])
            target = unit.group([c.target.variable for c in mine], source.reals)
            if name in exchanging:
                exchanging[name].place = source, target
            else:
                self.watched.append((unit, source, target))

    def follow(self, time: float, step: float) -> None:
        """Step the balancers that exchange no force, once the others have finished the step."""
        for unit, source, target in self.watched:
            self.rotor.fetch(source)
            unit.send(target)
            unit.step(time, step)

    def rotor_pass(self, forces: Cubics, time: float, step: float) -> Knots:
        """Step the rotor under the cubics of `forces`; accelerations of the planes."""
        if not self.exchanges:
            self.rotor.step(time, step)
            return self.accelerations.now
        self._sum_forces(forces)
        self.rotor.exchange(self._forces, self._accelerations, time, step)
        return self._knots(self._accelerations)

    def balancer_pass(self, accelerations: Cubics, time: float, step: float) -> Knots:
        """Step every exchanging balancer under its plane's acceleration; what `forces` become."""
        ends = []
        for exchange in self.exchanges:
            if exchange.place:
                source, target = exchange.place
                self.rotor.fetch(source)
                exchange.unit.send(target)
            exchange.inputs.vectors[:] = accelerations[exchange.plane][: self.order + 1]
            exchange.unit.exchange(exchange.inputs, exchange.outputs, time, step)
            ends.append(self._knots(exchange.outputs))
        return np.concatenate(ends) if ends else self.forces.now

    def answer(self, accelerations: Cubics) -> Knots:
        """What `forces` are of units in initialisation mode under accelerations of the planes."""
        knots = []
        for exchange in self.exchanges:
            exchange.inputs.vectors[:] = accelerations[exchange.plane][: self.order + 1]
            exchange.unit.send(exchange.inputs)
            exchange.unit.fetch(exchange.outputs)
            knots.append(self._knots(exchange.outputs))
        return np.concatenate(knots)

    def set_forces(self, forces: Cubics) -> None:
        """Write the sum of the forces on every plane that exchanges force, and how it turns."""
        self._sum_forces(forces)
        self.rotor.send(self._forces)

    def _sum_forces(self, forces: Cubics) -> None:
        self._force_rows[:] = 0.0
        for exchange, cubic in zip(self.exchanges, forces, strict=True):
            self._force_rows[exchange.plane] += cubic[: self.order + 1]

    def read_accelerations(self) -> Knots:
        """Acceleration and slope of every plane that exchanges force."""
        self.rotor.fetch(self._accelerations)
        return self._knots(self._accelerations)

    def _knots(self, group: Variables) -> Knots:
        """Signals' ends, from all their values and then, where they are exchanged, all slopes."""
        if self.order:
            return group.vectors.reshape(2, -1).T.copy()
        return np.column_stack((group.vectors, np.zeros_like(group.vectors)))

    def drive(self, speed: float, acceleration: float) -> None:
        """Write the speed at the start of a step, and its rate of change, to units that need it."""
        for unit, group in self._driven:
            unit.set(group, (speed, acceleration))

    def save(self) -> None:
        """Keep the states of all members of the coupling loop, for `restore`."""
        for number, unit in enumerate(self.members):
            if number < len(self._states):
                unit.save(self._states[number])  # over the former one
            else:
                self._states.append(unit.save())

    def restore(self) -> None:
        """Roll all members back to the states kept last."""
        for unit, state in zip(self.members, self._states, strict=True):
            unit.restore(state)

    def free_states(self) -> None:
        """Give back the memory of the states."""
        for unit, state in zip(self.members, self._states, strict=False):  # saving may have failed
            unit.free(state)
        self._states = []

    def accept(
        self,
        accelerations: tuple[Cubics, Knots],
        forces: tuple[Cubics, Knots],
        time: float,
        step: float,
    ) -> None:
        """Take over the signals of a finished step: their cubics and their ends.

        Raises:
            SimulationError: a force is not finite.
        """
        for value, name in zip(forces[1][:, 0].tolist(), self.force_names, strict=True):
            if not isfinite(value):
                raise SimulationError(
                    f"{name} is not finite at t = {time + step:g} s: the coupling diverged; "
                    'use scheme = "iterated" or smaller steps'
                )
        self.has_no_past = False
        self.accelerations.accept(*accelerations, step)
        self.forces.accept(*forces, step)

    def drop_past(self) -> None:
        """Drop what the signals did before now: it says nothing of what comes."""
        self.accelerations.drop_past()
        self.forces.drop_past()
        self.has_no_past = True

    def restart(self, changes: Mapping[str, Mapping[str, float | bool]]) -> None:
        """Reset every unit with its start values (`changes` by unit name override the scene's).

        Leaves the units in initialisation mode with the added masses handed to the rotor.
        """
        masses: dict[str, float] = {}
        self.accelerations.largest[:] = self.forces.largest[:] = 0.0
        carried = {c.source.unit: c for c in self.plan.of_kind("mass")}
        for one in reversed(self.plan.units):  # the rotor last: it needs the others' masses
            unit = self.units[one.name]
            start = {**one.start, **changes.get(one.name, {})}
            if unit is self.rotor:
                start |= masses
            unit.restart(start)
            if one.name in carried:
                source, target = carried[one.name].source, carried[one.name].target.variable
                mass = unit.get(unit.group([source.variable]))[0]
                masses[target] = masses.get(target, 0.0) + mass
