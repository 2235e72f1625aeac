"""Start values of a system of units from signals that were measured over time, by least squares.

All runs of a fit take the same communication steps: those of a first run with the system's
tolerance.  So their errors are alike, and differences of runs show what the values do.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from scipy.interpolate import Akima1DInterpolator

from ...models.arrays import Array
from ..errors import SimulationError, UserError
from ..master.closing import Closing
from ..master.foreign.abilities import check_start, variable_of
from ..master.unit_run import UnitRun
from ..result.system import recorded_again, run_system
from ..scene.system import System
from .estimate import Estimate, document_of_values, of_values, refuse_few
from .parameters import SCATTER, Parameter, parse_free
from .search import known, rms, search
from .series import MeasuredSignals, read_signals
from .systematic import significance

if TYPE_CHECKING:
    from ..output.workers import Progress

END_ROUNDING = 1e-9  # of the last measured time: sums of steps end so near to it


class SystemModel(Closing):
    """Runs of a system, at the times of a measurement; to be closed.

    Attributes:
        parameters: what is free.
        scale: of every value: the largest magnitude that was measured of its signal.
    """

    most_steps = 60  # of a search

    def __init__(
        self, system: System, parameters: Sequence[Parameter], measured: MeasuredSignals
    ) -> None:
        self.parameters, self._measured = parameters, measured
        self._run = UnitRun(_in_equal_steps(system))
        largest = {n: np.nanmax(np.abs(column)) for n, column in measured.signals.items()}
        count = len(measured.time)
        self.scale = measured.flat({n: np.full(count, one or 1.0) for n, one in largest.items()})

    def logarithms(self, sets: Array) -> Array:
        """What would be measured (s, values) with parameters (s, p), over `scale`.

        Raises:
            SimulationError: a run has failed, or ended before the last measurement.
        """
        found = []
        for values in sets.tolist():
            pairs = zip(self.parameters, values, strict=True)
            changes = {k: v for one, x in pairs for k, v in one.changes(x).items()}
            time, signals = recorded_again(self._run, self._measured.signals, changes)
            last = self._measured.time[-1]
            if time[-1] < last * (1.0 - END_ROUNDING):
                raise SimulationError(
                    f"a run ends at t = {time[-1]:g} s, before the last measurement at {last:g} s: "
                    "leave out what was measured later"
                )
            places = np.minimum(self._measured.time, time[-1])
            at = {name: Akima1DInterpolator(time, s)(places) for name, s in signals.items()}
            found.append(self._measured.flat(at) / self.scale)
        return np.array(found)

    def close(self) -> None:
        """Free the units."""
        self._run.close()


def _in_equal_steps(system: System) -> System:
    """The system in the steps that its tolerance needs, given."""
    if system.coupling.tolerance is None:
        return system
    steps = run_system(system).steps
    return system.replace({"coupling.step": system.run.duration / steps})


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class SystemFit(Estimate[System]):
    """What was found, in the units of the FMUs.

    Attributes:
        measured: signals over time.
        simulated: (n,) with these values, column after column of what was measured.
        residuals: (n,) simulated less measured, over the largest measured value of the signal.
    """

    drawn_by: ClassVar[str] = "..fit.plot_system:plot_fit"
    document_by: ClassVar[str] = "..fit.systems:document"
    measures: ClassVar[str] = "signals"

    measured: MeasuredSignals
    simulated: Array
    residuals: Array

    @property
    def system(self) -> System:
        """The system with the values that were found."""
        found: System = self._fitted()
        return found

    def predicted_rms(self, measured: str | Path) -> float:
        """Rms of the difference from other measurements, with the values that were found.

        Raises:
            UserError: the file is wrong.
            SimulationError: a run has failed.
        """
        others = read_signals(Path(measured), self.start)
        with SystemModel(self.start, self.parameters, others) as model:
            return rms(model.logarithms(self.values[None])[0] - others.values / model.scale)

    def _of_residuals(self) -> list[str]:
        """What residuals show."""
        if not self.is_systematic:
            return []
        return [
            f"residuals of neighbours in time {self._systematic()}: something is missing in the "
            "system; the values can be off by more than any interval from scatter, so none is given"
        ]


def fit_system(
    system: System,
    measured: str | Path,
    free: str | Sequence[str],
    *,
    limits: Sequence[str] = (),
    priors: Sequence[str] = (),
    scatter: float = SCATTER,
    progress: Progress | None = None,
) -> SystemFit:
    """Find start values by least squares (SciPy's trust region), Jacobian by differences.

    Arguments are those of `System.fit`, which says what is raised.
    """
    texts = [free] if isinstance(free, str) else free
    parameters = parse_free(texts, system, limits, priors, scatter, _parameter)
    data = read_signals(Path(measured), system)
    refuse_few(measured, len(data.values), parameters)
    with SystemModel(system, parameters, data) as model:
        return _fitted(model, system, data, progress)


def _fitted(
    model: SystemModel, system: System, data: MeasuredSignals, progress: Progress | None
) -> SystemFit:
    parameters, count = model.parameters, len(data.values)
    scale = np.array([one.start for one in parameters])
    aim, none = data.values / model.scale, np.zeros(count, bool)
    solution = search(model, aim, none, np.ones(len(parameters)), progress)
    uncertainty, correlation, inflation = known(solution.jac, solution.fun)
    own = slice(count)  # priors follow
    chance = significance(solution.fun[own], solution.jac[own], data.sequences())
    before, after = model.logarithms(np.array([scale, solution.x * scale]))
    return SystemFit(
        start=system,
        measured=data,
        correlation=correlation,
        inflation=inflation,
        simulated=after * model.scale,
        residuals=after - aim,
        rms=(rms(before - aim), rms(after - aim)),
        **of_values(parameters, solution, chance, uncertainty),
    )


def _parameter(paths: tuple[str, ...], system: System) -> Parameter:
    """One free parameter for start values with the paths `unit.variable`; it starts at the first.

    Raises:
        UserError: there is no such start value, or it is no number, or 0.
    """
    with UnitRun(system) as run:
        found = []
        for path in paths:
            unit, _, variable = path.partition(".")
            if unit not in run.units:
                raise UserError(
                    f"--free {path}: must be UNIT.VARIABLE, a start value of one of: "
                    f"{', '.join(run.units)}"
                )
            declared = variable_of(run.units[unit], variable, f"--free {path}")
            given = next(one.start for one in system.unit if one.name == unit)
            found.append((given.get(variable, declared.start), declared))
            check_start(run.units[unit], {variable: 1.0})
    value, declared = found[0]
    try:
        start = float(value)
    except (TypeError, ValueError):
        raise UserError(f"--free {paths[0]}: has no start value: set it") from None
    if start == 0.0:
        raise UserError(f"--free {paths[0]}: starts at 0, from where nothing has a size: set it")
    low = -math.inf if declared.min is None else float(declared.min)
    high = math.inf if declared.max is None else float(declared.max)
    return Parameter(paths, start, (low, high))


def document(found: SystemFit) -> dict[str, Any]:
    """Everything that the command says."""
    return document_of_values(found, found.measured.path, len(found.measured.values))


def lines(found: SystemFit) -> list[str]:
    """What the table does not say."""
    said = document(found)
    options = " ".join(
        f'--set "{path}={one["value"]:.6g}"'
        for one in said["parameters"]
        for path in one["path"].split("=")
    )
    return [
        f"{said['values']} measured values; rms of the difference over the signal's largest value: "
        f"{said['rms_before']:.4g} before, {said['rms']:.4g} after",
        *(f"Warning: {text}" for text in said["warnings"]),
        f"As options: {options}",
    ]
