"""Units of FMI 2.0 and 3.0: the calls that differ."""

from __future__ import annotations

import math
from collections.abc import Mapping
from ctypes import byref
from pathlib import Path
from typing import Any

from fmpy import fmi2, fmi3
from fmpy.fmi1 import FMICallException

from ...errors import SimulationError, UnitError
from ..library import callbacks_to, resources_of
from .archive import read_description
from .failures import EndAsked
from .instance import ForeignUnit


class Fmi2Unit(ForeignUnit):
    """An instance of FMI 2.0."""

    def _make(self) -> None:
        self._callbacks = callbacks_to(self._log)  # kept alive for the C side
        self.fmu = fmi2.FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=str(self.folder),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=self.name,
        )
        self.fmu.component = self.fmu.fmi2Instantiate(
            self.name.encode(),
            fmi2.fmi2CoSimulation,
            self.description.guid.encode(),
            resources_of(self.folder),
            byref(self._callbacks),
            0,
            1,
        )
        if not self.fmu.component:
            self.fmu.freeLibrary()
            raise UnitError(f"{self.path}: cannot be instantiated{self._said()}")

    def _begin(self, start: Mapping[str, Any]) -> None:
        self._checked("set-up", self.fmu.setupExperiment)
        self._set_start(start)
        self._checked("initialisation", self.fmu.enterInitializationMode)

    def _do_step(self, time: float, step: float) -> None:
        try:
            self.fmu.doStep(time, step, not self.abilities.restores_state)
        except FMICallException as error:
            if error.status == fmi2.fmi2Discard and self._is_terminated():
                raise EndAsked(self._ends(time)) from error
            raise

    def _is_terminated(self) -> bool:
        """Whether a step was discarded because the unit asks to end."""
        if self.is_python:  # pythonfmu reports this status for every failed step
            return False
        try:
            return bool(self.fmu.getBooleanStatus(fmi2.fmi2Terminated))
        except Exception:  # a function that the library lacks, or that fails
            return False

    def _state(self, what: str) -> Any:
        return getattr(self.fmu, f"fmi2{what}FMUstate")

    def _get_derivatives(self, references: list[int]) -> list[float]:
        return list(self.fmu.getRealOutputDerivatives(references, [1] * len(references)))

    @staticmethod
    def _call_of(kind: str) -> str:
        return "Integer" if kind == "Enumeration" else kind


class Fmi3Unit(ForeignUnit):
    """An instance of FMI 3.0."""

    def _make(self) -> None:
        self.fmu = fmi3.FMU3Slave(
            guid=self.description.guid,
            unzipDirectory=str(self.folder),
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=self.name,
        )
        try:
            self.fmu.instantiate(loggingOn=True, logMessage=self._heard)
        except Exception as error:
            self.fmu.freeLibrary()
            self.fmu = None
            raise UnitError(f"{self.path}: cannot be instantiated{self._said()}") from error

    def _heard(self, _environment, status, _category, message) -> None:
        self._log(status, message.decode("utf-8", "replace") if message else "")

    def _begin(self, start: Mapping[str, Any]) -> None:
        self._set_start(start)
        self._checked("initialisation", self.fmu.enterInitializationMode)

    def _do_step(self, time: float, step: float) -> None:
        again = self.abilities.restores_state
        _, terminates, early, reached = self.fmu.doStep(
            time, step, noSetFMUStatePriorToCurrentPoint=not again
        )
        if terminates:
            raise EndAsked(self._ends(reached if early else time + step))
        if early and not math.isclose(reached, time + step, rel_tol=1e-9):
            raise SimulationError(f"the unit returned early, at t = {reached:g} s")

    def _state(self, what: str) -> Any:
        return getattr(self.fmu, f"fmi3{what}FMUState")

    def _get_derivatives(self, references: list[int]) -> list[float]:
        return list(self.fmu.getOutputDerivatives(references, [1] * len(references)))

    @staticmethod
    def _call_of(kind: str) -> str:
        return "Int64" if kind == "Enumeration" else kind


def foreign_unit(path: Path, name: str, key: str = "") -> ForeignUnit:
    """An instance of the FMU in a file.

    Args:
        key: that names the file, such as "machine.toml: unit[1].fmu"; an error begins with it.

    Raises:
        UnitError: it is no FMU that runs here.
    """
    try:
        old = read_description(path).fmiVersion.startswith("2.")
        return (Fmi2Unit if old else Fmi3Unit)(path, name)
    except UnitError as error:
        if not key:
            raise
        raise UnitError(f"{key}: {error}") from error
