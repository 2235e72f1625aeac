"""Where a co-simulation's time goes: inside the FMUs, or in the master."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from .scene import Scene
from .unit import Unit
from .work_precision_methods import Coupled, Method, coupled_scene

FUNCTIONS = ("_get", "_set", "_step", "_save", "_restore", "_free")  # of the library, in `Unit`


@dataclass(frozen=True)
class Split:
    """Time of one run, divided.

    Attributes:
        calls: FMI calls while running.
        rotor, balancers: seconds inside the units, the call itself included.
        total: seconds of the fastest run that was not profiled.
        steps: communication steps.
    """

    method: Method
    calls: int
    rotor: float
    balancers: float
    total: float
    steps: int

    @property
    def master(self) -> float:
        """Seconds outside the units."""
        return max(0.0, self.total - self.rotor - self.balancers)


def split_time(scene: Scene, method: Method, names: Sequence[str], runs: int = 3) -> Split:
    """Run a coupling with every FMI function timed, and without; smallest of several runs each.

    Raises:
        SimulationError: the method cannot run the scene.
    """
    plain = Coupled(coupled_scene(scene, method), names)
    try:
        total = min(plain.run().seconds for _ in range(runs))
    finally:
        plain.close()
    timed = Coupled(coupled_scene(scene, method), names)
    try:
        clocks = {name: _Clock(unit) for name, unit in timed.cosim.units.items()}
        best: dict[str, float] = {}
        for _ in range(runs):
            for watch in clocks.values():
                watch.seconds, watch.calls = 0.0, 0
            done = timed.run()
            for name, watch in clocks.items():
                best[name] = min(best.get(name, watch.seconds), watch.seconds)
        calls = sum(watch.calls for watch in clocks.values())
    finally:
        timed.close()
    rotor = best.pop("rotor")
    return Split(method, calls, rotor, sum(best.values()), total, done.work)


class _Clock:
    """Seconds spent in one unit's functions, and how many calls there were."""

    def __init__(self, unit: Unit) -> None:
        self.seconds, self.calls = 0.0, 0
        for name in FUNCTIONS:
            setattr(unit, name, self._timed(getattr(unit, name)))

    def _timed(self, function: Callable[..., Any]) -> Callable[..., Any]:
        now = clock.perf_counter

        def call(*arguments: Any) -> Any:
            begun = now()
            answer = function(*arguments)
            self.seconds += now() - begun
            self.calls += 1
            return answer

        return call
