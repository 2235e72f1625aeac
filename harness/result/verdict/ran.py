"""What verdicts read of a run, and runs of their own: a look ahead, the rotor without balancers."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

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


def run_again(
    scene: Scene, names: Sequence[str], ends: Callable[[Ran, Ran], bool] | None = None
) -> Ran | None:
    """A run of another scene in C that records `names`; None where it cannot be completed.

    Args:
        ends: whether two runs, whose steps err by a hundredth in the second, are enough, though
            they differ by more than the tolerance; default: they never are.
    """
    from ...master.one_file_run import OneFileRun  # compiles where it has to

    own, _ = recorded_for(names)
    try:
        with warnings.catch_warnings(), OneFileRun(scene) as simulation:
            warnings.simplefilter("ignore")

            @lru_cache(maxsize=2)
            def ran(recorder: Recorder) -> Ran:
                time, signals = recorder.columns()
                events = merged_now(simulation.scene, simulation.units)
                return Ran(scene, time, signals, events=events, passes=simulation.facts().passes)

            def enough(first: Recorder, second: Recorder) -> bool:
                return ends is not None and ends(ran(first), ran(second))

            if simulation.scene.coupling.tolerance is not None and simulation.coupled:
                return ran(TwoTolerances(simulation, own).run(None, enough))
            recorder = Recorder(simulation.units, own)
            simulation.start()
            simulation.record(recorder, None)
            return ran(recorder)
    except (UserError, SimulationError):
        return None
