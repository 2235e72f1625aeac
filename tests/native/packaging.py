"""Units for the tests as `build` writes them, and a host of any of them."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from functools import cache, cached_property, partial
from pathlib import Path
from tempfile import TemporaryDirectory

import fmpy
import numpy as np
import pytest
from fmpy import fmi2, fmi3, platform_tuple
from fmpy.fmi1 import FMICallException
from numpy.typing import NDArray

from autobalancer.fmus.build import build
from autobalancer.fmus.catalogue import sized_unit
from autobalancer.fmus.native.build.compile import SOURCE, SOURCES, libraries, one_source, stamp
from autobalancer.fmus.native.build.tokens import token
from autobalancer.harness.master.unit_files import described
from tests.native.core import shared_library

STAMP = stamp()


def compile_units(folder: Path, *flags: str | Path) -> Path:
    """Compile the one source with the compiler of this machine, and others among `flags`."""
    folder.mkdir(parents=True, exist_ok=True)
    source = folder / SOURCE
    source.write_text(one_source())
    # gcc does not see that a failure is read only where a function has filled it
    options = ("-fvisibility=hidden", "-Wno-maybe-uninitialized", f"-I{SOURCES}", *map(str, flags))
    return shared_library([str(source)], folder / "autobalancer.so", *options)


class Units:
    """FMUs in a folder, each built once for the same options; native ones for this machine."""

    def __init__(self, folder: Path) -> None:
        self._folder, self._numbers = folder, itertools.count()
        self._built = cache(self._build)

    @cached_property
    def library(self) -> Path:
        """What `build` packs."""
        return libraries([platform_tuple])[platform_tuple]

    def native(self, unit: str, **options: object) -> Path:
        """A native unit, of FMI 2.0 by default."""
        return self._built(unit, platforms=(platform_tuple,), **options)

    def python(self, unit: str, **options: object) -> Path:
        """The same unit in Python."""
        return self._built(unit, backend="python", **options)

    def _build(self, unit: str, **options: object) -> Path:
        return build(unit, self._folder / str(next(self._numbers)), **options)

    def token(self, unit: str, **options: object) -> str:
        """GUID or instantiation token of a native unit."""
        return token(sized_unit(unit, **options), STAMP)

    def layout(self, unit: str, **options: object):
        return sized_unit(unit, **options).layout


def _is_needed(name: str) -> bool:
    return not name.startswith(("sources/", "documentation/"))


class Host:
    """An FMU of either version under fmpy, with access by name.

    It listens by itself: fmpy's proxy of a logger goes on calling one of an instance that is gone.

    Args:
        messages: the list that becomes the attribute; for an instance that is refused.
        kind: fmpy's class of the instance; by default for co-simulation.
        library: in place of the FMU's own.
        options: of the instantiation in FMI 3.0.

    Attributes:
        messages: texts the unit has logged, with their status.
    """

    def __init__(
        self,
        path: Path | str,
        name: str = "unit",
        messages: list[tuple[int, str]] | None = None,
        kind: type | None = None,
        library: Path | None = None,
        **options: bool,
    ) -> None:
        self.description = described(Path(path))
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.messages = [] if messages is None else messages
        self._unpacked = TemporaryDirectory()
        is_two = self.description.fmiVersion == "2.0"
        interface = self.description.coSimulation or self.description.modelExchange
        kind = kind or (fmi2.FMU2Slave if is_two else fmi3.FMU3Slave)
        self.slave = kind(
            guid=self.description.guid,
            unzipDirectory=fmpy.extract(str(path), self._unpacked.name, _is_needed),
            modelIdentifier=interface.modelIdentifier,
            instanceName=name,
            libraryPath=library and str(library),
        )
        self._get = self.slave.getReal if is_two else self.slave.getFloat64
        self._set = self.slave.setReal if is_two else self.slave.setFloat64
        if is_two:
            self.callbacks = fmi2.fmi2CallbackFunctions()
            self._logger = fmi2.fmi2CallbackLoggerTYPE(self._log)  # kept alive for the C side
            self.callbacks.logger = self._logger
            self.callbacks.allocateMemory = fmi2.defaultCallbacks.allocateMemory
            self.callbacks.freeMemory = fmi2.defaultCallbacks.freeMemory
            self._options = {"callbacks": self.callbacks}
        else:
            self._options = {"logMessage": partial(self._log, None), **options}
        self.instantiate()

    def instantiate(self) -> None:
        """Make the instance, or another one after it is freed."""
        self.slave.instantiate(loggingOn=True, **self._options)

    def _log(self, _environment, _instance, status, _category, message) -> None:
        try:  # a Python unit logs with its exception pending, which `decode` would be blamed for
            raise LookupError
        except Exception:
            self.messages.append((status, (message or b"").decode()))

    def begin(self, values: dict[str, float | bool] | None = None) -> Host:
        """From instantiation, or after a reset, to the end of initialisation."""
        self.time = 0.0
        if self.description.fmiVersion == "2.0":
            self.slave.setupExperiment()
        self.slave.enterInitializationMode()
        self.set(values or {})
        self.slave.exitInitializationMode()
        return self

    def references(self, *names: str) -> list[int]:
        """Value references of variables."""
        return [self.variables[name].valueReference for name in names]

    def set(self, values: dict[str, float | bool]) -> None:
        """Set variables by name."""
        for name, value in values.items():
            setter = self.slave.setBoolean if isinstance(value, bool) else self._set
            setter(self.references(name), [value])

    def get(self, *names: str) -> list[float]:
        """Values of Reals by name."""
        return self._get(self.references(*names))

    def outputs(self) -> list[float]:
        """All outputs."""
        return self.get(*(n for n, v in self.variables.items() if v.causality == "output"))

    def step(self, length: float) -> None:
        """One communication step from where the unit is."""
        self.slave.doStep(self.time, length)
        self.time += length

    def run(self, steps: int, length: float = 1e-3) -> list[float]:
        """All outputs after some steps."""
        for _ in range(steps):
            self.step(length)
        return self.outputs()

    def driven(self, times: Sequence[float], names: Sequence[str]) -> NDArray:
        """Outputs at all times, (times, names)."""
        rows = [self.get(*names)]
        for begin, end in itertools.pairwise(times):
            self.time = begin
            self.step(end - begin)
            rows.append(self.get(*names))
        return np.array(rows)

    def refused(self, call: Callable[[], object]) -> str:
        """The reason logged for a call that must fail."""
        before = len(self.messages)
        try:
            call()
        except FMICallException:
            # pythonfmu adds a message of its own
            return next(text for status, text in self.messages[before:] if status > 1)
        raise AssertionError("the call was not refused")

    def free(self) -> None:
        """End the instance."""
        self.slave.freeInstance()


def refusal(path: Path, **options: bool) -> str:
    """The one reason logged by an FMU that must not be instantiated."""
    messages: list[tuple[int, str]] = []
    with pytest.raises(Exception, match="nstantiate"):
        Host(path, messages=messages, **options)
    ((status, text),) = messages
    assert status == 3
    assert "instantiation failed: " in text
    return text
