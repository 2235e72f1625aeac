"""`System`: units of any origin and their connections, with what is done with them."""

from __future__ import annotations

import atexit
import shutil
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import PrivateAttr

from autobalancer.harness.scene import system as description

if TYPE_CHECKING:
    from autobalancer.harness.output.workers import Progress
    from autobalancer.harness.result.result import Result


class UnitRun(description.UnitRun):
    """How long, and what is recorded; called, the system's run."""

    _system: Any = PrivateAttr(default=None)

    def __call__(
        self, *, record: Iterable[str] | None = None, progress: Progress | None = None
    ) -> Result:
        """Run the system, as `system.run()`.

        Args:
            record: signals as `unit.variable`; default: the system's, or all outputs.

        Returns:
            Signals (T,) at the communication points, as the units declare them.

        Raises:
            UserError: the system or an FMU is wrong, or a unit fails.
            SimulationError: the run cannot be completed correctly.

        >>> built = ab.load("two_balls").build("units", platforms=["x86_64-linux"])
        >>> rotor = ab.load_system("units/rotor.fmu")
        >>> list(rotor.run(record=["rotor.x"]).signals)
        ['rotor.x']
        """
        from autobalancer.harness.result.system import run_system

        return run_system(self._system, record=record, progress=progress)


class System(description.System):
    """FMUs of any origin and their connections.

    Make one with `load_system`, or `System(unit=[...], connection=[...], run={...})`.
    """

    run: UnitRun
    """How long, and what is recorded."""

    def _fill(self, document: dict[str, Any], path: Path | None, label: str) -> None:
        super()._fill(document, path, label)
        object.__setattr__(self.run, "_system", self)


def load_system(source: str | Path) -> System:
    """Read a system of units: a scene file without a rotor, an SSP, or an FMU that runs alone.

    Raises:
        SceneError: the file is missing or wrong; one line for every problem.
        UnitError: an FMU is none that runs here.

    >>> built = ab.load("two_balls").build("units", platforms=["x86_64-linux"])
    >>> rotor = ab.load_system("units/rotor.fmu")
    >>> rotor
    <System 'RotorOnSupports': rotor; 0 connections>
    """
    path = Path(source)
    if path.suffix == ".fmu":
        from autobalancer.harness.master.foreign.alone import document_of

        return System._of(document_of(path), path, str(source))
    if path.suffix == ".ssp" and path.is_file():
        from autobalancer.harness.master.foreign.ssp import unpacked_system

        document, folder = unpacked_system(path)
        # changed copies name the FMUs from this folder too
        atexit.register(shutil.rmtree, folder, ignore_errors=True)
        return System._of(document, folder / path.with_suffix("").name, str(source))
    return System.load(source)
