"""What the tests of the units share: a unit in plain Python, and a native one like it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest
from fmpy.fmi1 import FMICallException

import autobalancer.fmus
from autobalancer.fmus.catalogue import CATALOGUE
from autobalancer.fmus.variables import Layout
from tests.native.packaging import Host, Units

BACKENDS = ["python", "native"]

SHAPES = [
    ("RotorOnSupports", {}),
    ("RotorOnSupports", {"kind": "two_support", "stations": 2, "unbalances": 2}),
    ("RotorOnSupports", {"kind": "flexible", "stations": 4, "shaft": "compliance"}),
    ("RotorOnSupports", {"planes": 3, "frame": "fixed"}),
    ("LiquidBalancer", {}),
    ("LiquidBalancer", {"frame": "fixed"}),
    ("RingBalancer", {}),
    ("RingBalancer", {"frame": "fixed"}),
    ("BallBalancer", {}),
    ("BallBalancer", {"weights": 1}),
    ("BallBalancer", {"weights": 5, "frame": "fixed"}),
]
ELSEWHERE = [SHAPES[k] for k in (2, 4, 6, 10)]  # of each unit one


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


class NativeProbe(Host):
    """A native unit in its initialisation, with the calls of a unit in plain Python."""

    look = Host.get

    def __init__(self, path: Path, layout: Layout) -> None:
        super().__init__(path)
        self.layout = layout
        self.slave.setupExperiment()
        self.slave.enterInitializationMode()
        self.saved, self.restore = self.slave.getFMUState, self.slave.setFMUState
        self.get_real = self.slave.getReal

    def put(self, name: str, *values: float) -> None:
        """Set a variable, and those that follow it."""
        names = [v.name for v in self.layout.reals[self.layout.index.get(name, 0) :]]
        names[0] = name
        self.set(dict(zip(names, values, strict=False)))

    def exit_initialization_mode(self) -> None:
        """Begin; RuntimeError with the reason that is logged."""
        try:
            self.slave.exitInitializationMode()
        except FMICallException:
            raise RuntimeError(self.messages[-1][1]) from None

    def do_step(self, time: float, step: float) -> bool:
        """One step."""
        self.slave.doStep(time, step)
        return True


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
def native_probe(fmus: Units) -> Callable[..., NativeProbe]:
    """A native unit in its initialisation: its name, options."""
    return lambda unit, **options: NativeProbe(
        fmus.native(unit, **options), fmus.layout(unit, **options)
    )


@pytest.fixture
def host_of(fmus: Units) -> Callable[..., Host]:
    """A unit under fmpy: its name, backend, options."""
    return lambda unit, backend="native", **options: Host(getattr(fmus, backend)(unit, **options))


@pytest.fixture(scope="session")
def elsewhere(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """The FMU of one of `ELSEWHERE`, built in another folder by another process."""
    script = (
        "from autobalancer.fmus.build import build\n"
        f"for k, (unit, options) in enumerate({ELSEWHERE!r}): build(unit, str(k), **options)"
    )
    folder = tmp_path_factory.mktemp("elsewhere")
    environment = {**os.environ, "PYTHONHASHSEED": "7", "TZ": "Asia/Tokyo"}
    subprocess.run([sys.executable, "-c", script], cwd=folder, env=environment, check=True)
    return lambda shape: folder / str(ELSEWHERE.index(shape)) / f"{shape[0]}.fmu"


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
