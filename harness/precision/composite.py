"""The scene's composite as a method: its coupling in C, called once for a whole run."""

from __future__ import annotations

import time as clock
from collections.abc import Sequence

import numpy as np

from ...fmus.composite.batch import Runs
from ..errors import SimulationError
from ..master.one_file import composition
from ..master.schedule import end_time, step_size
from ..scene import Scene
from .runner import Run

POINTS_PER_REV = 10  # at which signals are read, where a tolerance chooses the steps
REPEATS = 10  # in one call: making the units once is loading, and a run takes less than a ms


class CompositeRunner:
    """The composite of a scene, run by the library itself.

    Raises:
        SceneError: the scene is coupled in a way that a composite does not have.
    """

    def __init__(self, scene: Scene, names: Sequence[str]) -> None:
        self._names, end = list(names), end_time(scene)
        fixed = scene.coupling.tolerance is None
        points = round(end / step_size(scene, None if fixed else POINTS_PER_REV))
        self._runs = Runs(composition(scene), [], [*names, "coupling.steps"], points)
        self._time = end * (np.arange(points + 1) / points)
        self._end = np.full(REPEATS, end)

    def run(self) -> Run:
        begun = clock.process_time()
        found, (reason, *_) = self._runs(np.empty((REPEATS, 0)), self._end)
        seconds = (clock.process_time() - begun) / REPEATS
        if reason:
            raise SimulationError(reason)
        *signals, steps = found[0].T
        return Run(
            seconds, self._time, dict(zip(self._names, signals, strict=True)), int(steps[-1])
        )

    def close(self) -> None:
        pass
