"""The plan of a scene: which units it needs, what they start from, and what is connected to what.

Everything that couples or exports the units reads it.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple

from ...fmus.catalogue import sized_unit
from ..scene import Scene
from ..scene.balancer import Balancer
from ..scene.begin import begins_apart, motion_of_points
from ..scene.pushed import pushes
from ..scene.rotor import Rotor
from ..scene.run import Motor
from .names import components, plane, readable, stations
from .schedule import end_time, step_size

ROTOR, MOTOR = "rotor", "motor"
Kind = Literal["signal", "value", "mass", "torque", "spin"]


@dataclass(frozen=True)
class UnitPlan:
    """One unit of a scene.

    Attributes:
        name: of the instance; signals and messages begin with it.
        model: the FMU's.
        sizes: options to build it with.
        start: parameters and start values.
        fmu: file of another origin that steps it; empty: ours.
    """

    name: str
    model: str
    sizes: Mapping[str, Any]
    start: Mapping[str, float | bool]
    fmu: str = ""

    @property
    def driven(self) -> bool:
        """Whether it is told the rotor's speed and acceleration."""
        return "speed" in self.start

    @property
    def file_name(self) -> str:
        """Name of the FMU file it is built as, such as `BallBalancer-weights-3.fmu`."""
        return "-".join([self.model, *(f"{k}-{v}" for k, v in sorted(self.sizes.items()))]) + ".fmu"


class Port(NamedTuple):
    """A variable of a unit; of a coupling signal its name without the axis."""

    unit: str
    variable: str


@dataclass(frozen=True)
class Connection:
    """An output and the input that it feeds; inputs with several connections take their sum.

    Attributes:
        kind: `signal` has two components and slopes, `value` is one number at every communication
            point, `mass` is one number at the start.  `torque` is one number with its slope;
            `spin` is one number with slopes, and the speed comes with it.
    """

    source: Port
    target: Port
    kind: Kind


@dataclass(frozen=True)
class Plan:
    """Units and connections of a scene: the rotor first, the balancers in order, and a motor.

    Attributes:
        planes: of the rotor's unit on which the balancers are, from 1, by their names.
        pushed: of the rotor's unit on which forces from outside act, by kind and number of the
            place.
        spin_scale: makes a force of an angular acceleration, so that one measure compares both:
            sqrt(I M) of the inertia that turns and the mass of the loaded rotor [kg m].
    """

    units: tuple[UnitPlan, ...]
    connections: tuple[Connection, ...]
    planes: Mapping[str, int]
    pushed: Mapping[tuple[str, int], int] = field(default_factory=dict)
    spin_scale: float = 1.0

    @property
    def files(self) -> tuple[str, ...]:
        """Names of the FMU files, each once."""
        return tuple(dict.fromkeys(unit.file_name for unit in self.units))

    def signal_units(self, names: Iterable[str]) -> dict[str, str]:
        """What signals are measured in, as the units declare it."""
        layouts = [(unit.name, sized_unit(unit.model, **unit.sizes).layout) for unit in self.units]
        declared = {f"{n}.{v.name}": readable(v.unit) for n, each in layouts for v in each.reals}
        return {name: declared[name] for name in names}

    def of_kind(self, kind: Kind) -> list[Connection]:
        """Connections of one kind."""
        return [c for c in self.connections if c.kind == kind]

    def inputs(self, *kinds: Kind) -> dict[Port, list[Port]]:
        """Every single input with the outputs whose sum it takes; slopes are left out."""
        sources_of: dict[Port, list[Port]] = {}
        for c in self.connections:
            if c.kind in kinds:
                ends = self.variables(c.source, c.kind), self.variables(c.target, c.kind)
                for source, target in zip(*ends, strict=True):
                    sources_of.setdefault(target, []).append(source)
        return sources_of

    def variables(self, port: Port, kind: Kind) -> list[Port]:
        """The single variables of a port: two of a signal."""
        names = [port.variable]
        if kind == "signal":
            names = components(port.variable)
        return [Port(port.unit, name) for name in names]


def plan(scene: Scene) -> Plan:
    """The units a scene needs and no others, and their connections."""
    profile, motor = scene.profile(), scene.operation.motor
    speed = scene.operation.start_speed
    drive = {"speed": speed, "acceleration": profile.acceleration(0.0)}
    table, pushed = _with_pushed(scene)
    planes = table.unit_planes([*(balancer.at for balancer in scene.balancer), *pushed.values()])
    loaded = scene.assembly().loaded_rotor
    field, waves = scene.operation.field, _waves(scene, speed)
    gravity = {"gravity_x": field.real, "gravity_y": field.imag}
    held = table.restraint_start()
    if scene.operation.gravity:
        held |= table.stroke_centres(scene.rest_at(speed))
    rotor = UnitPlan(
        ROTOR,
        scene.rotor.model,
        table.sizes(planes),
        {**table.start(planes), **held, **gravity, **_initial(scene, speed), **drive},
        scene.rotor.fmu or "",
    )
    balancers = [
        UnitPlan(
            balancer.label,
            balancer.model,
            balancer.sizes(),
            {
                **balancer.start(loaded),
                **waves.get(balancer.label, {}),
                **(drive if balancer.driven else {}),
            },
            balancer.fmu or "",
        )
        for balancer in scene.balancer
    ]
    number = {balancer.label: planes.index(balancer.at) + 1 for balancer in scene.balancer}
    connections = [
        connection
        for balancer in scene.balancer
        for connection in _connections(balancer, number[balancer.label])
    ]
    units, scale = [rotor, *balancers], 1.0
    if motor:
        scale = math.sqrt(motor.inertia * float(loaded.mass.sum()))
        connections += _shaft(units)
        units.append(_motor(motor, scene.run.initial.angle))
    places = {place: planes.index(at) + 1 for place, at in pushed.items()}
    return Plan(tuple(units), tuple(connections), number, places, scale)


def _with_pushed(scene: Scene) -> tuple[Rotor, dict[tuple[str, int], int]]:
    """The rotor with a plane wherever connections push on it, and these planes by place."""
    rotor, found = scene.rotor, dict[tuple[str, int], int]()
    for push in pushes(scene.connection):
        if push.kind == "plane" or rotor.fmu:
            continue  # a plane of the unit, or a port of an FMU of another origin
        station = rotor.supports[push.number - 1] if push.kind == "support" else push.number
        rotor, found[push.kind, push.number] = rotor.plane_at(station)
    return rotor, found


def _initial(scene: Scene, speed: float) -> dict[str, float]:
    """The rotor's start values: `run.initial`, counted from the sag under gravity."""
    prefixes = stations(len(scene.rotor.points))
    start = {
        f"{'' if name == 'angle' else prefix}{name}0": value
        for name, value in scene.run.initial
        for prefix in prefixes
    }
    if begins_apart(scene):
        parts = zip(("x", "y", "vx", "vy"), motion_of_points(scene).tolist(), strict=True)
        for name, values in parts:
            for prefix, value in zip(prefixes, values, strict=True):
                start[f"{prefix}{name}0"] = value
    if scene.operation.gravity:
        sag = scene.rest_at(speed)
        for axis, at_rest in zip("xy", sag.tolist(), strict=True):
            for prefix, value in zip(prefixes, at_rest[: len(prefixes)], strict=True):
                start[f"{prefix}{axis}0"] += value
    return start


def _waves(scene: Scene, speed: float) -> dict[str, dict[str, float]]:
    """Start values of rings of liquid, at rest in fixed axes under gravity."""
    assembly = scene.assembly()
    if not (assembly.rings and scene.operation.gravity):
        return {}
    x, y = scene.rest_at(speed)[:, assembly.rotor.stations :]
    turned: list[complex] = ((x + 1j * y) * cmath.rect(1.0, -scene.run.initial.angle)).tolist()
    found = {}
    for mounted, wave in zip(assembly.rings, turned, strict=True):
        rate = -1j * speed * wave
        found[mounted.name] = {
            "wave_xi0": wave.real, "wave_eta0": wave.imag,
            "wave_speed_xi0": rate.real, "wave_speed_eta0": rate.imag,
        }  # fmt: skip
    return found


def about(unit: UnitPlan, scene: Scene) -> dict[str, Any]:
    """What the description of a unit with a scene's start values says."""
    said = f"{unit.model} with the values of {unit.name} in: {scene.heading}"
    return {"summary": said, "stop": end_time(scene), "step": step_size(scene)}


def _motor(motor: Motor, angle: float) -> UnitPlan:
    points = enumerate(motor.points, start=1)
    line = {
        f"point[{k}].{what}": value
        for k, point in points
        for what, value in zip(("speed", "torque"), point, strict=True)
    }
    start = {"inertia": motor.inertia, **line, "angle0": angle, "speed0": motor.start}
    return UnitPlan(MOTOR, "Motor", {"points": len(motor.points)}, start)


def _shaft(units: Iterable[UnitPlan]) -> Iterator[Connection]:
    """Of a motor with all that it drives."""
    for unit in units:
        if unit.driven:
            yield Connection(Port(unit.name, "torque"), Port(MOTOR, "torque"), "torque")
            yield Connection(Port(MOTOR, "acceleration"), Port(unit.name, "acceleration"), "spin")


def _connections(balancer: Balancer, number: int) -> Iterator[Connection]:
    """Of a balancer on plane `number` of the rotor's unit."""
    name = balancer.label
    if balancer.exchanges_force:
        yield Connection(Port(ROTOR, plane(number, "a")), Port(name, "a"), "signal")
        yield Connection(Port(name, "F"), Port(ROTOR, plane(number, "F")), "signal")
    for variable in balancer.follows:
        yield Connection(Port(ROTOR, plane(number, variable)), Port(name, variable), "value")
    mass = "added_mass"
    yield Connection(Port(name, mass), Port(ROTOR, plane(number, mass)), "mass")
