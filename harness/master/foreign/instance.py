"""An instance of a unit of any origin, with the calls that the coupling makes of our own units.

fmpy makes the calls.  A unit that fails ends the run with its own words; one that does not come
back when it is freed is left behind after some seconds, and named.
"""

from __future__ import annotations

import os
import shutil
from abc import abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from ctypes import byref, c_void_p
from pathlib import Path
from typing import Any

import numpy as np
from fmpy.fmi1 import FMICallException

from ...errors import UnitError
from ..closing import Closing
from ..library import STATUS, runs_python
from . import crashes, python_guest
from .abilities import abilities, kind_of
from .archive import read_description, unpacked
from .failures import EndAsked, UnitFailure, free_in_time
from .group import Group
from .measures import measured_in

_MOST_MESSAGES = 100  # that are kept
_only_once: set[Path] = set()  # files whose one instance lives


class ForeignUnit(Closing):
    """An instance of an FMU for co-simulation that this installation has not built.

    Args:
        path: of the file.
        name: of the unit.

    Attributes:
        folder: where the file is unpacked.
        abilities: what the unit can.
        variables: by name; `measured_in` by name, for people.
        calls: number of FMI calls by kind; `messages` what it has logged.
        is_python: whether pythonfmu made the file.

    Raises:
        UnitError: it is no FMU that runs here.
    """

    def __init__(self, path: Path, name: str) -> None:
        self.path, self.name, self.time = path, name, 0.0
        self.description = read_description(path)
        self.abilities = abilities(self.description)
        self.variables = {v.name: v for v in self.description.modelVariables}
        self.measured_in = measured_in(self.description)
        self.calls = {"set": 0, "get": 0, "step": 0, "save": 0, "restore": 0, "reset": 0}
        self.messages: list[str] = []
        self.fmu: Any = None
        self._once = path.resolve() if self.abilities.only_once else None
        if self._once in _only_once:
            raise UnitError(
                f"{path}: can be instantiated only once per process, and {name!r} is its second "
                "unit: give it a copy of the file under another name"
            )
        self._running = False  # initialised, and has not failed
        self._has_failed = False
        self.folder = unpacked(path)
        if self._once:
            _only_once.add(self._once)
        self.is_python = runs_python(self.folder)
        crashes.watch(self)

    def group(self, names: Iterable[str], memory: np.ndarray | None = None) -> Group:
        """Variables to be read or written together; `memory` holds their values as reals."""
        return Group([self.variables[name] for name in names], memory)

    def get(self, group: Group) -> list[float]:
        """Values of the group's variables."""
        self.fetch(group)
        return [float(value) for value in group.reals]

    def set(self, group: Group, values: Sequence[float]) -> None:
        """Write the group's variables."""
        group.reals[:] = values
        self.send(group)

    def fetch(self, group: Group) -> None:
        """Read the group's variables."""
        self.calls["get"] += 1
        for kind, places, references in group.parts:
            getter = getattr(self.fmu, f"get{self._call_of(kind)}")
            values = self._checked(f"reading {', '.join(group.names[:4])}", getter, references)
            group.reals[places] = values

    def send(self, group: Group) -> None:
        """Write what the group holds."""
        self.calls["set"] += 1
        for kind, places, references in group.parts:
            values = group.reals[places]
            name = kind_of(kind)
            whole = [round(v) for v in values] if name == "integer" else values.tolist()
            self._set(kind, references, [v != 0.0 for v in whole] if name == "boolean" else whole)

    def _set(self, kind: str, references: list[int], values: list[Any]) -> None:
        setter = getattr(self.fmu, f"set{self._call_of(kind)}")
        self._checked("setting values", setter, references, values)

    def step(self, time: float, step: float) -> None:
        """Advance by `step` [s] from `time` [s]."""
        self.calls["step"] += 1
        self.time = time
        self._checked(f"a step of {step:g} s", self._do_step, time, step)

    def save(self, state: c_void_p) -> None:
        """Copy the complete state into one that is null, or over an earlier copy of this unit."""
        self.calls["save"] += 1
        if self.is_python:  # pythonfmu makes a new copy and loses the one that is handed in
            self.free(state)
        self._checked("saving the state", self._state("Get"), self.fmu.component, byref(state))

    def restore(self, state: c_void_p) -> None:
        """Roll back to a saved state."""
        self.calls["restore"] += 1
        self._checked("restoring the state", self._state("Set"), self.fmu.component, state)

    def free(self, state: c_void_p) -> None:
        """Release a saved state, which is null afterwards."""
        if state and self.fmu is not None and not self._has_failed:
            self._checked("freeing a state", self._state("Free"), self.fmu.component, byref(state))
            state.value = None

    def restart(self, start: Mapping[str, Any]) -> None:
        """A new instance with these start values, in initialisation mode.

        A unit of unknown origin is made anew: what `reset` leaves behind would pass unseen.
        """
        self.calls["reset"] += 1
        self.time = 0.0
        self._free_instance()
        if self.is_python:
            python_guest.before_making(self.folder)
        folder = os.getcwd()  # fmpy leaves it changed where a library cannot be loaded
        crashes.asked.append((self, "loading"))
        try:
            self._make()
        except UnitError:
            raise
        except Exception as error:  # of ctypes and fmpy
            raise UnitError(f"{self.path}: cannot be loaded: {error}{self._said()}") from error
        finally:
            crashes.asked.pop()
            os.chdir(folder)
            if self.is_python:
                python_guest.after_making(self.folder)
        self._begin(start)

    def start(self) -> None:
        """Leave initialisation mode."""
        self._checked("initialisation", self.fmu.exitInitializationMode)
        self._running = True

    def derivatives(self, names: Sequence[str]) -> list[float]:
        """First derivatives of outputs, of a unit that gives them."""
        self.calls["get"] += 1
        references = [self.variables[name].valueReference for name in names]
        found = self._checked("reading derivatives", self._get_derivatives, references)
        return [float(value) for value in found]

    def set_derivatives(self, names: Sequence[str], orders: list[int], values: list[float]) -> None:
        """Derivatives of inputs at the start of a step, of a unit that takes them."""
        references = [self.variables[name].valueReference for name in names]
        act = self.fmu.setRealInputDerivatives
        self._checked("setting derivatives of inputs", act, references, orders, values)

    def _set_start(self, start: Mapping[str, Any]) -> None:
        for name, value in start.items():
            variable = self.variables[name]
            real = kind_of(variable.type) == "real"
            held = float(value) if real else value
            self._set(variable.type, [variable.valueReference], [held])

    def _checked(self, what: str, act: Any, *arguments: Any) -> Any:
        """What a call of the unit returns.

        Raises:
            UnitFailure: it failed.
        """
        crashes.asked.append((self, what))
        try:
            return act(*arguments)
        except EndAsked:
            raise
        except FMICallException as error:
            status = STATUS[min(int(getattr(error, "status", 3)), 5)]
            reason = f"{what} failed ({status})"
        except Exception as error:  # a function that the library lacks, or of ctypes
            reason = f"{what} failed: {error}"
        finally:
            crashes.asked.pop()
        self._running, self._has_failed = False, True
        raise UnitFailure(f"{self.name} ({self.path.name}) at t = {self.time:g} s: {reason}"
                          f"{self._said()}")  # fmt: skip

    def _ends(self, time: float) -> str:
        """What is said of a unit that asks to end at a time [s]."""
        return f"{self.name} ({self.path.name}) asks to end the simulation at t = {time:g} s"

    def _said(self) -> str:
        return f": {'; '.join(self.messages[-3:])}" if self.messages else ""

    def _log(self, status: int, text: str) -> None:
        if status >= 1 and len(self.messages) < _MOST_MESSAGES:
            self.messages.append(" ".join(text.split()))

    def _free_instance(self) -> None:
        """Free the instance, if there is one.

        Raises:
            UnitFailure: it does not come back.
        """
        fmu, self.fmu = self.fmu, None
        if fmu is None or not fmu.component:
            return
        if self._has_failed and self.is_python:
            return  # pythonfmu's loader would release what it has released after the exception
        acts = [*([fmu.terminate] if self._running else []), fmu.freeInstance]
        self._running = False
        free_in_time(self, acts)

    def close(self) -> None:
        """Free the instance and remove its files."""
        try:
            self._free_instance()
        finally:
            crashes.let_go(self)
            shutil.rmtree(self.folder, ignore_errors=True)
            _only_once.discard(self._once or Path())
            if self.is_python:
                python_guest.after_freeing(self.folder)

    @abstractmethod
    def _make(self) -> None:
        """Make an instance."""

    @abstractmethod
    def _begin(self, start: Mapping[str, Any]) -> None:
        """Set start values and enter initialisation mode."""

    @abstractmethod
    def _do_step(self, time: float, step: float) -> None:
        """Call of a step."""

    @abstractmethod
    def _state(self, what: str) -> Any:
        """Function that gets, sets or frees a state."""

    @abstractmethod
    def _get_derivatives(self, references: list[int]) -> list[float]:
        """First derivatives."""

    @staticmethod
    def _call_of(kind: str) -> str:
        """What calls for variables of a type are named by."""
        return kind
