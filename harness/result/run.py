"""A scene run from its start to its end, as its coupling asks."""

from __future__ import annotations

import time as clock
import warnings
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, cast

from ..errors import UserError, outer_level
from ..master.alone import friction_error
from ..master.compared import motion_signals
from ..master.facts import Facts, events
from ..master.global_error import Controlled
from ..master.left_out import left_out
from ..master.merged import merged_now
from ..master.one_file import why_separate
from ..master.recorder import Recorder, recorded
from ..master.two_tolerances import TwoTolerances
from ..scene import Scene, load_scene
from ..scene.plausible import warn
from .result import Result
from .velocity import recorded_for, velocities, with_velocities

if TYPE_CHECKING:
    from ..master.one_file_run import OneFileRun
    from ..master.simulation import CoupledRun
    from ..output.workers import Progress

NO_CALLS = "calls of FMI (the machine is integrated in one piece, from memory to memory)"


def cosimulate(
    scene: Scene | str | Path,
    *,
    record: Iterable[str] | None = None,
    fmus: str | Path | None = None,
    progress: Progress | None = None,
    separate: bool = False,
    one_file: bool | None = None,
) -> Result:
    """Run a scene and return what it recorded.

    The machine is integrated in one piece, as the scene's one file does it.  Separate FMUs, coupled
    in Python, run instead if `separate` or `fmus` is given, and for what one file does not have,
    units in Python and FMUs of any origin; then `Result.events` says so, and why.  The scheme, the
    order, the corrections and the steps of the coupling are of separate FMUs.

    Args:
        scene: a scene, the path of a scene file, or the name of a bundled scene.
        record: signals such as `rotor.x`; by default the scene's, an empty list records nothing.
        fmus: directory of ready-made FMUs instead of building them.
        progress: called with the finished fraction now and then.
        separate: couple separate FMUs in Python.
        one_file: deprecated, the default; True refuses a scene that one file does not cover.

    Raises:
        UserError: the scene or an FMU is wrong.
        SimulationError: the run cannot be completed correctly.

    Warns:
        ImplausibleWarning: a value is probably in another unit than it is taken to be.
    """
    if not isinstance(scene, Scene):
        scene = load_scene(scene)
    warn(scene)
    if isinstance(record, str):
        raise UserError(f'record = "{record}": must be a list: ["{record}"]')
    names = list(recorded(scene) if record is None else record)
    fmus = None if fmus is None else Path(fmus)
    if one_file is not None:
        warnings.warn(
            "one_file: one file is the default now; separate=True couples separate FMUs",
            DeprecationWarning,
            outer_level(),
        )
    if one_file:
        refuse_separate(scene, fmus)
    separate = separate or fmus is not None or one_file is False
    with load(scene, fmus, separate) as simulation:
        found = _run(simulation, scene, names, progress)
    if not separate and (why := why_separate(scene)):
        note = f"separate FMUs ran, coupled in Python, which is slower than one file in C: {why}"
        found = replace(found, events=(note, *found.events))
    return found


def refuse_separate(scene: Scene, fmus: str | Path | None) -> None:
    """Raise UserError where only separate units can run a scene, and one file is wanted."""
    if fmus is not None:
        raise UserError(f"{fmus}: holds separate FMUs, and one file is to run: give one of them")
    if why := why_separate(scene):
        raise UserError(why)


def load(scene: Scene, fmus: Path | None = None, separate: bool = False) -> OneFileRun | CoupledRun:
    """What steps a scene: its one file, or its separate units, see `cosimulate`."""
    if separate or why_separate(scene):
        from ..master.cosimulation import CoSimulation  # loads fmpy
        from ..master.mixed_run import MixedRun
        from ..master.plan import plan
        from ..master.unit_files import has_strangers

        if scene.guests or (fmus is not None and has_strangers(plan(scene).units, fmus)):
            return MixedRun(scene, fmus=fmus)
        return CoSimulation(scene, fmus=fmus)
    from ..master.one_file_run import OneFileRun  # compiles where it has to

    return OneFileRun(scene)


def is_in_one_piece(scene: Scene) -> bool:
    """Whether a run of the scene integrates the machine without a coupling inside."""
    return not why_separate(scene)


def tries_collocation(scene: Scene) -> bool:
    """Whether a run in one piece tries steps by collocation, as a stiff machine does, or may try.

    It is started to see, and not run.

    Raises:
        SimulationError: the machine cannot be started.
    """
    from ..master.one_file_run import OneFileRun  # compiles where it has to

    with OneFileRun(scene) as simulation:
        simulation.start()
        return simulation.is_stiff


def controlled_runs(
    simulation: OneFileRun | CoupledRun, names: Sequence[str], uncompared: Sequence[str] = ()
) -> Controlled | TwoTolerances:
    """What keeps the tolerance of a run: of the machine in one piece, or of coupled parts."""
    from ..master.one_file_run import OneFileRun  # compiles where it has to

    if isinstance(simulation, OneFileRun):
        return TwoTolerances(simulation, names, uncompared)
    return Controlled(simulation, names, uncompared)


def _run(
    simulation: OneFileRun | CoupledRun, scene: Scene, names: list[str], progress: Progress | None
) -> Result:
    """A scene run as its coupling asks, recording `names`, see `cosimulate`."""
    known = not getattr(simulation, "wiring", None)  # parts of others need not tell velocities
    own, made_of = recorded_for([*names, *(velocities(scene) if known else [])] if names else [])
    start_time = clock.perf_counter()
    controlled: Controlled | TwoTolerances | None = None
    is_linear = scene.rotor.is_linear
    states_friction = names and known and not simulation.coupled and not is_linear
    watched = motion_signals(scene) if states_friction else []
    if simulation.scene.coupling.tolerance is not None and simulation.coupled:
        controlled = controlled_runs(simulation, own, made_of)
        recorder = controlled.run(progress)
    else:
        recorder = Recorder(simulation.units, own, [*made_of, *watched])
        simulation.start()
        simulation.record(recorder, progress)
    seconds = clock.perf_counter() - start_time
    if progress:
        progress(1.0)
    facts = simulation.facts()
    if controlled:
        facts = replace(facts, estimated_error=controlled.error, unknown_error=controlled.unknown)
    if watched:  # runs once more
        own_error = friction_error(cast("CoupledRun", simulation), recorder)
        facts = replace(facts, estimated_error=max(facts.estimated_error, own_error))
    merged = merged_now(simulation.scene, simulation.units) if known else []
    facts = replace(facts, messages=(*facts.messages, *merged))
    found = result(recorder, facts, seconds, names, velocities(scene) if names and known else [])
    counts = controlled.counts_before if isinstance(controlled, TwoTolerances) else {}
    return replace(found, counts_before=counts)


def result(
    recorder: Recorder,
    facts: Facts,
    seconds: float,
    names: Sequence[str],
    speeds: Sequence[str] | None = None,
) -> Result:
    """Signals by these names, and velocities if there are any, with the facts of the run."""
    time, signals = recorder.columns()
    if speeds is None:
        speeds = velocities(facts.scene) if names else []
    units = recorder.signal_units
    return Result(
        scene_title=facts.scene.title,
        time=time,
        signals=with_velocities(facts.scene, names, time, signals),
        velocity=with_velocities(facts.scene, speeds, time, signals),
        seconds=seconds,
        left_out=(
            *left_out(facts.scene, names, coupled=bool(facts.calls)),
            *([] if facts.calls else [NO_CALLS]),
        ),
        units=facts.files,
        events=tuple(events(facts)),
        steps=facts.steps,
        passes=facts.passes,
        calls=dict(facts.calls),
        unconverged=facts.unconverged,
        series_order=facts.series_order,
        collocated_steps=facts.collocated_steps,
        estimated_error=facts.estimated_error,
        unknown_error=facts.unknown_error,
        signal_units={name: units.get(name, "m/s") for name in names},
        scene=facts.scene,
    )
