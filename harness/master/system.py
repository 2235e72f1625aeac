"""The coupled units: rotor, balancers, and the signals between them at the present time."""

from __future__ import annotations

from cmath import isfinite
from collections.abc import Mapping, Sequence
from ctypes import c_void_p
from dataclasses import dataclass, field

from ..errors import SimulationError
from .fmu import Group, Unit
from .plan import UnitPlan, signals
from .signals import REST, Cubic, End, end_of

ZERO: End = (0j, 0j)


@dataclass(slots=True)
class Track:
    """One coupling signal: its present end, and the cubic and length of the step before.

    Attributes:
        missed: how far the last step ended from where the cubic before it led, steps being equal.
        largest: modulus of the largest value so far.
    """

    now: End = ZERO
    past: Cubic = REST
    past_step: float = 0.0
    missed: float = 0.0
    largest: float = 0.0

    def move(self, cubic: Cubic, end: End, step: float) -> None:
        """Accept the signal of a finished step."""
        value = end[0]
        self.missed = 0.0
        if self.past_step == step:
            self.missed = abs(value - end_of(self.past, step + step)[0])
        modulus = abs(value)
        if modulus > self.largest:
            self.largest = modulus
        self.now, self.past, self.past_step = end, cubic, step


@dataclass(slots=True)
class Connection:
    """A balancer that exchanges force with a plane of the rotor."""

    unit: Unit
    plane: int  # index into the system's connected planes
    inputs: Group
    outputs: Group
    force: Track = field(default_factory=Track)
    position: tuple[Group, Group] | None = None  # where a liquid's clearance is watched: x, y


class System:
    """Units of a scene with their connections.

    Args:
        units: rotor first, then the balancers.
        plans: the same order.
        planes: plane number (from 1) of every balancer.
        coupled: for every balancer, whether it exchanges force (a liquid whose whole effect is its
            added mass does not).
        order: of the exchanged signals, 0, 1 or 3.
        watch: also tell liquid balancers where their plane is, so that they report their clearance.

    Attributes:
        fresh: no step has been taken since the start or the last jump of the drive.
    """

    def __init__(
        self,
        units: Sequence[Unit],
        plans: Sequence[UnitPlan],
        planes: Sequence[int],
        coupled: Sequence[bool],
        order: int,
        watch: bool = True,
    ) -> None:
        self.order, self.fresh = order, True
        self.rotor, self.balancers = units[0], list(units[1:])
        self.plans, self.planes = list(plans), list(planes)
        self.connected = sorted({p for p, c in zip(planes, coupled, strict=True) if c})
        slopes = 0 if order == 0 else 1
        self._forces = self.rotor.group(
            signals([f"plane[{p}].F_{{}}" for p in self.connected], order)
        )
        self._accelerations = self.rotor.group(
            signals([f"plane[{p}].a_{{}}" for p in self.connected], slopes)
        )
        self.accelerations = [Track() for _ in self.connected]
        self.connections = [
            Connection(
                unit,
                self.connected.index(plane),
                unit.group(signals(["a_{}"], order)),
                unit.group(signals(["F_{}"], slopes)),
            )
            for unit, plane, is_coupled in zip(self.balancers, planes, coupled, strict=True)
            if is_coupled
        ]
        self.watched: list[tuple[Unit, Group, Group]] = []
        for unit, plane in zip(self.balancers, planes, strict=True):
            if watch and "clearance" in unit.variables:
                source = self.rotor.group([f"plane[{plane}].x", f"plane[{plane}].y"])
                self._watch(unit, source, unit.group(["x", "y"]))
        self.members = [self.rotor, *(c.unit for c in self.connections)]
        self._drives = [u.group(["speed", "acceleration"]) for u in units if "speed" in u.variables]
        self._driven = [u for u in units if "speed" in u.variables]

    def _watch(self, unit: Unit, source: Group, target: Group) -> None:
        for connection in self.connections:
            if connection.unit is unit:
                connection.position = (source, target)
                return
        self.watched.append((unit, source, target))

    def follow(self, time: float, step: float) -> None:
        """Step the balancers that exchange no force, once the others have finished the step."""
        for unit, source, target in self.watched:
            unit.set(target, self.rotor.get(source))
            unit.step(time, step)

    def rotor_pass(self, forces: Sequence[Cubic], time: float, step: float) -> list[End]:
        """Step the rotor under one force cubic per connection; accelerations of the planes."""
        if not self.connections:
            self.rotor.step(time, step)
            return []
        self.set_forces(forces)
        self.rotor.step(time, step)
        return self.read_accelerations()

    def balancer_pass(self, accelerations: Sequence[Cubic], time: float, step: float) -> list[End]:
        """Step every connected balancer under its plane's acceleration; their forces."""
        forces = []
        for connection in self.connections:
            self.set_acceleration(connection, accelerations[connection.plane])
            if connection.position:
                source, target = connection.position
                connection.unit.set(target, self.rotor.get(source))
            connection.unit.step(time, step)
            forces.append(self.read_force(connection))
        return forces

    def set_forces(self, forces: Sequence[Cubic]) -> None:
        """Write the sum of the connections' forces on every connected plane."""
        width, used = len(self.connected), self.order + 1
        if len(forces) == 1:
            self.rotor.set_vectors(self._forces, forces[0][:used])
            return
        vectors = [0j] * (width * used)
        for connection, cubic in zip(self.connections, forces, strict=True):
            for k in range(used):
                vectors[connection.plane + k * width] += cubic[k]
        self.rotor.set_vectors(self._forces, vectors)

    def read_accelerations(self) -> list[End]:
        """Acceleration and slope of every connected plane."""
        return _ends(self.rotor.get_vectors(self._accelerations), len(self.connected))

    def set_acceleration(self, connection: Connection, cubic: Cubic) -> None:
        """Write the acceleration signal of one balancer."""
        connection.unit.set_vectors(connection.inputs, cubic[: self.order + 1])

    def read_force(self, connection: Connection) -> End:
        """Force and slope of one balancer."""
        return _ends(connection.unit.get_vectors(connection.outputs), 1)[0]

    def drive(self, speed: float, acceleration: float) -> None:
        """Tell every unit that needs it the speed at the start of a step and its rate of change."""
        for unit, group in zip(self._driven, self._drives, strict=True):
            unit.set(group, (speed, acceleration))

    def save(self) -> list[c_void_p]:
        """States of all members of the coupling loop."""
        return [unit.save() for unit in self.members]

    def restore(self, states: Sequence[c_void_p]) -> None:
        """Roll all members back."""
        for unit, state in zip(self.members, states, strict=True):
            unit.restore(state)

    def free(self, states: Sequence[c_void_p]) -> None:
        """Release saved states."""
        for unit, state in zip(self.members, states, strict=True):
            unit.free(state)

    def accept(
        self,
        accelerations: Sequence[tuple[Cubic, End]],
        forces: Sequence[tuple[Cubic, End]],
        time: float,
        step: float,
    ) -> None:
        """Take over the signals of a finished step.

        Raises:
            SimulationError: a signal is not finite.
        """
        self.fresh = False
        for track, (cubic, end) in zip(self.accelerations, accelerations, strict=True):
            track.move(cubic, end, step)
        for connection, (cubic, end) in zip(self.connections, forces, strict=True):
            connection.force.move(cubic, end, step)
            if not isfinite(end[0]):
                raise SimulationError(
                    f"{connection.unit.name}.F is not finite at t = {time + step:g} s: the "
                    'coupling diverged; use scheme = "iterated" or smaller steps'
                )

    def forget(self) -> None:
        """Drop what the signals did before now: it says nothing of what comes."""
        for track in [*self.accelerations, *(c.force for c in self.connections)]:
            track.past, track.past_step = (*track.now, 0j, 0j), 0.0
        self.fresh = True

    def restart(self, changes: Mapping[str, Mapping[str, float | bool]]) -> None:
        """Reset every unit with its start values (`changes` by unit name override the scene's).

        Leaves the units in initialisation mode with the added masses handed to the rotor.
        """
        added: dict[int, float] = {}
        units = [self.rotor, *self.balancers]
        for unit, unit_plan in list(zip(units, self.plans, strict=True))[::-1]:
            parameters = {**unit_plan.parameters, **changes.get(unit.name, {})}
            if unit is self.rotor:
                parameters |= {f"plane[{p}].added_mass": m for p, m in added.items()}
            unit.restart(parameters)
            if unit is not self.rotor:
                plane = self.planes[self.balancers.index(unit)]
                mass = unit.get(unit.group(["added_mass"]))[0]
                added[plane] = added.get(plane, 0.0) + mass


def _ends(vectors: Sequence[complex], count: int) -> list[End]:
    """Values, then slopes if there are any, of `count` signals."""
    slopes = vectors[count:] or [0j] * count
    return list(zip(vectors[:count], slopes, strict=True))
