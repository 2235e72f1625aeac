"""One FMU instance behind arrays of its own, so that a call costs a C call and nothing else.

`Library` loads the library and declares its functions, which are called directly here with buffers
made once: fmpy's wrappers build ctypes arrays at every call.
"""

from __future__ import annotations

import shutil
import zipfile
from collections.abc import Sequence
from ctypes import byref, c_double, c_int, c_size_t, c_uint, c_void_p, create_string_buffer
from pathlib import Path
from tempfile import mkdtemp
from typing import TYPE_CHECKING

import fmpy
import numpy as np
from fmpy import fmi2
from fmpy.model_description import ModelDescription

from ..errors import SimulationError, UnitError
from .library import Library
from .names import readable

if TYPE_CHECKING:
    from typing_extensions import Self

_WARNING = fmi2.fmi2Warning
_STATUS = ("OK", "Warning", "Discard", "Error", "Fatal", "Pending")


def measured_in(description: ModelDescription) -> dict[str, str]:
    """Unit of measurement of every variable as an FMU declares it; empty where it has none."""
    declared = {
        v.name: v.unit or getattr(v.declaredType, "unit", None) for v in description.modelVariables
    }
    return {name: readable(unit or "") for name, unit in declared.items()}


class Variables:
    """Some Real variables of a unit that are read or written in one call.

    Attributes:
        vectors: the buffer as complex numbers, where the variables are pairs of components.
    """

    __slots__ = ("buffer", "names", "references", "size", "vectors")

    def __init__(self, names: Sequence[str], references: Sequence[int]) -> None:
        self.names = tuple(names)
        self.size = len(references)
        self.references = (c_uint * self.size)(*references)
        self.buffer = (c_double * self.size)()
        self.vectors = np.ctypeslib.as_array(self.buffer)[: self.size // 2 * 2].view(complex)


class Closing:
    """What is closed at the end of a `with` block."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.close()

    def close(self) -> None:
        """Give back what is held."""
        raise NotImplementedError


class Fmu(Closing):
    """An instance of an FMI 2.0 co-simulation FMU.

    Args:
        path: the `.fmu` file.
        name: instance name, used in messages.

    Raises:
        UnitError: the file is missing, is no FMU, or cannot be instantiated here.
    """

    def __init__(self, path: Path, name: str) -> None:
        self.path, self.name = Path(path), name
        self.time = 0.0
        self.calls = {"set": 0, "get": 0, "step": 0, "save": 0, "restore": 0, "reset": 0}
        self.messages: list[str] = []
        self._directory = mkdtemp(prefix="autobalancer-")
        self._alive = False
        try:
            self._load()
        except BaseException:
            self.close()
            raise

    def _load(self) -> None:
        if not self.path.is_file():
            raise UnitError(f"{self.path}: no such FMU file")
        try:
            self.description = fmpy.read_model_description(str(self.path))
            fmpy.extract(str(self.path), unzipdir=self._directory)
        except (zipfile.BadZipFile, OSError, KeyError) as error:
            raise UnitError(f"{self.path}: not a readable FMU (zip archive): {error}") from error
        except Exception as error:  # fmpy raises bare Exceptions for anything wrong in the XML
            raise UnitError(f"{self.path}: its modelDescription.xml is wrong: {error}") from error
        if self.description.coSimulation is None or self.description.fmiVersion != "2.0":
            raise UnitError(f"{self.path}: must be an FMI 2.0 co-simulation FMU")
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.measured_in = measured_in(self.description)
        callbacks = fmi2.fmi2CallbackFunctions()
        self._logger = fmi2.fmi2CallbackLoggerTYPE(self._log)  # kept alive for the C side
        callbacks.logger = self._logger
        callbacks.allocateMemory = fmi2.defaultCallbacks.allocateMemory
        callbacks.freeMemory = fmi2.defaultCallbacks.freeMemory
        try:
            self.fmu = Library(self._directory, self.description.coSimulation.modelIdentifier)
            self._callbacks = callbacks  # kept alive for the C side
            self.fmu.instantiate(self.name, self.description.guid, callbacks)
        except (OSError, AttributeError) as error:
            raise UnitError(
                f"{self.path}: cannot be instantiated: {self._reason(error)}"
            ) from error
        self._alive = True
        dll = self.fmu.dll
        self._component = self.fmu.component
        self._get, self._set = dll.fmi2GetReal, dll.fmi2SetReal
        self._step, self._save = dll.fmi2DoStep, dll.fmi2GetFMUstate
        self._restore, self._free = dll.fmi2SetFMUstate, dll.fmi2FreeFMUstate

    def _log(self, _environment, _instance, status, _category, message) -> None:
        text = message.decode("utf-8", "replace") if message else ""
        if status >= _WARNING:
            self.messages.append(text)

    def _reason(self, error: object) -> str:
        return "; ".join([*self.messages[-3:], str(error)]) if self.messages else str(error)

    def _check(self, status: int, action: str) -> None:
        if status > _WARNING:
            reason = "; ".join(self.messages[-3:]) or "no reason was logged"
            raise SimulationError(
                f"{self.name} at t = {self.time:g} s: {action} failed "
                f"({_STATUS[min(status, 5)]}): {reason}"
            )

    def group(self, names: Sequence[str]) -> Variables:
        """Real variables to be read or written together.

        Raises:
            UnitError: the FMU has no such variable (built for another scene or version).
        """
        missing = [name for name in names if name not in self.variables]
        if missing:
            raise UnitError(
                f"{self.path}: has no variable {missing[0]!r}, which {self.name!r} of this scene "
                f"needs; the FMU is of a different build (model {self.description.modelName}, "
                f"{self.description.generationDateAndTime}): build it for this scene"
            )
        return Variables(names, [self.variables[name].valueReference for name in names])

    def reference(self, name: str) -> int:
        """Value reference of a variable.

        Raises:
            UnitError: as `group`.
        """
        return self.group([name]).references[0]

    def get(self, group: Variables) -> list[float]:
        """Values of the group's variables."""
        self._read(group)
        return group.buffer[:]

    def get_vectors(self, group: Variables) -> list[complex]:
        """Values of a group of pairs, x + i y each."""
        self._read(group)
        return group.vectors.tolist()

    def _read(self, group: Variables) -> None:
        self.calls["get"] += 1
        status = self._get(self._component, group.references, group.size, group.buffer)
        if status > _WARNING:
            self._check(status, f"reading {', '.join(group.names[:4])}")

    def set(self, group: Variables, values: Sequence[float]) -> None:
        """Write the group's variables."""
        group.buffer[:] = values  # type: ignore[call-overload]  # any sequence will do
        self._write(group)

    def set_vectors(self, group: Variables, vectors: Sequence[complex]) -> None:
        """Write a group of pairs, x + i y each."""
        group.vectors[:] = vectors
        self._write(group)

    def _write(self, group: Variables) -> None:
        self.calls["set"] += 1
        status = self._set(self._component, group.references, group.size, group.buffer)
        if status > _WARNING:
            self._check(status, f"setting {', '.join(group.names[:4])}")

    def step(self, time: float, step: float) -> None:
        """Advance by `step` [s] from `time` [s]."""
        self.calls["step"] += 1
        self.time = time
        status = self._step(self._component, time, step, 1)
        if status > _WARNING:
            self._check(status, f"a step of {step:g} s")

    def save(self) -> c_void_p:
        """A copy of the complete state; give it back with `free`."""
        self.calls["save"] += 1
        state = c_void_p()
        status = self._save(self._component, byref(state))
        if status > _WARNING:
            self._check(status, "saving the state")
        return state

    def restore(self, state: c_void_p) -> None:
        """Roll back to a saved state."""
        self.calls["restore"] += 1
        status = self._restore(self._component, state)
        if status > _WARNING:
            self._check(status, "restoring the state")

    def free(self, state: c_void_p) -> None:
        """Release a saved state."""
        self._free(self._component, byref(state))

    def restart(self, parameters: dict[str, float | bool], time: float = 0.0) -> None:
        """Reset, set parameters and start values, and enter initialisation mode.

        Raises:
            UnitError: the FMU lacks a parameter the scene needs.
        """
        self.time = time
        self.calls["reset"] += 1
        dll, component = self.fmu.dll, self._component
        self._check(dll.fmi2Reset(component), "reset")
        self._check(dll.fmi2SetupExperiment(component, 0, 0.0, time, 0, 0.0), "set-up")
        reals = {k: v for k, v in parameters.items() if not isinstance(v, bool)}
        self.set(self.group(list(reals)), [float(v) for v in reals.values()])
        for name, value in parameters.items():
            if isinstance(value, bool):
                reference = self.group([name]).references
                self._check(
                    dll.fmi2SetBoolean(component, reference, 1, (c_int * 1)(value)),
                    f"setting {name}",
                )
        self._check(dll.fmi2EnterInitializationMode(component), "initialisation")

    def start(self) -> None:
        """Leave initialisation mode: the unit checks its parameters now."""
        self._check(self.fmu.dll.fmi2ExitInitializationMode(self._component), "initialisation")

    def serialise(self, state: c_void_p) -> bytes:
        """A saved state as bytes."""
        size = c_size_t()
        dll, component = self.fmu.dll, self._component
        self._check(dll.fmi2SerializedFMUstateSize(component, state, byref(size)), "serialising")
        buffer = create_string_buffer(size.value)
        self._check(dll.fmi2SerializeFMUstate(component, state, buffer, size.value), "serialising")
        return buffer.raw

    def close(self) -> None:
        """Free the instance and remove the extracted files."""
        if self._alive:
            self._alive = False
            self.fmu.free()
        shutil.rmtree(self._directory, ignore_errors=True)
