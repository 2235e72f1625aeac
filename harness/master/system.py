"""The coupled units: rotor, balancers, and the signals between them at the present time.

What a scheme needs of them: `rotor_pass`, `balancer_pass`, `saved` states, and the signals
(`forces`, `accelerations`) with `accept` at the end of a step.
"""

from __future__ import annotations

from cmath import isfinite
from collections.abc import Callable, Mapping, Sequence
from ctypes import c_void_p
from dataclasses import dataclass

import numpy as np

from ..errors import SimulationError
from .fmu import Fmu, Variables
from .names import components, signals
from .plan import MOTOR, ROTOR, Plan, Port
from .saved_states import SavedStates
from .shaft import Shaft
from .signals import EXACT, Cubic, Knot, SignalState, begun


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
        order: of the exchanged signals, 0, 1, 3 or 5.
        watch: also tell balancers where their plane is that report their clearance.
        brief: step that is taken whole [s]: units that can end longer ones at an event; 0: none
            does.

    Attributes:
        exchanges: balancers that exchange force, in order; `planes` that they are on.
        shaft: the motor's part, where one drives the rotor.
        forces: of the exchanges, and then the shaft's acceleration counted as one; `force_names`
            as well.
        accelerations: of every plane that exchanges force; `acceleration_names` as well.
        pushed: what the rotor is told as reals, (order + 1, planes, 2): forces and derivatives.
        felt: what it answers, (2, planes, 2) with slopes: accelerations and their slopes; with
            order 5 (3, planes, 2).
        told, answers: the same of the balancers, (exchanges, order + 1, 2), (exchanges, 2, 2); of
            the shaft a last row of `answers`.
        parts: of a signal's end: value and slope, with order 5 the second derivative.
        masses: added mass handed to the rotor at the start, by its input [kg].
        has_no_past: no step has been taken since the start or the last jump of the drive.
        tell_speed: tells the units the rotor's speed at a time [s], where it varies.
    """

    def __init__(
        self,
        plan: Plan,
        units: Mapping[str, Fmu],
        order: int,
        watch: bool = True,
        brief: float = 0.0,
    ) -> None:
        self.plan, self.units, self.order, self.has_no_past = plan, dict(units), order, True
        self.rotor = units[ROTOR]
        self.balancers = [unit for name, unit in units.items() if name not in (ROTOR, MOTOR)]
        self.masses: dict[str, float] = {}
        self.brief = brief
        self.tell_speed: Callable[[float], object] = lambda time: None
        self.parts = EXACT[max(3, order)] + 1
        self._connect_planes()
        self.shaft = Shaft(plan, units, order) if MOTOR in units else None
        self.members = [self.rotor, *(e.unit for e in self.exchanges)]
        if self.shaft:
            self.forces.append(self.shaft.spin)
            self.force_names.append(self.shaft.name)
            self.members.append(self.shaft.motor)
        self._spare: list[SavedStates] = []
        self.watched: list[tuple[Fmu, Variables, Variables]] = []
        if watch:
            self._follow_places()
        self._driven = [
            (units[one.name], units[one.name].group(["speed", "acceleration"]))
            for one in plan.units
            if one.driven
        ]

    @property
    def coupled(self) -> bool:
        """Whether there is a loop: something is assumed for a step and answered at its end."""
        return bool(self.forces)

    def _connect_planes(self) -> None:
        """Connect forces and accelerations of rotor and balancers, over buffers that they share."""
        plan, units, order, slopes = self.plan, self.units, self.order, EXACT[self.order]
        exchanged = plan.of_kind("signal")
        followed = {c.target.unit: c.source.variable for c in exchanged if c.source.unit == ROTOR}
        pushed = {c.source.unit: c.target.variable for c in exchanged if c.target.unit == ROTOR}
        names = {pushed[unit]: followed[unit] for unit in pushed}  # by a plane's force
        # in the order in which the rotor declares them they are one slice
        planes = sorted(
            names, key=lambda name: self.rotor.reference(components(name, plan.axes)[0])
        )
        self._forces = self.rotor.group(signals(planes, order, plan.axes))
        # the values of all planes, then the slopes of all planes: of each plane a column
        self.pushed = self._forces.reals
        self._force_rows = self._forces.vectors.reshape(order + 1, len(planes)).T
        felt = [names[force] for force in planes]
        self._accelerations = self.rotor.group(signals(felt, slopes, plan.axes))
        self.felt = self._accelerations.reals
        self.acceleration_names = [f"{ROTOR}.{name}" for name in felt]
        self.accelerations = [SignalState() for _ in planes]
        told = np.zeros((len(pushed), 2 * (order + 1)))
        answers = np.zeros((len(pushed) + (MOTOR in units), 2 * (slopes + 1)))
        self.told, self.answers = told.reshape(-1), answers.reshape(-1)
        self._answer_rows = answers.view(complex)
        self.exchanges = [
            Exchange(
                units[name],
                planes.index(force),
                units[name].group(signals(["a"], order, plan.axes), its_told),
                units[name].group(signals(["F"], slopes, plan.axes), its_answers),
            )
            for (name, force), its_told, its_answers in zip(
                pushed.items(), told, answers, strict=False
            )
        ]
        self.planes = tuple(exchange.plane for exchange in self.exchanges)
        self._alone = self.planes == tuple(range(len(planes)))
        self.forces = [SignalState() for _ in self.exchanges]
        self.force_names = [f"{exchange.unit.name}.F" for exchange in self.exchanges]

    def _follow_places(self) -> None:
        """Connect what balancers are told of their plane's place."""
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

    def rotor_pass(self, forces: Sequence[Cubic], time: float, step: float) -> list[Knot]:
        """Step the rotor under the cubics of `forces`; accelerations of the planes."""
        if self.shaft:
            self.shaft.tell(forces[-1], step)
        self._sum_forces(forces)
        self.step_rotor(time, step)
        return self._knots(self._accelerations.vectors.tolist())

    def step_rotor(self, time: float, step: float) -> None:
        """Step the rotor as it is `pushed`; `felt` is what it answers."""
        if not self.exchanges:
            self.rotor.step(time, step)
            return
        self.rotor.exchange(self._forces, self._accelerations, time, step)

    def balancer_pass(self, accelerations: Sequence[Cubic], time: float, step: float) -> list[Knot]:
        """Step every exchanging balancer under its plane's acceleration; what `forces` become."""
        for exchange in self.exchanges:
            cubic = accelerations[exchange.plane]
            exchange.inputs.vectors[:] = cubic if self.order >= 3 else self._used(cubic)
        self.step_balancers(time, step)
        return self.ends()[: len(self.forces)]

    def step_balancers(self, time: float, step: float) -> None:
        """Step every exchanging balancer as it is `told`; `answers` are what they answer."""
        for exchange in self.exchanges:
            if exchange.place:
                source, target = exchange.place
                self.rotor.fetch(source)
                exchange.unit.send(target)
            exchange.unit.exchange(exchange.inputs, exchange.outputs, time, step)
        if self.shaft:
            self._answer_rows[-1] = self.shaft.step(time, step)[: EXACT[self.order] + 1]

    def ends(self) -> list[Knot]:
        """Ends of `forces`, and then of `accelerations`, of the step that was taken last."""
        forces = [knot for row in self._answer_rows.tolist() for knot in self._knots(row)]
        return forces + self._knots(self._accelerations.vectors.tolist())

    def answer(self, accelerations: Sequence[Cubic]) -> list[Knot]:
        """What `forces` are of units in initialisation mode under accelerations of the planes."""
        for exchange in self.exchanges:
            exchange.unit.set_vectors(exchange.inputs, self._used(accelerations[exchange.plane]))
        knots = [k for e in self.exchanges for k in self._knots(e.unit.get_vectors(e.outputs))]
        return [*knots, self.shaft.begin()] if self.shaft else knots

    def set_forces(self, forces: Sequence[Cubic]) -> None:
        """Write the sum of the forces on every plane that exchanges force, and how it turns."""
        if self.shaft:
            self.shaft.tell(forces[-1])
        self._sum_forces(forces)
        self.rotor.send(self._forces)

    def _sum_forces(self, forces: Sequence[Cubic]) -> None:
        rows = self._force_rows
        if self._alone:
            for plane, cubic in enumerate(forces[: len(rows)]):
                rows[plane] = cubic if self.order >= 3 else self._used(cubic)
        else:
            rows[:] = 0.0
            for exchange, cubic in zip(self.exchanges, forces, strict=False):
                rows[exchange.plane] += self._used(cubic)

    def read_accelerations(self) -> list[Knot]:
        """Acceleration and slope of every plane that exchanges force."""
        return self._knots(self.rotor.get_vectors(self._accelerations))

    def _used(self, cubic: Cubic) -> Sequence[complex]:
        """What of a cubic the units are told."""
        return cubic[: self.order + 1]

    def _knots(self, vectors: Sequence[complex]) -> list[Knot]:
        """Signals' ends, from all their values and then, where they are exchanged, all slopes."""
        if not self.order:
            return [(value, 0j) for value in vectors]
        if len(vectors) == self.parts:
            return [tuple(vectors)]
        count = len(vectors) // self.parts
        if self.parts == 2:
            return list(zip(vectors[:count], vectors[count:], strict=True))
        slopes, seconds = vectors[count : 2 * count], vectors[2 * count :]
        return list(zip(vectors[:count], slopes, seconds, strict=True))

    def present(self) -> dict[Port, complex]:
        """Present values of the coupling signals by their source."""
        values = {
            Port(e.unit.name, "F"): f.now[0]
            for e, f in zip(self.exchanges, self.forces, strict=False)
        }
        for name, state in zip(self.acceleration_names, self.accelerations, strict=True):
            values[Port(ROTOR, name.removeprefix(f"{ROTOR}."))] = state.now[0]
        return values

    def drive(self, speed: float, acceleration: float) -> None:
        """Tell every unit that needs it the speed at the start of a step and its rate of change."""
        for unit, group in self._driven:
            unit.set(group, (speed, acceleration))

    def saved(self) -> SavedStates:
        """States of all members of the coupling loop, for `restore`: `with system.saved() as s`."""
        return self._spare.pop() if self._spare else SavedStates(self.members, self._spare)

    def free_states(self) -> None:
        """Give back the memory of saved states."""
        while self._spare:
            self._spare.pop().free()

    def restore(self, states: Sequence[c_void_p]) -> None:
        """Roll all members back."""
        for unit, state in zip(self.members, states, strict=True):
            unit.restore(state)

    def accept(
        self,
        accelerations: Sequence[tuple[Cubic, Knot]],
        forces: Sequence[tuple[Cubic, Knot]],
        time: float,
        step: float,
    ) -> None:
        """Take over the signals of a finished step.

        Raises:
            SimulationError: a signal is not finite.
        """
        for state, (cubic, end) in zip(self.accelerations, accelerations, strict=True):
            state.move(cubic, end, step)
        for state, (cubic, end) in zip(self.forces, forces, strict=True):
            state.move(cubic, end, step)
        self.accepted(time + step)

    def accepted(self, time: float) -> None:
        """The signals have moved on to a time [s].

        Raises:
            SimulationError: a force is not finite.
        """
        self.has_no_past = False
        if self.shaft:
            self.shaft.accept()
        for force, name in zip(self.forces, self.force_names, strict=True):
            if not isfinite(force.now[0]):
                raise SimulationError(
                    f"{name} is not finite at t = {time:g} s: the coupling diverged; "
                    'use scheme = "iterated" or smaller steps'
                )

    def drop_past(self) -> None:
        """Drop what the signals did before now: it says nothing of what comes."""
        for state in [*self.accelerations, *self.forces]:
            state.last, state.last_step = begun(state.now), 0.0
        self.has_no_past = True

    def restart(self, changes: Mapping[str, Mapping[str, float | bool]]) -> None:
        """Reset every unit with its start values (`changes` by unit name override the scene's).

        Leaves the units in initialisation mode with the added masses handed to the rotor.
        """
        self.masses = {}
        carried = {c.source.unit: c for c in self.plan.of_kind("mass")}
        for one in reversed(self.plan.units):  # the rotor last: it needs the others' masses
            unit = self.units[one.name]
            start = {**one.start, **changes.get(one.name, {})}
            if unit is self.rotor:
                start |= self.masses
            if self.brief and self.coupled and not unit.runs_python:
                stops = {"stop_at_contact": True, "shortest_stopped_step": 1.5 * self.brief}
                start |= {name: stops[name] for name in stops if name in unit.variables}
            unit.restart(start)
            if one.name in carried:
                source, target = carried[one.name].source, carried[one.name].target.variable
                mass = unit.get(unit.group([source.variable]))[0]
                self.masses[target] = self.masses.get(target, 0.0) + mass
        if self.shaft:
            self.shaft.restart()
