"""The same units as most tools couple them: Jacobi, held signals, forces along fixed axes.

The units are built with `frame="fixed"`; a force that turns with the rotor then turns on within a
step during which its value is held.  Added masses, angle and speed are connected as the README
says, and the start is the consistent one, so that the exchange alone is to blame for the error.
"""

from __future__ import annotations

import cmath
import time as clock
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from ..errors import SceneError, SimulationError
from ..master.cosimulation import CoSimulation
from ..master.fmu import Group, Unit
from ..master.plan import plan, ports, provide
from ..master.recorder import Recorder
from ..master.schedule import milestones, schedule
from ..scene import Scene
from .runner import Run

AXES = ("x", "y")
Pair = list[float]


@dataclass
class Port:
    """One output of a unit as one input of others has it: what it showed a step ago.

    Attributes:
        first: its value at the start.
        now: its value at the end of the last step.
    """

    source: Unit
    output: Group
    first: Pair
    now: Pair


class AlongFixedAxes:
    """A scene at its steps, its units side by side on held signals along fixed axes.

    Raises:
        SimulationError: a signal to be recorded is only in units that turn with the rotor.
    """

    def __init__(self, scene: Scene, names: Sequence[str]) -> None:
        self._scene, self._names = scene, list(names)
        fixed = [replace(one, options={**one.options, "frame": "fixed"}) for one in plan(scene)]
        self._parameters = [dict(one.parameters) for one in fixed]
        with ExitStack() as stack:
            directory = stack.enter_context(TemporaryDirectory(prefix="autobalancer-"))
            paths = provide(fixed, Path(directory), None)
            self._units = {
                one.name: stack.enter_context(Unit(path, one.name))
                for one, path in zip(fixed, paths, strict=True)
            }
            self._ports: list[Port] = []
            self._wires: list[tuple[Unit, Group, list[Port]]] = []
            self._connect(stack.enter_context(CoSimulation(scene)))
            self._stack = stack.pop_all()

    def _connect(self, turning: CoSimulation) -> None:
        """Wire the units; the start is that of the units that turn with the rotor."""
        turning.start()
        system, angle = turning.system, self._scene.run.initial.angle
        rotor, turn = self._units["rotor"], cmath.rect(1.0, angle)
        angles = self._port(rotor, ["angle"], [angle])
        pulls: dict[int, list[Port]] = {}
        pulling = {c.unit.name: c for c in system.connections}
        for unit, plane in zip(system.balancers, ports(self._scene), strict=True):
            own, mass = self._units[unit.name], turning.read(unit.name, ["added_mass"])[0]
            carried = f"plane[{plane}].added_mass"
            self._parameters[0][carried] = self._parameters[0].get(carried, 0.0) + mass
            if "angle" in own.variables:
                self._wire(own, ["angle"], [angles])
            if "clearance" in own.variables:
                place = [f"plane[{plane}].{axis}" for axis in AXES]
                self._wire(own, AXES, [self._port(rotor, place, turning.read("rotor", place))])
            if unit.name in pulling:
                c = pulling[unit.name]
                motion = _pair(system.accelerations[c.plane].now[0] * turn)
                felt = self._port(rotor, [f"plane[{plane}].a_{axis}" for axis in AXES], motion)
                self._wire(own, [f"a_{axis}" for axis in AXES], [felt])
                pull = _pair(c.force.now[0] * turn)
                force = self._port(own, [f"F_{axis}" for axis in AXES], pull)
                pulls.setdefault(plane, []).append(force)
        for plane, forces in pulls.items():
            self._wire(rotor, [f"plane[{plane}].F_{axis}" for axis in AXES], forces)
        self._driven = [
            (unit, unit.group(["speed", "acceleration"]))
            for unit in self._units.values()
            if "speed" in unit.variables
        ]

    def _port(self, unit: Unit, names: Sequence[str], first: Pair) -> Port:
        port = Port(unit, unit.group(names), first, first)
        self._ports.append(port)
        return port

    def _wire(self, unit: Unit, names: Sequence[str], sources: list[Port]) -> None:
        self._wires.append((unit, unit.group(names), sources))

    def run(self) -> Run:
        try:
            recorder = Recorder(self._units, self._names)
        except SceneError as error:
            raise SimulationError(f"units along fixed axes: {error}") from error
        begun = clock.perf_counter()
        for unit, parameters in zip(self._units.values(), self._parameters, strict=True):
            unit.restart(parameters)
            unit.start()
        for port in self._ports:
            port.now = port.first
        recorder.take(0.0)
        time, steps = 0.0, 0
        for (step, count), bound in zip(
            schedule(self._scene), milestones(self._scene), strict=True
        ):
            begin = time
            for number in range(1, count + 1):
                self._step(time, step)
                time = begin + number * step if number < count else bound
                recorder.take(time)
            steps += count
        seconds = clock.perf_counter() - begun
        return Run(seconds, *recorder.columns(), steps)

    def _step(self, time: float, step: float) -> None:
        """All units step on what the others showed at the end of the step before."""
        profile = self._scene.profile()
        drive = profile.speed(time), profile.acceleration(time)
        for unit, group in self._driven:
            unit.set(group, drive)
        for unit, group, sources in self._wires:
            unit.set(group, [sum(parts) for parts in zip(*(p.now for p in sources), strict=True)])
        for unit in self._units.values():
            unit.step(time, step)
        for port in self._ports:
            port.now = port.source.get(port.output)

    def close(self) -> None:
        self._stack.close()


def _pair(value: complex) -> Pair:
    return [value.real, value.imag]
