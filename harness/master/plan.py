"""The plan of a scene: which units it needs, what they start from, and what is connected to what.

Everything that couples or exports the units reads it: the master, the runs along fixed axes, other
masters.
"""

from __future__ import annotations

import atexit
import math
import shutil
import tempfile
import threading
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Literal, NamedTuple

from fmpy import platform_tuple

from ...fmus.build import build, is_present_build, options_of
from ...fmus.catalogue import sized_unit
from ..errors import UnitError
from ..scene import Scene
from ..scene.balancer import Balancer
from ..scene.run import LimitedMotor
from .fmu import described, measured_in
from .names import AXES, by_unit, components, plane, stations
from .runtime import Backend, runtime

ROTOR, MOTOR = "rotor", "motor"
_BUILDING = threading.Lock()  # a unit is built once, however many threads want it
Kind = Literal["signal", "value", "mass", "torque", "spin"]


@dataclass(frozen=True)
class UnitPlan:
    """One unit of a scene.

    Attributes:
        name: of the instance; signals and messages begin with it.
        model: the FMU's.
        sizes: options to build it with.
        start: parameters and start values.
    """

    name: str
    model: str
    sizes: Mapping[str, Any]
    start: Mapping[str, float | bool]

    @property
    def driven(self) -> bool:
        """Whether it is told the rotor's speed and acceleration."""
        return "speed" in self.start

    @property
    def meets(self) -> bool:
        """Whether it has weights that can touch or stick, which take no change of w' in a step."""
        return any(self.start.get(key) for key in ("weight_radius", "rolling_resistance"))

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
            point, `mass` is one number at the start; `torque` has slopes, and `spin` as well, with
            the speed beside it.
    """

    source: Port
    target: Port
    kind: Kind


@dataclass(frozen=True)
class Plan:
    """Units and connections of a scene: the rotor first, then the balancers in order.

    Attributes:
        planes: of the rotor's unit on which the balancers are, from 1, by their names.
        axes: of the coupling signals.
        spin_scale: what makes a force of an angular acceleration, so that both are compared with
            one measure: sqrt(I M), inertia that turns and mass of the loaded rotor [kg m].
    """

    units: tuple[UnitPlan, ...]
    connections: tuple[Connection, ...]
    planes: Mapping[str, int]
    axes: tuple[str, str] = AXES["rotor"]
    spin_scale: float = 1.0

    @property
    def files(self) -> tuple[str, ...]:
        """Names of the FMU files, each once."""
        return tuple(dict.fromkeys(unit.file_name for unit in self.units))

    def variables_by_unit(self) -> dict[str, list[str]]:
        """Names of all variables of the units, as they are built."""
        layouts = {unit.name: sized_unit(unit.model, **unit.sizes).layout for unit in self.units}
        return {name: [v.name for v in layout.variables] for name, layout in layouts.items()}

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
            names = components(port.variable, self.axes)
        return [Port(port.unit, name) for name in names]


def plan(scene: Scene, frame: str = "rotor", order: int | None = None) -> Plan:
    """The units a scene needs and no others, and their connections.

    Args:
        frame: of the coupling signals, "rotor", or "fixed" as most tools have them.
        order: of the coupling signals; by default the scene's.
    """
    profile, motor = scene.profile(), scene.operation.motor
    speed = motor.start if motor else profile.speed(0.0)
    drive = {"speed": speed, "acceleration": profile.acceleration(0.0)}
    built: dict[str, Any] = {} if frame == "rotor" else {"frame": frame}
    built |= {"order": 5} if (order or scene.coupling.order) == 5 else {}
    planes = scene.rotor.unit_planes([balancer.at for balancer in scene.balancer])
    start = {
        f"{'' if name == 'angle' else prefix}{name}0": value
        for name, value in scene.run.initial
        for prefix in stations(len(scene.rotor.stations))
    }
    field = scene.operation.field
    gravity = {"gravity_x": field.real, "gravity_y": field.imag}
    rotor = UnitPlan(
        ROTOR,
        scene.rotor.model,
        {**scene.rotor.sizes(planes), **built},
        {**scene.rotor.start(planes), **gravity, **start, **drive},
    )
    loaded = scene.assembly().loaded_rotor
    balancers = [
        UnitPlan(
            balancer.label,
            balancer.model,
            {**balancer.sizes(), **built},
            {**balancer.start(loaded), **(drive if balancer.driven else {})},
        )
        for balancer in scene.balancer
    ]
    number = {balancer.label: planes.index(balancer.at) + 1 for balancer in scene.balancer}
    connections = [
        connection
        for balancer in scene.balancer
        for connection in _connections(balancer, number[balancer.label], frame)
    ]
    units, scale = [rotor, *balancers], 1.0
    if motor:
        scale = math.sqrt(motor.inertia * float(scene.assembly().loaded_rotor.mass.sum()))
        connections += _shaft(units)
        units.append(_motor(motor, scene.run.initial.angle))
    return Plan(tuple(units), tuple(connections), number, AXES[frame], scale)


def _motor(motor: LimitedMotor, angle: float) -> UnitPlan:
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


def _connections(balancer: Balancer, number: int, frame: str) -> Iterator[Connection]:
    """Of a balancer on plane `number` of the rotor's unit."""
    name = balancer.label
    if balancer.exchanges_force:
        yield Connection(Port(ROTOR, plane(number, "a")), Port(name, "a"), "signal")
        yield Connection(Port(name, "F"), Port(ROTOR, plane(number, "F")), "signal")
    for variable in balancer.follows:
        yield Connection(Port(ROTOR, plane(number, variable)), Port(name, variable), "value")
    if frame == "fixed" and balancer.driven:
        yield Connection(Port(ROTOR, "angle"), Port(name, "angle"), "value")
    mass = "added_mass"
    yield Connection(Port(name, mass), Port(ROTOR, plane(number, mass)), "mass")


@cache
def _built(backend: Backend) -> Path:
    """Directory of the FMUs built by this process, removed when it ends."""
    directory = Path(tempfile.mkdtemp(prefix="autobalancer-units-"))
    atexit.register(shutil.rmtree, directory, ignore_errors=True)
    return directory


def find_or_build(
    units: Iterable[UnitPlan], fmus: Path | None = None, backend: Backend | None = None
) -> list[Path]:
    """The FMU file of every unit: found in `fmus`, or built once a process, for this machine.

    Args:
        backend: of those that are built; by default native ones where they can be had.

    Raises:
        UnitError: `fmus` is given and lacks a file, or has one of a different build.
    """
    if fmus is not None:
        return [_found(unit, fmus) for unit in units]
    backend = backend or runtime("native").backend
    platforms = [platform_tuple] if backend == "native" else None
    with _BUILDING:
        paths = [(unit, _built(backend) / unit.file_name) for unit in units]
        for unit, path in paths:
            if not path.exists():
                build(unit.model, path, backend=backend, platforms=platforms, **unit.sizes)
    return [path for _, path in paths]


def _found(unit: UnitPlan, fmus: Path) -> Path:
    candidates = [fmus / unit.file_name, fmus / f"{unit.model}.fmu"]
    for candidate in candidates:
        if candidate.is_file():
            refuse_other_build(candidate, unit)
            return candidate
    raise UnitError(
        f"{fmus}: no FMU for {unit.name!r}: expected {candidates[0].name} or "
        f"{candidates[1].name}; `autobalancer build -o {fmus} SCENE` makes them"
    )


def signal_units(units: Iterable[UnitPlan], names: Iterable[str]) -> dict[str, str]:
    """What signals are measured in, as the units' FMUs declare it; nothing is loaded."""
    units = list(units)
    declared = {
        unit.name: measured_in(described(path))
        for unit, path in zip(
            units, find_or_build(units, None, runtime("native").backend), strict=True
        )
    }
    wanted = by_unit(names)
    return {f"{name}.{v}": declared[name][v] for name in wanted for v in wanted[name]}


def refuse_other_build(path: Path, unit: UnitPlan) -> None:
    """Raise UnitError where an FMU is not what this installation would build for a unit.

    An FMU of other sizes, or of older equations, would run along unseen, and a library that was
    damaged takes the process with it: nothing of the file is loaded before.
    """
    try:
        if is_present_build(path, unit.model, **unit.sizes):
            return
        built = options_of(path)
    except ValueError as error:
        raise UnitError(str(error)) from error
    except OSError as error:
        raise UnitError(f"{path}: cannot be read: {error.strerror or error}") from error
    different = [
        f"{key} = {built[key]} instead of {value}"
        for key, value in {
            "unit": unit.model,
            "frame": "rotor",
            "order": 3,
            **unit.sizes,
        }.items()
        if key in built and built[key] != value
    ]
    why = "its content is not what this installation builds"
    if different:
        why = f"it was built with {', '.join(different)}"
    elif not built:
        why = "it is not from `autobalancer build`"
    raise UnitError(
        f"{path}: is of a different build than {unit.name!r} of this scene needs: {why}; build "
        "it for this scene"
    )
