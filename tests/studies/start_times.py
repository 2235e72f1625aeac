"""Runs that start at other times than 0: the same motion, shifted.

`python -m tests.studies.start_times [SCENE ...]` runs every bundled scene as one FMU, FMI 2.0 and
3.0, as co-simulation and, where it has no events, as model exchange, from each of `STARTS`.  Three
comparisons with the run from 0:

* equal steps: the host says the same length of every step.  The same bits.
* points: steps are differences of the host's own times t0 + k h, as FMPy takes them.  Points of the
  two runs differ by the rounding of t0 + k h, an ulp, and an output by what it moves in that time.
* model exchange: the host says times t0 + k h alone.  Without a profile no equation has time in it:
  the same motion.  With one, speed and instants of events differ by the rounding.
"""

from __future__ import annotations

import ctypes
import math
import re
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from fmpy import fmi2, fmi3, platform_tuple
from numpy.typing import NDArray

from autobalancer.harness import Scene, bundled_scenes, load_scene
from autobalancer.models.monolith import equations
from tests.native.packaging import Host

STARTS = (-30.0, -5.0, -0.001, 0.2, 100.0, 1e6)
POINTS = 60  # of a co-simulation
FOLLOWED = 4.0  # times its speed, that the fastest mode has at most in steps of 1/24 revolution
REVOLUTIONS = 25  # of a run with model exchange, unless something happens later
MOVES = 8.0  # ranges of a signal that it moves at most while the rotor turns by a radian
STEP_ROUNDING = 2e-10  # a motion within a step is found by a matrix or a series, which agree so far


@dataclass
class Machine:
    """A scene's one file, and how far it is run.

    Attributes:
        end: of the run [s].
        top: largest speed [rad/s].
        fastest: mode of the rotor, or drag of its weights [1/s].
        jumps: times since the start at which a profile has corners, or the unbalance changes [s].
    """

    name: str
    path: Path
    end: float
    top: float
    fastest: float
    jumps: tuple[float, ...]

    @classmethod
    def of(cls, scene: Scene, folder: Path, fmi: int) -> Machine:
        """Built for this machine."""
        from autobalancer.harness.master.schedule import end_time

        built = scene.build(
            folder / f"fmi{fmi}", fmi=fmi, platforms=[platform_tuple], one_file=True
        )
        profile = scene.profile()
        times = profile.times[1:] if profile.changes else ()
        changes = [change.time for change in scene.operation.unbalance_changes]
        top = max(map(abs, profile.speeds))
        fastest = equations(scene.assembly(), scene.operation.drive()).fastest_mode
        return cls(scene.name, built.files[0], end_time(scene), top, fastest, (*times, *changes))


def begun(machine: Machine, start: float, exchange: bool) -> Host:
    """An instance behind its initialisation."""
    two = "fmi2" in str(machine.path)
    of = fmi2.FMU2Model if two else fmi3.FMU3Model
    host = Host(machine.path, kind=of) if exchange else Host(machine.path)
    if two:
        host.slave.setupExperiment(startTime=start)
        host.slave.enterInitializationMode()
    else:
        host.slave.enterInitializationMode(startTime=start)
    host.slave.exitInitializationMode()
    return host


def outputs_of(host: Host) -> list[str]:
    """Outputs that are Reals."""
    return [n for n, v in host.variables.items() if v.causality == "output" and v.type != "Boolean"]


def motion_of(machine: Machine) -> list[int]:
    """Which outputs are continuous in time: places, angles and what has a rate within the model.

    Not so forces, accelerations and figures of the coupling, which differ at the end of a coupling
    step by what its signals miss, and the vibration, which is of the last whole revolution.
    """
    names = outputs_of(Host(machine.path))
    continuous = re.compile(r"(^|\.)(v?[xy]|angle|speed|bending|moment_\w+)$")
    return [k for k, name in enumerate(names) if continuous.search(name)]


def stepped(machine: Machine, start: float, equal: bool) -> NDArray:
    """Outputs of a co-simulation at all points, (points, outputs)."""
    host = begun(machine, start, False)
    references = host.references(*outputs_of(host))
    h = machine.end / POINTS
    rows = [host._get(references)]
    for k in range(POINTS):
        now, then = start + k * h, start + (k + 1) * h
        host.slave.doStep(now, h if equal else then - now)
        rows.append(host._get(references))
    host.free()
    return np.array(rows)


class Solver:
    """Runge-Kutta of order 4 in steps of one length, cut at time events, as a tool has it."""

    def __init__(self, machine: Machine, start: float) -> None:
        self.start, self.host = start, begun(machine, start, True)
        self.count = len(self.host.description.derivatives)
        self.buffer = np.zeros(self.count)
        self.pointer = self.buffer.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
        three = not self.host.description.fmiVersion.startswith("2")
        self._rates = "getContinuousStateDerivatives" if three else "getDerivatives"
        self._update = "updateDiscreteStates" if three else "newDiscreteStates"
        self.next = self.event()

    def event(self) -> float:
        """Pass events that are due; the host's time of the next."""
        *_, defined, time = getattr(self.host.slave, self._update)()
        self.host.slave.enterContinuousTimeMode()
        return time if defined else math.inf

    def read(self, function: str) -> NDArray:
        getattr(self.host.slave, function)(self.pointer, self.count)
        return self.buffer.copy()

    def rates(self, time: float, states: NDArray) -> NDArray:
        self.host.slave.setTime(time)
        self.buffer[:] = states
        self.host.slave.setContinuousStates(self.pointer, self.count)
        return self.read(self._rates)

    def step(self, now: float, length: float) -> None:
        x = self.read("getContinuousStates")
        a = self.rates(now, x)
        b = self.rates(now + 0.5 * length, x + 0.5 * length * a)
        c = self.rates(now + 0.5 * length, x + 0.5 * length * b)
        d = self.rates(now + length, x + length * c)
        self.rates(now + length, x + length / 6.0 * (a + 2.0 * b + 2.0 * c + d))
        self.host.slave.completedIntegratorStep()

    def to(self, end: float, length: float) -> None:
        """A step of the host, cut at events."""
        now = end - length
        while self.next < end:
            self.step(now, self.next - now)
            now = self.next
            self.host.slave.enterEventMode()
            self.next = self.event()
        self.step(now, end - now if now > end - length else length)


def exchanged(machine: Machine, start: float) -> NDArray:
    """Outputs of model exchange, after every eighth of its steps."""
    solver = Solver(machine, start)
    references = solver.host.references(*outputs_of(solver.host))
    end = max(REVOLUTIONS * 2.0 * math.pi / machine.top, *(1.1 * t for t in machine.jumps), 0.0)
    finer = max(1.0, machine.fastest / (FOLLOWED * machine.top))
    count = 8 * max(1, round(end * machine.top / (2.0 * math.pi) * finer * 24 / 8))
    h = end / count
    rows = [solver.host._get(references)]
    for k in range(count):
        solver.to(solver.start + (k + 1) * h, h)
        if k % 8 == 7:
            rows.append(solver.host._get(references))
    solver.host.free()
    return np.array(rows)


def difference(found: NDArray, expected: NDArray) -> float:
    """Largest of all outputs, over the range of each."""
    size = np.maximum(abs(expected).max(axis=0), 1e-300)
    return float((abs(found - expected).max(axis=0) / size).max())


def allowed(machine: Machine, start: float, end: float) -> float:
    """What the rounding of t0 + k h can make of a signal, over its range."""
    ulp = float(np.spacing(max(abs(start), abs(start + end), end)))
    return MOVES * machine.top * ulp + STEP_ROUNDING


@dataclass(frozen=True)
class Row:
    """What a start makes of a run, the largest difference of a signal over its range.

    Attributes:
        equal: with steps of one length, all outputs.
        points: with steps that are differences of the host's times, the motion.
        exchange: with model exchange, the motion; NaN for a scene with events.
        allowed: of the last two.
    """

    scene: str
    fmi: int
    start: float
    equal: float
    points: float
    exchange: float
    allowed: float

    @property
    def holds(self) -> bool:
        """Whether the result is the same, shifted."""
        return self.equal == 0.0 and max(self.points, self.exchange) <= self.allowed


def study(scenes: Iterable[Scene], fmis: Sequence[int] = (2, 3)) -> Iterator[Row]:
    """Every start of every scene."""
    with TemporaryDirectory() as folder:
        for scene in scenes:
            for fmi in fmis:
                yield from _starts(Machine.of(scene, Path(folder), fmi), fmi)


def _starts(machine: Machine, fmi: int) -> Iterator[Row]:
    motion = motion_of(machine)
    description = Host(machine.path).description
    # the solver has no state events
    has_exchange = description.modelExchange and not description.numberOfEventIndicators

    def runs(start: float) -> tuple[NDArray, NDArray, NDArray | None]:
        found = exchanged(machine, start)[:, motion] if has_exchange else None
        return stepped(machine, start, True), stepped(machine, start, False)[:, motion], found

    expected = runs(0.0)
    for start in STARTS:
        seen = [
            math.nan if a is None or b is None else difference(a, b)
            for a, b in zip(runs(start), expected, strict=True)
        ]
        bound = allowed(machine, start, machine.end)
        yield Row(machine.name, fmi, start, *seen, bound)


if __name__ == "__main__":
    wrong = 0
    print("scene, FMI, start [s]: equal steps, points, model exchange (allowed)")
    for row in study(map(load_scene, sys.argv[1:] or bundled_scenes())):
        wrong += not row.holds
        print(
            f"{row.scene:24} {row.fmi} {row.start:9g} {row.equal:8.1e} {row.points:8.1e} "
            f"{row.exchange:8.1e} ({row.allowed:.1e}){'' if row.holds else '  WRONG'}",
            flush=True,
        )
    print(f"{wrong} wrong")
    sys.exit(wrong > 0)
