"""`System`: units of any origin and their connections, with what is done with them."""

from __future__ import annotations

import atexit
import shutil
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import PrivateAttr

from autobalancer.harness.scene import system as description

if TYPE_CHECKING:
    from autobalancer.harness.fit.systems import SystemFit
    from autobalancer.harness.output.workers import Progress, Workers
    from autobalancer.harness.result.result import Result
    from autobalancer.harness.scatter.systems import SystemScatter


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

    def scatter(
        self,
        vary: Mapping[str, Any] | Iterable[str],
        n: int = 1000,
        *,
        seed: int = 1,
        workers: Workers = 1,
        progress: Progress | None = None,
    ) -> SystemScatter:
        """Systems whose start values scatter, each run.

        Args:
            vary: a distribution for every `unit.variable`: text such as "normal(10,5%)", or one of
                `scipy.stats` with its parameters; or texts "PATH=NAME(NUMBERS)".
            n: systems.
            seed: the same seed draws the same systems.
            workers: processes, for which a script needs `if __name__ == "__main__":`, or an
                executor.

        Returns:
            Of every recorded signal the largest magnitude and the value at the end, (n,) each.

        Raises:
            UserError: a path is no start value, or a distribution is wrong.
            SimulationError: every system has failed.

        >>> built = ab.load("two_balls").build("units", platforms=["x86_64-linux"])
        >>> rotor = ab.load_system("units/rotor.fmu").replace({"run.duration": 0.1})
        >>> found = rotor.scatter({"rotor.mass": "normal(1,10%)"}, n=3)
        >>> found.largest.shape == (3, len(found.signals))
        True
        """
        from autobalancer.harness.scatter.systems import scatter_system

        return scatter_system(self, vary, n, seed=seed, workers=workers, progress=progress)

    def fit(
        self,
        measured: str | Path,
        free: str | Sequence[str],
        *,
        limits: Sequence[str] = (),
        priors: Sequence[str] = (),
        scatter: float = 0.1,
        progress: Progress | None = None,
    ) -> SystemFit:
        """Start values of units from signals that were measured over time, by least squares.

        Args:
            measured: a CSV file with heads `time [s]` and `unit.variable [UNIT]`.
            free: paths `unit.variable` to find, with commas or as a list; "PATH=PATH" is one value
                for both.
            limits: "PATH=LOW:HIGH", between which a value stays; default: those of the FMU.
            priors: "PATH=DEVIATION", how far off the start may be.
            scatter: standard deviation of a difference, over the signal's largest value, against
                which priors are weighed.

        Returns:
            Values with 95 % intervals, or none where the residuals are systematic; `system` is the
            system with them.

        Raises:
            UserError: the file or a path is wrong, or there are too few measurements.
            SimulationError: a run has failed.

        >>> built = ab.load("two_balls").build("units", platforms=["x86_64-linux"])
        >>> rotor = ab.load_system("units/rotor.fmu")
        >>> rotor = rotor.replace({"run.duration": 0.5, "rotor.speed": 300.0})
        >>> result = rotor.replace({"rotor.mass": 2.2}).run(record=["rotor.x"])
        >>> path = result.to_csv("measured.csv")
        >>> found = rotor.fit("measured.csv", "rotor.mass")
        >>> round(float(found.values[0]), 4)
        2.2
        """
        from autobalancer.harness.fit.systems import fit_system

        options: dict[str, Any] = {"limits": limits, "priors": priors, "scatter": scatter}
        return fit_system(self, measured, free, **options, progress=progress)

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
