"""A scene run from its start to its end, as its coupling asks."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import UserError
from ..scene import Scene, load_scene
from .cosimulation import CoSimulation, Simulation
from .facts import result
from .global_error import Controlled
from .merged import merged_now
from .plan import plan
from .recorder import Recorder, recorded, refuse_unknown
from .result import Result
from .schedule import order_of_run
from .verify import FIRST, verified

if TYPE_CHECKING:
    from ..output.workers import Progress


def cosimulate(
    scene: Scene | str | Path,
    *,
    record: Iterable[str] | None = None,
    fmus: Path | None = None,
    progress: Progress | None = None,
    verify: bool = False,
    one_file: bool = False,
) -> Result:
    """Run a scene and return what it recorded.

    Args:
        scene: a scene, the path of a scene file, or the name of a bundled scene.
        record: signals such as `rotor.x`; by default the scene's, an empty list records nothing.
        fmus: directory of ready-made FMUs instead of building them.
        progress: called with the finished fraction now and then.
        verify: run once more, finer, and measure the error of every signal (`Result.error`).
        one_file: couple the units in C as the scene's one file does, instead of as separate FMUs:
            the same steps and results many times faster, and threads run side by side.

    Raises:
        UserError: the scene or an FMU is wrong, or one file does not cover the scene.
        SimulationError: the run cannot be completed correctly.
    """
    if not isinstance(scene, Scene):
        scene = load_scene(scene)
    names = list(recorded(scene) if record is None else record)
    loaded = _loader(fmus, one_file)
    if not verify:
        return run_once(scene, names, loaded, progress)
    if not names:
        raise UserError("verify: nothing is recorded, so there is nothing to compare")
    told = progress or (lambda _done: None)
    found = run_once(scene, names, loaded, lambda done: told(FIRST * done))
    return verified(scene, found, loaded, lambda done: told(FIRST + (1.0 - FIRST) * done))


def _loader(fmus: Path | None, one_file: bool) -> Callable[[Scene], Simulation]:
    """What steps a scene: separate units, or its one file."""
    if not one_file:  # FMUs that were built have the order their scene says
        return lambda scene: CoSimulation(
            scene, fmus=fmus, order=None if fmus else order_of_run(scene)
        )
    if fmus is not None:
        raise UserError(f"{fmus}: holds separate FMUs, and one file is to run: give one of them")
    from .one_file_run import OneFileRun  # compiles where it has to

    return lambda scene: OneFileRun(scene, order_of_run(scene))


def run_once(
    scene: Scene,
    names: list[str],
    loaded: Callable[[Scene], Simulation],
    progress: Progress | None,
) -> Result:
    """A scene run as its coupling asks, recording `names`, see `cosimulate`."""
    refuse_unknown(names, plan(scene).variables_by_unit())
    with loaded(scene) as cosim:
        begun, controlled = clock.perf_counter(), None
        if cosim.scene.coupling.tolerance is not None and cosim.coupled:
            controlled = Controlled(cosim, names)
            recorder = controlled.run(progress)
        else:
            recorder = Recorder(cosim.units, names)
            cosim.start()
            cosim.record(recorder, progress)
        seconds = clock.perf_counter() - begun
        if progress:
            progress(1.0)
        facts = cosim.facts()
        if controlled:
            facts = replace(facts, estimated_error=controlled.error)
        messages = (*facts.messages, *merged_now(cosim.scene, cosim.units))
        facts = replace(facts, messages=messages)
        return result(recorder, facts, seconds)
