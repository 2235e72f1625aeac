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
from dataclasses import dataclass
from itertools import pairwise

from ...errors import SceneError, SimulationError
from ...master.cosimulation import CoSimulation
from ...master.fmu import Fmu, Variables
from ...master.plan import ROTOR, Plan, Port, plan
from ...master.recorder import Recorder
from ...master.schedule import milestones, schedule
from ...master.start import shown_at_start
from ...master.unit_files import find_or_build
from ...scene import Scene
from .runner import TimedRun


@dataclass
class Member:
    """A unit with everything that it shows others, and everything that it is told.

    Attributes:
        outputs, inputs: their variables; one call reads or writes them all.
        shows: what the outputs are, in their order.
        told: for every input, what its value is the sum of.
    """

    unit: Fmu
    outputs: Variables
    inputs: Variables
    shows: list[Port]
    told: list[list[Port]]


class FixedAxesRunner:
    """A scene at its steps, its units side by side on held signals along fixed axes.

    Raises:
        SimulationError: a signal to be recorded is only in units that turn with the rotor.
    """

    def __init__(self, scene: Scene, names: Sequence[str]) -> None:
        self._scene, self._names = scene, list(names)
        self._plan = plan(scene, frame="fixed")
        with ExitStack() as stack:
            paths = find_or_build(self._plan.units)
            self._units = {
                one.name: stack.enter_context(Fmu(path, one.name))
                for path, one in zip(paths, self._plan.units, strict=True)
            }
            self._members = [_member(self._plan, unit) for unit in self._units.values()]
            self._driven = [
                (self._units[one.name], self._units[one.name].group(["speed", "acceleration"]))
                for one in self._plan.units
                if one.driven
            ]
            turning = stack.enter_context(CoSimulation(scene))
            turning.start()
            self._masses = dict(turning.system.masses)
            self._first = _at_the_start(self._plan, turning)
            self._stack = stack.pop_all()

    def run(self) -> TimedRun:
        try:
            recorder = Recorder(self._units, self._names)
        except SceneError as error:
            raise SimulationError(f"units along fixed axes: {error}") from error
        begun = clock.process_time()
        for one in self._plan.units:
            masses = self._masses if one.name == ROTOR else {}
            self._units[one.name].restart({**one.start, **masses})
            self._units[one.name].start()
        self._shown = dict(self._first)
        recorder.take(0.0)
        begin, parts = 0.0, schedule(self._scene)
        for (step, count), bound in zip(parts, milestones(self._scene), strict=True):
            ends = [begin + number * step for number in range(1, count)]
            for time, end in pairwise([begin, *ends, bound]):
                self._step(time, step)
                recorder.take(end)
            begin = bound
        seconds = clock.process_time() - begun
        return TimedRun(seconds, *recorder.columns(), sum(count for _, count in parts))

    def _step(self, time: float, step: float) -> None:
        """All units step on what the others showed at the end of the step before."""
        profile = self._scene.profile()
        drive = profile.speed(time), profile.acceleration(time)
        for unit, group in self._driven:
            unit.set(group, drive)
        for member in self._members:
            if member.told:
                values = [sum(self._shown[port] for port in ports) for ports in member.told]
                member.unit.set(member.inputs, values)
            member.unit.step(time, step)
        for member in self._members:
            if member.shows:
                values = member.unit.get(member.outputs)
                self._shown.update(zip(member.shows, values, strict=True))

    def close(self) -> None:
        self._stack.close()


def _member(plan: Plan, unit: Fmu) -> Member:
    """A unit with its ends of the plan's connections."""
    wires = plan.inputs("signal", "value")
    told = {target: sources for target, sources in wires.items() if target.unit == unit.name}
    every = [source for sources in wires.values() for source in sources]
    shows = list(dict.fromkeys(source for source in every if source.unit == unit.name))
    outputs, inputs = ([port.variable for port in ports] for ports in (shows, told))
    return Member(unit, unit.group(outputs), unit.group(inputs), shows, list(told.values()))


def _at_the_start(plan: Plan, turning: CoSimulation) -> dict[Port, float]:
    """Every output at the start, from the same units turning with the rotor."""
    turn = cmath.rect(1.0, turning.scene.run.initial.angle)
    first = shown_at_start(plan, turning, turn)
    for connection in plan.of_kind("value"):
        source = connection.source
        first[source] = turning.read(source.unit, [source.variable])[0]
    return first
