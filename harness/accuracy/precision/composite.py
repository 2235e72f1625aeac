"""The scene's composite as a method: its coupling in C, called once for a whole run.

Its signals are read where its steps end, as those of the other couplings and of SciPy are.
"""

from __future__ import annotations

import time as clock
from collections.abc import Sequence

import numpy as np

from ....fmus.composite.batch import BatchRuns
from ...errors import SimulationError
from ...master.one_file import composition
from ...master.schedule import end_time
from ...scene import Scene
from .runner import TimedRun

MORE = 16  # points than steps: of those at the start and at jumps
REPEATS = 10  # in one call: making the units once is loading, and a run takes less than a ms


class CompositeRunner:
    """The composite of a scene, run by the library itself.

    Raises:
        SceneError: the scene is coupled in a way that a composite does not have.
    """

    def __init__(self, scene: Scene, names: Sequence[str]) -> None:
        self._names, self._end = list(names), np.full(REPEATS, end_time(scene))
        made, asked = composition(scene), [*names, "coupling.steps"]
        records, (reason, _) = BatchRuns(made, [], ["coupling.steps"], 1)(
            np.empty((2, 0)), self._end[:2]
        )
        if reason:
            raise SimulationError(reason)
        self._runs = BatchRuns(made, [], asked, int(records[0, -1, 0]) + MORE, own_steps=True)

    def run(self) -> TimedRun:
        begun = clock.process_time()
        records, (reason, *_) = self._runs(np.empty((REPEATS, 0)), self._end)
        seconds = (clock.process_time() - begun) / REPEATS
        if reason:
            raise SimulationError(reason)
        time, *signals, steps = records[0, ~np.isnan(records[0, :, 0])].T
        return TimedRun(seconds, time, dict(zip(self._names, signals, strict=True)), int(steps[-1]))

    def close(self) -> None:
        pass
