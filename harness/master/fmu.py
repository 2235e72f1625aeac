"""One FMU instance behind arrays of its own, so that a call costs a C call and nothing else.

`Library` loads the library.  fmpy's wrappers build ctypes arrays at every call, and declared types
are converted at every call: half of what a call costs.  So functions are taken undeclared, and
those of a step are called with C values made once.
"""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from ctypes import Array, byref, c_double, c_int, c_size_t, c_uint, c_void_p
from pathlib import Path
from tempfile import mkdtemp

import fmpy
import numpy as np
from fmpy import fmi2

from ..errors import SimulationError, UnitError
from .closing import Closing
from .foreign.measures import measured_in
from .library import STATUS, Library, callbacks_to
from .unit_files import described

_WARNING = fmi2.fmi2Warning
_LAST_SUCCESSFUL_TIME = 2  # of fmi2StatusKind
_LOADED = (f"binaries/{fmpy.platform}/", "resources/")


def _is_loaded(name: str) -> bool:
    """Whether an instance needs this file: a hundred files of C cost more than many a run."""
    return name.startswith(_LOADED)


class EndedEarly(SimulationError):
    """A step that ended at an event, as the unit was told to.

    Attributes:
        made: length of the step as far as it came [s].
    """

    def __init__(self, name: str, time: float, made: float) -> None:
        super().__init__(f"{name}: an event {made:g} s behind t = {time:g} s")
        self.made = made


class Variables:
    """Some Real variables of a unit that are read or written in one call.

    Attributes:
        call: arguments of that call, as C values.
        reals: the buffer as an array.
        vectors: the same as complex numbers, where the variables are pairs of components.
    """

    __slots__ = ("buffer", "call", "names", "reals", "references", "size", "vectors")

    def __init__(
        self,
        component: c_void_p,
        names: Sequence[str],
        references: Sequence[int],
        memory: np.ndarray | None = None,
    ) -> None:
        self.names = tuple(names)
        self.size = len(references)
        self.references = (c_uint * self.size)(*references)
        self.reals = np.zeros(self.size) if memory is None else memory.reshape(-1).view(float)
        self.buffer: Array[c_double] = (c_double * self.size).from_buffer(self.reals.data)
        self.call = component, self.references, c_size_t(self.size), self.buffer
        self.vectors = self.reals[: self.size // 2 * 2].view(complex)


class Fmu(Closing):
    """An instance of an FMI 2.0 co-simulation FMU.

    Args:
        path: the `.fmu` file, from `unit_files.find_or_build`, which refuses any of another build.
        name: instance name, used in messages.

    Raises:
        UnitError: it cannot be instantiated here.
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
        self.description = described(self.path)
        try:
            fmpy.extract(str(self.path), unzipdir=self._directory, include=_is_loaded)
        except OSError as error:
            why = f"cannot be unpacked into {self._directory}: {error.strerror or error}"
            raise UnitError(f"{self.path}: {why}; free some room, or set TMPDIR") from error
        except Exception as error:  # FMPy refuses names that lead out of the folder by a bare one
            raise UnitError(f"{self.path}: cannot be unpacked: {error}") from error
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.measured_in = measured_in(self.description)
        self._callbacks = callbacks_to(self._log)  # kept alive for the C side
        try:
            self.fmu = Library(self._directory, self.description.coSimulation.modelIdentifier)
            self.fmu.instantiate(self.name, self.description.guid, self._callbacks)
        except OSError as error:
            reason = "; ".join([*self.messages[-3:], str(error)])
            raise UnitError(f"{self.path}: cannot be instantiated: {reason}") from error
        self._alive = True
        dll = self.fmu.dll
        self._component = self.fmu.component
        self._get, self._set, self._step = dll.fmi2GetReal, dll.fmi2SetReal, dll.fmi2DoStep
        self._begin, self._length, self._final = c_double(), c_double(), c_int(1)
        self._save, self._restore = dll.fmi2GetFMUstate, dll.fmi2SetFMUstate
        self._free = dll.fmi2FreeFMUstate

    def _log(self, status: int, text: str) -> None:
        if status >= _WARNING:
            self.messages.append(text)

    def _check(self, status: int, action: str) -> None:
        if status > _WARNING:
            reason = "; ".join(self.messages[-3:]) or "no reason was logged"
            del self.messages[-1:]  # the error tells it; a run that does without the step need not
            raise SimulationError(
                f"{self.name} at t = {self.time:g} s: {action} failed "
                f"({STATUS[min(status, 5)]}): {reason}"
            )

    def group(self, names: Sequence[str], memory: np.ndarray | None = None) -> Variables:
        """Real variables to be read or written together.

        Args:
            memory: array that serves as their buffer, contiguous and of as many reals, such as that
                of another unit's variables: what was fetched there is sent here without a copy.
        """
        references = [self.variables[name].valueReference for name in names]
        return Variables(self._component, names, references, memory)

    def get(self, group: Variables) -> list[float]:
        """Values of the group's variables."""
        self.fetch(group)
        return group.buffer[:]

    def fetch(self, group: Variables) -> None:
        """Read the group's variables into its buffer."""
        self.calls["get"] += 1
        status = self._get(*group.call)
        if status > _WARNING:
            self._check(status, f"reading {', '.join(group.names[:4])}")

    def set(self, group: Variables, values: Sequence[float]) -> None:
        """Write the group's variables."""
        group.buffer[:] = values  # type: ignore[call-overload]  # any sequence will do
        self.send(group)

    def send(self, group: Variables) -> None:
        """Write what the group's buffer holds."""
        self.calls["set"] += 1
        status = self._set(*group.call)
        if status > _WARNING:
            self._check(status, f"setting {', '.join(group.names[:4])}")

    def step(self, time: float, step: float) -> None:
        """Advance by `step` [s] from `time` [s].

        Raises:
            EndedEarly: the step ended at an event; the unit is there.
        """
        self.calls["step"] += 1
        self.time = self._begin.value = time
        self._length.value = step
        status = self._step(self._component, self._begin, self._length, self._final)
        if status > _WARNING:
            if status == fmi2.fmi2Discard and not self.fmu.runs_python:  # one of Python has failed
                reached = c_double()
                kind = _LAST_SUCCESSFUL_TIME
                self.fmu.dll.fmi2GetRealStatus(self._component, kind, byref(reached))
                raise EndedEarly(self.name, time, reached.value - time)
            self._check(status, f"a step of {step:g} s")

    def exchange(self, inputs: Variables, outputs: Variables, time: float, step: float) -> None:
        """`send`, `step` and `fetch` in one."""
        self.time = time
        self.send(inputs)
        self.step(time, step)
        self.fetch(outputs)

    def save(self, state: c_void_p) -> None:
        """Copy the complete state into one that is null, or over an earlier copy of this unit."""
        self.calls["save"] += 1
        if self.fmu.runs_python:  # pythonfmu makes a new copy and loses the one that is handed in
            self.free(state)
        status = self._save(self._component, byref(state))
        if status > _WARNING:
            self._check(status, "saving the state")

    def restore(self, state: c_void_p) -> None:
        """Roll back to a saved state."""
        self.calls["restore"] += 1
        status = self._restore(self._component, state)
        if status > _WARNING:
            self._check(status, "restoring the state")

    def free(self, state: c_void_p) -> None:
        """Release a saved state, which is null afterwards."""
        if state:
            self._free(self._component, byref(state))
            state.value = None

    def restart(self, parameters: dict[str, float | bool]) -> None:
        """Reset, set parameters and start values, and enter initialisation mode."""
        self.time = 0.0
        self.calls["reset"] += 1
        dll, component = self.fmu.dll, self._component
        self._check(dll.fmi2Reset(component), "reset")
        zero = c_double()
        self._check(dll.fmi2SetupExperiment(component, 0, zero, zero, 0, zero), "set-up")
        reals = {k: v for k, v in parameters.items() if not isinstance(v, bool)}
        self.set(self.group(list(reals)), [float(v) for v in reals.values()])
        for name, value in parameters.items():
            if isinstance(value, bool):
                reference = self.group([name]).references
                self._check(
                    dll.fmi2SetBoolean(component, reference, c_size_t(1), byref(c_int(value))),
                    f"setting {name}",
                )
        self._check(dll.fmi2EnterInitializationMode(component), "initialisation")

    def start(self) -> None:
        """Leave initialisation mode: the unit checks its parameters now."""
        self._check(self.fmu.dll.fmi2ExitInitializationMode(self._component), "initialisation")

    def close(self) -> None:
        """Free the instance and remove the extracted files."""
        if self._alive:
            self._alive = False
            self.fmu.free()
        shutil.rmtree(self._directory, ignore_errors=True)
