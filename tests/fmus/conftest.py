"""What the tests of the units share: a unit in plain Python, and one under fmpy."""

from __future__ import annotations

import itertools
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import fmpy
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import (
    FMU2Slave,
    defaultCallbacks,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
    printLogMessage,
)

import autobalancer.fmus
from autobalancer.fmus.build import build
from autobalancer.fmus.catalogue import CATALOGUE, sized_unit
from autobalancer.fmus.variables import Layout

BACKENDS = ["python", "native"]

SHAPES = [
    ("RotorOnSupports", {}),
    ("RotorOnSupports", {"kind": "two_support", "stations": 2, "unbalances": 2}),
    ("RotorOnSupports", {"kind": "flexible", "stations": 4, "shaft": "compliance"}),
    ("RotorOnSupports", {"planes": 3, "frame": "fixed"}),
    ("LiquidBalancer", {}),
    ("LiquidBalancer", {"frame": "fixed"}),
    ("BallBalancer", {}),
    ("BallBalancer", {"weights": 1}),
    ("BallBalancer", {"weights": 5, "frame": "fixed"}),
]


class Probe:
    """A unit in plain Python, with its variables by name; what is not here is the slave's."""

    def __init__(self, unit: str, options: dict[str, Any]) -> None:
        home = import_module(f"autobalancer.fmus.{CATALOGUE[unit].folder}.slave")
        self.slave = getattr(home, unit)(instance_name="unit", options=options)

    def __getattr__(self, name: str) -> Any:
        return getattr(self.slave, name)

    def put(self, name: str, *values: float) -> None:
        """Set a variable, and those that follow it."""
        if name in self.layout.boolean_index:
            self.set_boolean([self.layout.boolean_index[name]], list(values))
            return
        first = self.layout.index[name]
        self.set_real(list(range(first, first + len(values))), [float(v) for v in values])

    def look(self, *names: str) -> list[float]:
        """Values of variables, one call each."""
        return [self.get_real([self.layout.index[name]])[0] for name in names]

    def saved(self) -> dict[str, Any]:
        """The state as pythonfmu's library keeps it."""
        return self.slave._get_fmu_state()

    def packed(self) -> bytes:
        """The state, serialised."""
        return self.slave._fmu_state_to_bytes(self.saved())

    def restore(self, state: dict[str, Any] | bytes) -> None:
        """Go back to a saved or serialised state."""
        if isinstance(state, bytes):
            state = self.slave._fmu_state_from_bytes(state)
        self.slave._set_fmu_state(state)


class NativeProbe:
    """A native unit in its initialisation, with its variables by name."""

    def __init__(self, path: Path, layout: Layout) -> None:
        from tests.native.packaging import Host as Listening

        self.host, self.layout = Listening(path), layout
        self.host.slave.setupExperiment()
        self.host.slave.enterInitializationMode()
        self.saved, self.restore = self.host.slave.getFMUState, self.host.slave.setFMUState

    def put(self, name: str, *values: float) -> None:
        """Set a variable, and those that follow it."""
        if name in self.layout.boolean_index:
            reference = self.host.variables[name].valueReference
            self.host.slave.setBoolean([reference], list(values))
            return
        first = self.layout.index[name]
        names = [v.name for v in self.layout.reals[first : first + len(values)]]
        self.host.set(dict(zip(names, map(float, values), strict=True)))

    def look(self, *names: str) -> list[float]:
        """Values of variables."""
        return self.host.get(*names)

    def get_real(self, vrs: list[int]) -> list[float]:
        """Values by reference."""
        return self.host.slave.getReal(vrs)

    def exit_initialization_mode(self) -> None:
        """Begin; RuntimeError with the reason that is logged."""
        try:
            self.host.slave.exitInitializationMode()
        except FMICallException:
            raise RuntimeError(self.host.messages[-1][1]) from None

    def do_step(self, time: float, step: float) -> bool:
        """One step."""
        self.host.slave.doStep(time, step)
        return True


def _is_no_source(name: str) -> bool:
    return not name.startswith("sources/")


class Host:
    """An FMU under fmpy, with access by name."""

    def __init__(self, path: Path) -> None:
        self.description = fmpy.read_model_description(str(path))
        self.reference = {v.name: v.valueReference for v in self.description.modelVariables}
        self._unpacked = TemporaryDirectory()
        self.slave = FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=fmpy.extract(str(path), self._unpacked.name, _is_no_source),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="unit",
        )
        # fmpy's own logger passes on to that of the last `simulate_fmu`, which is gone
        self._callbacks = fmi2CallbackFunctions()
        self._callbacks.logger = fmi2CallbackLoggerTYPE(printLogMessage)
        self._callbacks.allocateMemory = defaultCallbacks.allocateMemory
        self._callbacks.freeMemory = defaultCallbacks.freeMemory

    def instantiate(self) -> None:
        self.slave.instantiate(callbacks=self._callbacks)

    def start(self, **values: float) -> Host:
        self.instantiate()
        return self.initialise(**values)

    def initialise(self, **values: float) -> Host:
        self.slave.setupExperiment()
        self.slave.enterInitializationMode()
        for name, value in values.items():
            self[name] = value
        self.slave.exitInitializationMode()
        return self

    def __getitem__(self, name: str) -> float:
        return self.slave.getReal([self.reference[name]])[0]

    def __setitem__(self, name: str, value: float) -> None:
        self.slave.setReal([self.reference[name]], [value])

    def outputs(self) -> list[float]:
        return self.slave.getReal(
            [v.valueReference for v in self.description.modelVariables if v.causality == "output"]
        )

    def run(self, steps: int, step: float = 1e-3, start: float = 0.0) -> list[float]:
        for k in range(steps):
            self.slave.doStep(start + k * step, step)
        return self.outputs()

    def free(self) -> None:
        self.slave.terminate()
        self.slave.freeInstance()


@pytest.fixture(scope="session")
def probe() -> Callable[..., Probe]:
    """A unit in plain Python: its name, start values, options; `begin=False` leaves it there."""

    def make(unit: str, starts: dict | None = None, begin: bool = True, **options: Any) -> Probe:
        made = Probe(unit, options)
        for name, value in (starts or {}).items():
            made.put(name, value)
        if begin:
            made.exit_initialization_mode()
        return made

    return make


@pytest.fixture(scope="session")
def native_probe(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., NativeProbe]:
    """A native unit in its initialisation: its name, options."""
    folder, numbers, built = tmp_path_factory.mktemp("probes"), itertools.count(), {}

    def make(unit: str, **options: Any) -> NativeProbe:
        key = (unit, *sorted(options.items()))
        if key not in built:
            built[key] = build(
                unit, folder / str(next(numbers)), platforms=[fmpy.platform_tuple], **options
            )
        return NativeProbe(built[key], sized_unit(unit, **options).layout)

    return make


@pytest.fixture(scope="module")
def fmu(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """Builds an FMU into a folder of its own."""
    folder = tmp_path_factory.mktemp("fmus")
    numbers = itertools.count()

    def make(unit: str, **options: Any) -> Path:
        return build(unit, folder / str(next(numbers)), **options)

    return make


@pytest.fixture(scope="session")
def host_of() -> type[Host]:
    """An FMU under fmpy."""
    return Host


@pytest.fixture(scope="session")
def elsewhere(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """The FMU of one of `SHAPES`, built in another folder by another process."""
    script = (
        "from autobalancer.fmus.build import build\n"
        f"for k, (unit, options) in enumerate({SHAPES!r}): build(unit, str(k), **options)"
    )
    folder = tmp_path_factory.mktemp("elsewhere")
    environment = {**os.environ, "PYTHONHASHSEED": "7", "TZ": "Asia/Tokyo"}
    subprocess.run([sys.executable, "-c", script], cwd=folder, env=environment, check=True)
    return lambda shape: folder / str(SHAPES.index(shape)) / f"{shape[0]}.fmu"


@pytest.fixture
def altered(tmp_path) -> Callable[..., Path]:
    """Build a unit from a copy of the sources in which `old` of one file reads `new`."""

    def make(unit: str, file: str, old: str, new: str) -> Path:
        package = tmp_path / "altered" / "autobalancer"
        here = Path(autobalancer.fmus.__file__).parent.parent
        for folder in ("fmus", "models"):
            shutil.copytree(here / folder, package / folder)
        text = (package / file).read_text()
        assert text.count(old) == 1
        (package / file).write_text(text.replace(old, new))
        script = (
            "import sys; from autobalancer.fmus.build import build; "
            "build(*sys.argv[1:], backend='python')"
        )
        command = [sys.executable, "-c", script, unit, str(package.parent)]
        environment = {**os.environ, "PYTHONPATH": str(package.parent)}
        subprocess.run(command, env=environment, check=True)
        return package.parent / f"{unit}.fmu"

    return make


@pytest.fixture(params=BACKENDS)
def backend(request: pytest.FixtureRequest) -> str:
    """Every runtime there is: what holds for one holds for the other."""
    return request.param


@pytest.fixture(params=SHAPES, ids=lambda shape: "-".join([shape[0], *map(str, shape[1].values())]))
def shape(request: pytest.FixtureRequest) -> tuple[str, dict[str, Any]]:
    """A unit with its build options."""
    return request.param


@pytest.fixture
def unit(shape: tuple[str, dict[str, Any]]) -> str:
    """Name of the unit of `shape`."""
    return shape[0]


@pytest.fixture
def options(shape: tuple[str, dict[str, Any]]) -> dict[str, Any]:
    """Build options of `shape`."""
    return shape[1]
