"""What verdicts read of a run, and runs of their own: a look ahead, the rotor without balancers."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ....models.arrays import Array
from ...errors import SimulationError, UserError
from ...master.merged import merged_now
from ...master.recorder import Recorder
from ...master.two_tolerances import TwoTolerances
from ...scene import Scene
from ..velocity import recorded_for


@dataclass(frozen=True, eq=False)
class Ran:
    """A finished run.

    Attributes:
        scene: that was run.
        time: (T,) [s].
        signals: (T,) each, by name, in SI units.
        velocity: (T,) each, vibration velocities of the last revolution, where they are known.
        events: what a reader must know.
        passes: steps including corrector passes and rejected ones.
        separate: whether separate FMUs were coupled, which may be another machine than the scene's.
    """

    scene: Scene
    time: Array
    signals: Mapping[str, Array]
    velocity: Mapping[str, Array] = field(default_factory=dict)
    events: Sequence[str] = ()
    passes: int = 0
    separate: bool = False


def run_again(scene: Scene, names: Sequence[str]) -> Ran | None:
    """A run of another scene in C that records `names`; None where it cannot be completed."""
    from ...master.one_file_run import OneFileRun  # compiles where it has to

    own, _ = recorded_for(names)
    try:
        with warnings.catch_warnings(), OneFileRun(scene) as simulation:
            warnings.simplefilter("ignore")
            if simulation.scene.coupling.tolerance is not None and simulation.coupled:
                recorder = TwoTolerances(simulation, own).run(None)
            else:
                recorder = Recorder(simulation.units, own)
                simulation.start()
                simulation.record(recorder, None)
            time, signals = recorder.columns()
            events = merged_now(simulation.scene, simulation.units)
            passes = simulation.facts().passes
    except (UserError, SimulationError):
        return None
    return Ran(scene, time, signals, events=events, passes=passes)
