"""A system of units of any origin run from its start to its end."""

from __future__ import annotations

import time as clock
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, cast

from ..master.facts import events_of_units
from ..master.global_error import Controlled
from ..master.recorder import Recorder, Signal
from ..master.unit_run import UnitRun
from ..scene.system import System
from ..scene.unit import split_port
from .result import Result

if TYPE_CHECKING:
    from ..master.simulation import CoupledRun
    from ..output.workers import Progress


def recorded_again(
    run: UnitRun, names: Iterable[str], changes: Mapping[str, Any]
) -> tuple[Signal, dict[str, Signal]]:
    """Times and signals of a run in given steps, of units that are loaded already.

    Args:
        changes: start values by `unit.variable`, in place of the system's.

    Raises:
        UserError: a unit fails.
        SimulationError: the run cannot be completed correctly.
    """
    by_unit: dict[str, dict[str, Any]] = {}
    for path, value in changes.items():
        unit, variable = split_port(path)
        by_unit.setdefault(unit, {})[variable] = value
    recorder = Recorder(run.units, list(names))
    run.start(by_unit)
    run.record(recorder, None)
    return recorder.columns()


def run_system(
    system: System, *, record: Iterable[str] | None = None, progress: Progress | None = None
) -> Result:
    """Run a system of units and return what it recorded.

    Args:
        record: signals as `unit.variable`; by default the system's, or all outputs.
        progress: called with the finished fraction now and then.

    Raises:
        UserError: the system or an FMU is wrong, or a unit fails.
        SimulationError: the run cannot be completed correctly.
    """
    with UnitRun(system) as run:
        names = run.recorded() if record is None else list(record)
        begin = clock.perf_counter()
        if system.coupling.tolerance is not None and run.coupled:
            controlled = Controlled(cast("CoupledRun", run), names)
            recorder, error = controlled.run(progress), controlled.error
        else:
            recorder, error = Recorder(run.units, names), 0.0
            run.start()
            run.record(recorder, progress)
        seconds = clock.perf_counter() - begin
        facts = replace(run.facts(), estimated_error=error)
    if progress:
        progress(1.0)
    time, signals = recorder.columns()
    return Result(
        scene_title=system.heading,
        time=time,
        signals={name: signals[name] for name in names},
        seconds=seconds,
        units=facts.files,
        events=tuple(events_of_units(facts, system.coupling.tolerance, run.coupled)),
        steps=facts.steps,
        passes=facts.passes,
        calls=dict(facts.calls),
        unconverged=facts.unconverged,
        estimated_error=facts.estimated_error,
        signal_units={name: recorder.signal_units[name] for name in names},
    )
