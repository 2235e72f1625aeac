"""What each omission saves in calls and time.

    python -m tests.studies.omissions

Every row is one scene twice: with something that a run usually leaves out, and without it.  Times
are the processor's for a run without loading, both ways taking turns, the smallest of several.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from autobalancer.harness import Scene, load_scene
from autobalancer.harness.master.cosimulation import CoSimulation
from autobalancer.harness.master.recorder import Recorder, recorded
from autobalancer.harness.output.machine import machine
from autobalancer.harness.output.table import Sheet
from autobalancer.harness.result.result import Result

ROUNDS = 7  # of time, both ways in turns


@dataclass(frozen=True)
class Way:
    """One way to run a scene.

    Attributes:
        record: signals; None: what the scene records; "all": every output of every unit.
        draw: whether the run is drawn at the end.
    """

    scene: Callable[[], Scene]
    record: Sequence[str] | str | None = None
    draw: bool = False


@dataclass(frozen=True)
class Omission:
    """What is left out of which scene, with it and without it."""

    what: str
    scene: str
    full: Way
    lean: Way


@dataclass(frozen=True)
class Cost:
    """FMI calls and seconds per step."""

    calls: float
    seconds: float


def _scene(name: str, **changes: object) -> Callable[[], Scene]:
    return lambda: (
        load_scene(name)
        .without()
        .replace({key.replace("__", "."): value for key, value in changes.items()})
    )


def omissions() -> list[Omission]:
    """Everything that runs leave out."""
    disc, balls = _scene("liquid_disc"), _scene("two_balls")
    stiffness = load_scene("liquid_disc").document["rotor"]["stiffness"]
    alike = (stiffness, stiffness * (1.0 + 1e-12))  # equal but for rounding: two real axes
    ramp = {"from": 200.0 * (1.0 - 1e-9), "to": 200.0, "seconds": 10.0}
    force = _scene("liquid_disc", liquid__inertia_as_force=True)
    both = _scene("balls_and_liquid", run__revolutions=20)
    finite = _scene("two_balls", weights__weight_radius=0.01)
    many = _scene("two_balls", coupling__corrections=None, coupling__scheme="iterated")
    once = _scene("two_balls", coupling__corrections=1)
    held = _scene("two_balls", coupling__corrections=1, coupling__order=0)
    explicit = _scene("two_balls", coupling__corrections=None, coupling__scheme="gauss-seidel")
    carried = _scene("two_balls", coupling__corrections=None, coupling__scheme="compensated")
    return [
        Omission("force exchange of a liquid: added mass alone", "liquid_disc",
                 Way(force), Way(disc)),
        Omission("the liquid's unit: no liquid in the scene", "balls_and_liquid",
                 Way(both), Way(lambda: both().without("liquid"))),
        Omission("recording everything: the scene's signals", "liquid_disc",
                 Way(disc, "all"), Way(disc)),
        Omission("recording: `record = []`", "liquid_disc", Way(disc), Way(disc, [])),
        Omission("the second axis: supports alike", "liquid_disc",
                 Way(_scene("liquid_disc", rotor__stiffness=alike)), Way(disc)),
        Omission("variable speed", "liquid_disc",
                 Way(_scene("liquid_disc", operation__run_up=ramp)), Way(disc)),
        Omission("passes until converged: one pass", "two_balls", Way(many), Way(once)),
        Omission("the corrector pass: `gauss-seidel`", "two_balls", Way(once), Way(explicit)),
        Omission("the corrector pass: `compensated`", "two_balls", Way(once), Way(carried)),
        Omission("slopes of the signals: `order = 0`", "two_balls", Way(once), Way(held)),
        Omission("contacts: point weights", "two_balls", Way(finite), Way(balls)),
        Omission("the picture", "two_balls", Way(balls, draw=True), Way(balls)),
    ]  # fmt: skip


class _Prepared:
    """A way with its units loaded."""

    def __init__(self, way: Way) -> None:
        scene = way.scene()
        self.way, self.cosim = way, CoSimulation(scene)
        self.names = list(recorded(scene) if way.record is None else way.record)
        if way.record == "all":
            self.names = [
                f"{unit.name}.{v.name}"
                for unit in self.cosim.units.values()
                for v in unit.variables.values()
                if v.causality == "output"
            ]

    def run(self) -> Cost:
        cosim = self.cosim
        recorder = Recorder(cosim.units, self.names)
        cosim.start()
        before = self._calls()
        begun = clock.process_time()
        cosim.record(recorder, None)
        seconds = clock.process_time() - begun
        calls = self._calls() - before
        if self.way.draw:
            time, signals = recorder.columns()
            units, scene = recorder.signal_units, cosim.scene
            result = Result(scene.title, time, signals, seconds, signal_units=units, scene=scene)
            with TemporaryDirectory() as directory:
                result.plot(Path(directory) / "run.png")
            seconds = clock.process_time() - begun
        return Cost(calls / cosim.steps, seconds / cosim.steps)

    def _calls(self) -> int:
        return sum(sum(unit.calls.values()) for unit in self.cosim.units.values())


def calls(way: Way) -> float:
    """FMI calls a step."""
    prepared = _Prepared(way)
    with prepared.cosim:
        return prepared.run().calls


def measure(omission: Omission) -> tuple[Cost, Cost]:
    """Both ways' costs."""
    ways = [_Prepared(way) for way in (omission.full, omission.lean)]
    best = [Cost(0.0, math.inf)] * 2
    for _ in range(ROUNDS + 1):  # the first warms up
        for k, prepared in enumerate(ways):
            best[k] = min(best[k], prepared.run(), key=lambda cost: cost.seconds)
    for prepared in ways:
        prepared.cosim.close()
    return best[0], best[1]


def row(omission: Omission) -> list[str]:
    """The cells of an omission."""
    full, lean = measure(omission)
    calls = (f"{full.calls:.1f}", f"{lean.calls:.1f}")
    ratio = f"{full.seconds / lean.seconds:.2f}"
    return [omission.what, f"`{omission.scene}`", *calls, ratio]


def main() -> None:
    """Print the table."""
    columns = ("left out", "scene", "FMI calls a step with", "without", "time with/without")
    rows = [row(omission) for omission in omissions()]
    print(f"{Sheet(columns, rows, 'llrrr').markdown()}\n\n{machine()}")


if __name__ == "__main__":
    main()
