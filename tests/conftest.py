"""What the tests of the master share: comparison with the monolith, and altered units."""

from __future__ import annotations

import importlib
import os
import tempfile
import zipfile
from collections.abc import Callable, Iterator, Sequence
from contextvars import copy_context
from functools import cache, partial
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

# for itself, the workers and all that they begin: matrices of tests are small, and threads that
# wait for each other take a third of the processor time; a number that is given stays
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import pytest
from hypothesis import settings

from tests.wheel import checkout, installed, wheel  # noqa: F401

if TYPE_CHECKING:  # loaded where it is used: tests of the models alone need no harness
    from autobalancer.harness import Scene
    from autobalancer.harness.result.result import Result
    from tests.native.core import Core
    from tests.native.equations import Friction, Track
    from tests.native.packaging import Units

settings.register_profile("untimed", deadline=None)  # a busy machine is no failure
settings.load_profile("untimed")


@pytest.fixture(scope="session", autouse=True)
def _temporary_files() -> Iterator[None]:
    """One folder for them, removed: fmpy leaves a run that fails, ecos and Wine every one."""
    before = tempfile.tempdir, os.environ.get("TMPDIR")
    with tempfile.TemporaryDirectory(prefix="tests-", ignore_cleanup_errors=True) as folder:
        tempfile.tempdir = os.environ["TMPDIR"] = folder  # processes begun here follow the latter
        yield
    tempfile.tempdir = before[0]
    os.environ.pop("TMPDIR") if before[1] is None else os.environ.update(TMPDIR=before[1])


@pytest.fixture(autouse=True)
def _no_narrow_terminal(monkeypatch):
    """Tables as wide as in a pipe, whatever the terminal the tests run in."""
    monkeypatch.delenv("COLUMNS", raising=False)


@pytest.fixture(scope="session")
def invoke() -> Callable[..., object]:
    """Run a command in this process; arguments are written as text."""

    def run(*arguments: object) -> object:
        from typer.testing import CliRunner

        from autobalancer.harness.__main__ import program

        written = [str(argument) for argument in arguments]
        # a context of its own: the units that one command shows are not those of what follows
        return copy_context().run(CliRunner().invoke, program(), written)

    return run


@pytest.fixture
def interrupted_once(monkeypatch) -> Callable[[object, str, int], list]:
    """Let work of a module be done so often, then be interrupted once; the jobs that were done."""

    def arm(module: object, name: str, after: int) -> list:
        work, done, told = getattr(module, name), [], []

        def interrupted(job: object) -> object:
            if len(done) == after and not told:
                told.append(True)
                raise KeyboardInterrupt
            done.append(job)
            return work(job)

        monkeypatch.setattr(module, name, interrupted)
        return done

    return arm


@cache
def _motion(name: str, changes: tuple, times: tuple[float, ...], signals: tuple[str, ...]):
    from autobalancer.harness import load_scene
    from autobalancer.harness.scene.begin import motion_at_start
    from autobalancer.models.monolith import reference

    scene = load_scene(name).replace(dict(changes))
    start = motion_at_start(scene)
    motion, own_error = reference(
        scene.restrained_assembly(), scene.profile(), times, initial=start, rtol=1e-12
    )
    assert own_error < 2e-8, own_error  # the least error that a test asks for is 1e-7
    return {signal: motion.signal(signal) for signal in signals}


class Against:
    """Errors of co-simulated runs of one motion, against the monolith on a common grid of times."""

    def __init__(self, name: str, changes: dict[str, object] | None = None) -> None:
        from autobalancer.harness import load_scene

        self.name, self.changes = name, changes or {}
        self.scene = load_scene(name).replace(self.changes)

    def run(
        self,
        coupling: dict[str, object],
        signals: Sequence[str] | None = None,
        separate: bool = False,
    ) -> Result:
        """Run with keys of [coupling] on top; None for those left at their default.

        What separate FMUs alone have is for them.
        """
        from autobalancer.harness import cosimulate
        from autobalancer.harness.scene.run import UNCORRECTED

        separate = separate or coupling.get("scheme") in UNCORRECTED
        separate = separate or coupling.get("order", 3) != 3
        keys = {f"coupling.{key}": value for key, value in coupling.items()}
        return cosimulate(self.scene.replace(keys), record=signals, separate=separate)

    def _reference(self, times: np.ndarray, signals: Sequence[str]) -> dict[str, np.ndarray]:
        # physical changes only: the motion does not depend on how it is coupled
        changes = tuple(sorted((k, _frozen(v)) for k, v in self.changes.items()))
        return _motion(self.name, changes, tuple(times.tolist()), tuple(signals))

    def of_amplitude(self, result: Result, every: int = 1) -> float:
        """Largest error of all signals over the largest amplitude of any."""
        expected = self._reference(_times(result, every), list(result.signals))
        largest = max(np.abs(values).max() for values in expected.values())
        return max(np.abs(result[k][::every] - v).max() for k, v in expected.items()) / largest

    def of_range(self, result: Result) -> float:
        """Largest error of a signal over that signal's own range."""
        return self.of_ranges([result])[0]

    def of_ranges(self, results: Sequence[Result]) -> list[float]:
        """`of_range` of each, by one reference at the communication points of all."""
        every = np.unique(np.concatenate([_times(result) for result in results]))
        motion = self._reference(every, list(results[0].signals))
        errors = []
        for result in results:
            expected = {k: v[np.searchsorted(every, _times(result))] for k, v in motion.items()}
            errors.append(
                max(float(np.abs(result[k] - v).max() / np.ptp(v)) for k, v in expected.items())
            )
        return errors


def _times(result: Result, every: int = 1) -> np.ndarray:
    return np.round(result.time[::every], 13)


def _frozen(value: object) -> object:
    if isinstance(value, dict):
        return _Table(value)
    return tuple(value) if isinstance(value, list) else value


class _Table(dict):
    """A table of a scene as part of a key."""

    def __hash__(self) -> int:  # type: ignore[override]
        return hash(tuple(sorted(self.items())))

    def __lt__(self, other: object) -> bool:
        return repr(self) < repr(other)


@pytest.fixture(scope="session")
def against() -> type[Against]:
    """Compare runs of a bundled scene with the monolith."""
    return Against


@pytest.fixture(scope="session")
def heavy_weights() -> dict[str, object]:
    """The two-ball scene with weights of a third of the total mass, eps = 0.3."""
    return {
        "rotor.mass": 0.7,
        "rotor.unbalance": 0.15,
        "weights.mass": 0.15,
        "weights.drag": 0.075,
    }


@pytest.fixture(scope="session")
def liquid_of_gain() -> Callable[[float], Scene]:
    """The heavy liquid that sends its inertia as force, thinned until r m2/m1 is the given gain."""

    def scene(gain: float) -> Scene:
        from autobalancer.harness import load_scene

        heavy = load_scene("liquid_heavy_force")
        mass = heavy.assembly().added_mass[0] / heavy.rotor.mass
        return heavy.replace({"liquid.density": heavy.balancer[0].density * gain / mass})

    return scene


@pytest.fixture
def rewritten() -> Callable[..., Path]:
    """Copy an FMU with its members changed; `change` maps (name, content) to (name, content)."""

    def rewrite(source: Path, target: Path, change: Callable) -> Path:
        with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
            for member in old.namelist():
                new.writestr(*change(member, old.read(member)))
        return target

    return rewrite


@pytest.fixture(scope="session")
def packaging() -> ModuleType:
    """`tests.native.packaging`, which compiles: units as FMUs, and their host."""
    return importlib.import_module("tests.native.packaging")


@pytest.fixture(scope="session")
def fmus(packaging: ModuleType, tmp_path_factory: pytest.TempPathFactory) -> Units:
    """Builds units, each once."""
    return packaging.Units(tmp_path_factory.mktemp("units"))


@pytest.fixture(scope="session")
def core(tmp_path_factory: pytest.TempPathFactory) -> Core:
    """The equations in C, compiled by the C compiler of this machine."""
    from tests.native.core import Core, compile_library

    return Core(compile_library(tmp_path_factory.mktemp("native") / "core.so"))


@pytest.fixture(scope="session")
def track_of(core: Core) -> Callable[..., Track]:
    """Weights on a track, moved by the units' C functions."""
    from tests.native.equations import Track

    return partial(Track, core)


@pytest.fixture(scope="session")
def friction_of(core: Core) -> Callable[..., Friction]:
    """A rotor with dry friction in its supports, moved by the unit's C functions."""
    from tests.native.equations import Friction

    return partial(Friction, core)
