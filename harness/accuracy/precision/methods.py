"""The methods whose error and run time are compared, each made ready as one call."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from ....fmus.composite.batch import BatchRuns
from ....models.arrays import Array
from ....models.constants import DEFAULT_TOLERANCE
from ....models.monolith import equations, integrate, trajectory
from ...errors import SimulationError
from ...master.cosimulation import CoSimulation
from ...master.global_error import Controlled
from ...master.one_file import composition
from ...master.recorder import Recorder
from ...master.runtime import Backend
from ...master.schedule import end_time
from ...scene import Scene
from ...scene.begin import motion_at_start

EXPLICIT_STEPS = (10, 20, 40, 80, 160)
ITERATED_STEPS = (8, 10, 14, 20, 28, 40, 80)
COMPENSATED_STEPS = (6, 8, 10, 12, 14, 20, 30, 40, 80)
PYTHON_STEPS = (20, 40)  # the same digits as native units, at another price
ONE_FILE_TOLERANCES = tuple(10.0 ** (-k / 2) for k in range(2, 21))
TOLERANCES = (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
SOLVERS: dict[str, tuple[float, ...]] = {
    "RK45": tuple(10.0**-k for k in range(3, 10)),
    "DOP853": tuple(10.0**-k for k in range(3, 11)),
    "LSODA": tuple(10.0**-k for k in range(3, 11)),
    "odeint": tuple(10.0**-k for k in range(3, 11)),
    "Radau": tuple(10.0**-k for k in range(3, 9)),
}
MORE = 16  # points than steps of the composite: of those at the start and at jumps
REPEATS = 10  # of the composite in one call, which takes less than a ms


@dataclass(frozen=True, eq=False)
class TimedRun:
    """A finished run: seconds without loading, its points, and its work (steps, evaluations)."""

    seconds: float
    time: Array
    signals: dict[str, Array]
    work: int
    note: str = ""


Runner: TypeAlias = Callable[[], TimedRun]  # raises SimulationError, ArithmeticError


@dataclass(frozen=True)
class Method:
    """A way to run a scene; what does not apply is None.

    Attributes:
        name: coupling scheme, or `monolith` and SciPy's method.
        order: of the exchanged signals.
        steps_per_rev: communication steps per revolution.
        corrections: corrector passes; None with `iterated`: until the loop has converged.
        tolerance: of the tolerance-driven step, or SciPy's rtol.
        units: "native", or "python" for those that run Python.
        one_file: whether the machine is in one piece: the scene's composite.
    """

    name: str
    order: int | None = None
    steps_per_rev: int | None = None
    corrections: int | None = None
    tolerance: float | None = None
    units: Backend = "native"
    one_file: bool = False

    @property
    def in_one_piece(self) -> bool:
        """Whether nothing is coupled: SciPy integrates the whole."""
        return self.name.startswith("monolith ")

    @property
    def family(self) -> str:
        """The method without its step or tolerance, in words."""
        words = [self.name]
        if self.one_file:
            return "own steps in one file"
        if self.order is not None:
            words.append({0: "held", 1: "linear", 3: "cubic"}[self.order])
        if self.tolerance is not None and not self.in_one_piece:
            words.append("tolerance")
        elif self.name == "iterated":
            passes = {None: "until converged", 1: "1 pass"}
            words.append(passes.get(self.corrections, f"{self.corrections} passes"))
        if self.units == "python":
            words.append("on Python units")
        return " ".join(words)

    @property
    def setting(self) -> str:
        """Step or tolerance, in words."""
        if self.steps_per_rev is not None:
            return f"{self.steps_per_rev} steps per revolution"
        return f"tolerance {self.tolerance:g}"


def _separate(scene: Scene, names: Sequence[str], opened: ExitStack) -> Runner:
    """The FMUs of a scene under one coupling, loaded once."""
    cosim = opened.enter_context(CoSimulation(scene))

    def run() -> TimedRun:
        recorder = Recorder(cosim.units, names)
        start_time = clock.process_time()
        if cosim.coupled and cosim.scene.coupling.tolerance is not None:
            recorder = Controlled(cosim, names).run(None)
        else:
            cosim.start()
            cosim.record(recorder, None)
        seconds = clock.process_time() - start_time
        facts = cosim.facts()
        note = f"{facts.unconverged} steps not converged" if facts.unconverged else ""
        time, signals = recorder.columns()
        return TimedRun(seconds, time, {name: signals[name] for name in names}, facts.steps, note)

    return run


def _one_file(scene: Scene, names: Sequence[str], _opened: ExitStack) -> Runner:
    """The composite of a scene, called once for a whole run, read where its steps end."""
    made, end = composition(scene), np.full(REPEATS, end_time(scene))
    counted, (reason, _) = BatchRuns(made, [], ["coupling.steps"], 1)(np.empty((2, 0)), end[:2])
    if reason:
        raise SimulationError(reason)
    points = int(counted[0, -1, 0]) + MORE
    runs = BatchRuns(made, [], [*names, "coupling.steps"], points, own_steps=True)

    def run() -> TimedRun:
        start_time = clock.process_time()
        records, (reason, *_) = runs(np.empty((REPEATS, 0)), end)
        seconds = (clock.process_time() - start_time) / REPEATS
        if reason:
            raise SimulationError(reason)
        time, *signals, steps = records[0, ~np.isnan(records[0, :, 0])].T
        return TimedRun(seconds, time, dict(zip(names, signals, strict=True)), int(steps[-1]))

    return run


def _monolith(scene: Scene, names: Sequence[str], method: str, rtol: float) -> Runner:
    """The monolith by one of SciPy's methods; only the integration is timed.

    Its points are those of its own steps, as with the couplings: dense output would cost extra.
    """
    start = motion_at_start(scene)
    system = equations(scene.assembly(), scene.operation.drive(), start.angle)

    def run() -> TimedRun:
        start_time = clock.process_time()
        time, states, work = integrate(system, end_time(scene), start, method=method, rtol=rtol)
        seconds = clock.process_time() - start_time
        motion = trajectory(system, time, states)
        return TimedRun(seconds, time, {name: motion.signal(name) for name in names}, work)

    return run


def coupling_methods(exchanges_force: bool) -> list[Method]:
    """Every scheme, order and step; one of each step where no force is exchanged."""
    if not exchanges_force:
        alone = [Method("auto", steps_per_rev=n) for n in (4, 10, 20, 40)]
        return [*alone, Method("auto", tolerance=DEFAULT_TOLERANCE, one_file=True)]
    methods = [
        Method(scheme, order, n)
        for scheme in ("jacobi", "gauss-seidel")
        for order in (0, 1, 3)
        for n in EXPLICIT_STEPS
    ]
    methods += [Method("compensated", 3, n) for n in COMPENSATED_STEPS]
    methods += [Method("iterated", o, n, 1) for o in (0, 1) for n in EXPLICIT_STEPS]
    methods += [Method("iterated", 3, n, passes) for passes in (1, None) for n in ITERATED_STEPS]
    methods += [Method("iterated", 3, tolerance=t) for t in TOLERANCES]
    methods += [Method("compensated", 3, n, units="python") for n in PYTHON_STEPS]
    methods += [Method("iterated", 3, tolerance=t, one_file=True) for t in ONE_FILE_TOLERANCES]
    return methods


def monolith_methods() -> list[Method]:
    """SciPy's methods over their tolerances."""
    return [Method(f"monolith {m}", tolerance=t) for m, ts in SOLVERS.items() for t in ts]


def coupled_scene(scene: Scene, method: Method) -> Scene:
    """The scene under a method's coupling."""
    keys = {
        "scheme": method.name,
        "order": 3 if method.order is None else method.order,
        "corrections": method.corrections,
        "units": method.units,
        "steps_per_rev": method.steps_per_rev,
        "tolerance": method.tolerance,
    }
    return scene.replace({f"coupling.{key}": value for key, value in keys.items()})


def ready(scene: Scene, method: Method, names: Sequence[str], opened: ExitStack) -> Runner:
    """Load what a method needs; `opened` closes it.

    Raises:
        UserError: an FMU cannot be loaded.
        SimulationError: this method cannot run this scene at all; the message says why.
    """
    if method.in_one_piece:
        assert method.tolerance is not None
        solver = method.name.removeprefix("monolith ")
        return _monolith(scene, names, solver, method.tolerance)
    load = _one_file if method.one_file else _separate
    return load(coupled_scene(scene, method), names, opened)
