"""Native FMUs for the tests: the library that is shipped, with the Python units' description."""

from __future__ import annotations

import itertools
import shutil
import zipfile
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import fmpy
import numpy as np
from fmpy import fmi2, platform_tuple
from fmpy.fmi1 import FMICallException
from numpy.typing import NDArray

from autobalancer.fmus.build import build, contents
from autobalancer.fmus.catalogue import sized_unit
from autobalancer.fmus.native.build.compile import SOURCE, SOURCES, libraries, one_source, stamp
from autobalancer.fmus.native.build.layout import token
from tests.native.compiler import shared_library

LIBRARY = libraries([platform_tuple])[platform_tuple]  # what `build` packs
STAMP = stamp()


def compile_units(folder: Path, *flags: str | Path) -> Path:
    """Compile the one source with the compiler of this machine, and others among `flags`."""
    folder.mkdir(parents=True, exist_ok=True)
    source = folder / SOURCE
    source.write_text(one_source())
    # gcc does not see that a failure is read only where a function has filled it
    options = ("-fvisibility=hidden", "-Wno-maybe-uninitialized", f"-I{SOURCES}", *map(str, flags))
    return shared_library([str(source)], folder / "autobalancer.so", *options)


class Packager:
    """FMUs of both kinds, each built once for the same options."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.library = LIBRARY
        # as an unpacked FMU of FMI 3.0 has it
        self.unpacked = folder / "unpacked"
        platform = self.unpacked / "binaries" / "x86_64-linux"
        platform.mkdir(parents=True)
        shutil.copy(self.library, platform)
        self._numbers = itertools.count()
        self._built: dict[tuple, Path] = {}

    def token(self, unit: str, **options: object) -> str:
        """GUID or instantiation token of a native unit."""
        return token(sized_unit(unit, **options), STAMP)

    def native(self, unit: str, **options: object) -> Path:
        """A native FMU for FMI 2.0."""
        return self._once("native", unit, options)

    def python(self, unit: str, **options: object) -> Path:
        """The same unit in Python."""
        return self._once("python", unit, options)

    def layout(self, unit: str, **options: object):
        return sized_unit(unit, **options).layout

    def _once(self, runtime: str, unit: str, options: dict) -> Path:
        key = (runtime, unit, *sorted(options.items()))
        if key not in self._built:
            folder = self.folder / f"{runtime}-{next(self._numbers)}"
            made = self._native if runtime == "native" else partial(build, backend="python")
            self._built[key] = made(unit, folder, **options)
        return self._built[key]

    def _native(self, unit: str, folder: Path, **options) -> Path:
        description = contents(unit, **options)["modelDescription.xml"].decode()
        start = description.index('guid="') + len('guid="')
        end = description.index('"', start)
        description = description[:start] + self.token(unit, **options) + description[end:]
        folder.mkdir()
        path = folder / f"{unit}.fmu"
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("modelDescription.xml", description)
            archive.write(self.library, f"binaries/linux64/{unit}.so")
        return path


class Host:
    """An FMI 2.0 FMU under fmpy, with access by name.

    Attributes:
        messages: texts the unit has logged, with their status.
    """

    def __init__(self, path: Path, name: str = "unit") -> None:
        self.description = fmpy.read_model_description(str(path))
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.messages: list[tuple[int, str]] = []
        self.callbacks = fmi2.fmi2CallbackFunctions()
        self._logger = fmi2.fmi2CallbackLoggerTYPE(self._log)  # kept alive for the C side
        self.callbacks.logger = self._logger
        self.callbacks.allocateMemory = fmi2.defaultCallbacks.allocateMemory
        self.callbacks.freeMemory = fmi2.defaultCallbacks.freeMemory
        self._unpacked = TemporaryDirectory()
        self.slave = fmi2.FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=fmpy.extract(str(path), self._unpacked.name),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.slave.instantiate(callbacks=self.callbacks, loggingOn=True)
        self.time = 0.0

    def _log(self, _environment, _instance, status, _category, message) -> None:
        try:  # a Python unit logs with its exception pending, which `decode` would be blamed for
            raise LookupError
        except Exception:
            self.messages.append((status, (message or b"").decode()))

    def begin(self, values: dict[str, float | bool] | None = None) -> Host:
        """From instantiation, or after a reset, to the end of initialisation."""
        self.time = 0.0
        self.slave.setupExperiment()
        self.slave.enterInitializationMode()
        self.set(values or {})
        self.slave.exitInitializationMode()
        return self

    def set(self, values: dict[str, float | bool]) -> None:
        """Set variables by name."""
        for name, value in values.items():
            reference = [self.variables[name].valueReference]
            if isinstance(value, bool):
                self.slave.setBoolean(reference, [value])
            else:
                self.slave.setReal(reference, [value])

    def get(self, *names: str) -> list[float]:
        """Values of Reals by name."""
        return self.slave.getReal([self.variables[name].valueReference for name in names])

    def outputs(self) -> list[float]:
        """All outputs."""
        return self.get(*(n for n, v in self.variables.items() if v.causality == "output"))

    def step(self, length: float) -> None:
        """One communication step from where the unit is."""
        self.slave.doStep(self.time, length)
        self.time += length

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
        self.slave.freeInstance()
