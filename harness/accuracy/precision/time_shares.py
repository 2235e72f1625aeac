"""Where a co-simulation's time goes: inside the FMUs, or in the master."""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from ...master.fmu import Fmu
from ...scene import Scene
from .methods import CoSimulationRunner, Method, coupled_scene

FUNCTIONS = ("_get", "_set", "_step", "_save", "_restore", "_free")  # of the library, in `Fmu`


@dataclass(frozen=True)
class Split:
    """Time of one run, divided.

    Attributes:
        calls: FMI calls while running.
        rotor, balancers: seconds inside the units, the call itself included.
        total: seconds of the run, less what the timing itself cost.
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
    """Run a coupling with every FMI function timed; the fastest of several runs.

    Raises:
        SimulationError: the method cannot run the scene.
    """
    coupled = CoSimulationRunner(coupled_scene(scene, method), names)
    try:
        clocks = {name: _Clock(unit) for name, unit in coupled.cosim.units.items()}
        own = _cost_of_timing()
        splits = []
        for _ in range(runs):
            for watch in clocks.values():
                watch.seconds, watch.calls = 0.0, 0
            done = coupled.run()
            calls = sum(watch.calls for watch in clocks.values())
            seconds = {name: watch.seconds for name, watch in clocks.items()}
            rotor = seconds.pop("rotor")
            total = done.seconds - calls * own
            splits.append(Split(method, calls, rotor, sum(seconds.values()), total, done.work))
    finally:
        coupled.close()
    return min(splits, key=lambda split: split.total)


def _cost_of_timing() -> float:
    """Seconds that timing adds to a call, most of which fall outside what it measures."""
    watch, count = _Clock(), 20_000
    plain, timed = len, watch.timed(len)
    begun = clock.process_time()
    for _ in range(count):
        plain("")
    between = clock.process_time()
    for _ in range(count):
        timed("")
    ended = clock.process_time()
    return max(0.0, ended - between - (between - begun)) / count


class _Clock:
    """Seconds spent in one unit's functions, and how many calls there were."""

    def __init__(self, unit: Fmu | None = None) -> None:
        self.seconds, self.calls = 0.0, 0
        if unit is not None:
            for name in FUNCTIONS:
                setattr(unit, name, self.timed(getattr(unit, name)))

    def timed(self, function: Callable[..., Any]) -> Callable[..., Any]:
        """The function, timed."""
        now = clock.process_time

        def call(*arguments: Any) -> Any:
            begun = now()
            answer = function(*arguments)
            self.seconds += now() - begun
            self.calls += 1
            return answer

        return call
