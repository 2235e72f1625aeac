"""The measured error of a run: the scene once more, finer, compared on the first run's own points.

With a tolerance the second run takes a thirtieth of it, and at least three steps for each of the
first run's; with given steps it takes as many more as make errors of the scheme's order thirty
times smaller.  It meets every communication point of the first run, so nothing is interpolated.
What the second run errs itself is added by the order it should have (Richardson): error =
difference / (1 - share), with the share of the first run's error that is left in the second.
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import SimulationError, UserError
from ..scene import Scene
from .cosimulation import REPORTED, SLIVER, CoSimulation, run_once
from .names import kin
from .parting import Parting, Statistics, parted
from .recorder import Recorder
from .result import Result
from .scales import largest_force
from .schedule import milestones, schedule, steps_per_rev
from .schemes.gauss_seidel import GaussSeidel
from .schemes.jacobi import Jacobi

FINER = 30.0  # times smaller, the error of the second run
FEWEST_PARTS = 3  # of a step chosen by a tolerance: 3^4 = 81 where steps are as long as may be
PARTED = 0.1  # of a signal's range: two runs that differ so much have lost each other
EXTRAPOLATED = (Jacobi.name, GaussSeidel.name)  # a force met by its prediction loses an order
NOISE = 1e-12  # of what the scene's forces can move the rotor by
Array = NDArray[np.float64]
Report = Callable[[float], None]


@dataclass(frozen=True)
class Refinement:
    """How the second run is finer.

    Attributes:
        parts: least number of its steps for each of the first run's.
        share: of the first run's error that is left in it.
        words: for tables.
    """

    parts: int
    share: float
    words: str


@dataclass(frozen=True)
class Verification:
    """What a second, finer run says of the first.

    Attributes:
        finer: how the second run was stepped, in words.
        error: by signal, largest error at a communication point, in the signal's unit.
        relative: the same over the signal's range; x and y, or the parts of a vector in the rotor,
            share the larger of their ranges.  A rotor that stands still but for rounding is
            measured by 1e-12 of what the scene's forces can move it.
        statistics: by signal, of the first and of the second run.
        parting: None where the runs stay together, and `error` is what the first one errs.
        seconds: the second run took.
    """

    finer: str
    error: dict[str, float]
    relative: dict[str, float]
    statistics: dict[str, tuple[Statistics, Statistics]] = field(default_factory=dict)
    parting: Parting | None = None
    seconds: float = 0.0

    def note(self) -> str:
        """What a reader must know; empty where the errors say all."""
        if self.parting is None:
            return ""
        return (
            "verify: the motion parts from its neighbours "
            f"{math.exp(self.parting.rate):.2g}-fold a revolution (rate {self.parting.rate:.2g}): "
            f"from revolution {self.parting.revolution:.3g} on values at a time are not known, "
            "only their statistics"
        )


def verified(
    scene: Scene, names: list[str], fmus: Path | None = None, progress: Report | None = None
) -> Result:
    """Run a scene, recording `names`, and once more to measure the errors.

    Raises:
        UserError: nothing is recorded, or see `cosimulate`.
        SimulationError: one of the two runs cannot be completed.
    """
    if not names:
        raise UserError("verify: nothing is recorded, so there is nothing to compare")
    part = 1.0 / (1.0 + FEWEST_PARTS)  # of the work
    result = run_once(scene, names, fmus, progress and (lambda done: progress(part * done)))
    begun, tolerance, fine = clock.perf_counter(), scene.coupling.tolerance, scene
    if tolerance is not None:
        fine = scene.replace({"coupling.tolerance": tolerance / FINER})
    with CoSimulation(fine, fmus=fmus) as cosim:
        recorder = Recorder(cosim.units, names)
        try:
            cosim.start()
            recorder.take(0.0)
            finer = refinement(cosim)
            for number, time in enumerate(_points(cosim, result.time, finer.parts), start=1):
                recorder.take(time)
                if progress and number % REPORTED == 0:
                    progress(part + (1.0 - part) * number / len(result.time))
        except SimulationError as error:
            raise SimulationError(f"verify: the finer repetition of the run: {error}") from error
    found = compared(scene, result, recorder.columns()[1], finer)
    found = replace(found, seconds=clock.perf_counter() - begun)
    events = (*result.events, *filter(None, [found.note()]))
    return replace(result, verification=found, events=events)


def refinement(cosim: CoSimulation) -> Refinement:
    """How a started co-simulation is stepped for errors `FINER` times smaller than the first's."""
    coupling = cosim.scene.coupling
    if cosim.scheme.chooses_steps:
        words = f"tolerance = {coupling.tolerance:.3g}, {FEWEST_PARTS} steps or more for each"
        return Refinement(FEWEST_PARTS, 1.0 / FINER, words)
    extrapolated = cosim.scheme.name in EXTRAPOLATED
    order = {0: 1, 1: 2, 3: 3 if extrapolated else 4}[coupling.order]
    parts = math.ceil(FINER ** (1.0 / order))
    # a collision's pulse comes at the end of its step, whatever the order of the signals
    touching = any(balancer.can_touch for balancer in cosim.scene.balancer)
    share = parts ** -(1.0 if touching else order)
    return Refinement(parts, share, f"{parts * steps_per_rev(cosim.scene)} steps a revolution")


def _points(cosim: CoSimulation, times: Array, parts: int) -> Iterator[float]:
    """Take a started co-simulation from each communication point of the first run to the next."""
    if cosim.scheme.chooses_steps:
        for begin, end in pairwise(times.tolist()):
            while end - cosim.time > SLIVER * end:
                cosim.step(end - cosim.time, (end - begin) / parts)
            yield end
        return
    # from the schedule: differences of rounded times would each be a step of its own to the units
    for (step, count), bound in zip(schedule(cosim.scene), milestones(cosim.scene), strict=True):
        start = cosim.time
        for number in range(1, count + 1):
            for _ in range(parts):
                cosim.step(step / parts)
            cosim.time = start + number * step if number < count else bound
            yield cosim.time


def compared(
    scene: Scene, result: Result, again: Mapping[str, Array], finer: Refinement
) -> Verification:
    """Errors of a result whose signals a finer run gives once more, (T,) each by name."""
    largest = 1.0 / (1.0 - finer.share)
    apart = {name: np.abs(again[name] - values) for name, values in result.signals.items()}
    still = _rounding(scene)
    ranges = {
        name: max(float(np.ptp(values)), still.get(result.signal_units.get(name, ""), 0.0))
        for name, values in again.items()
    }
    scales = {name: max(ranges[other] for other in kin(name, ranges)) for name in ranges}
    error = {name: largest * float(gap.max()) for name, gap in apart.items()}
    relative = {name: _over(error[name], scales[name]) for name in error}
    statistics = {
        name: (Statistics.of(result.time, values), Statistics.of(result.time, again[name]))
        for name, values in result.signals.items()
    }
    angle = scene.profile().angle
    revolutions = np.array([angle(time) for time in result.time]) / (2.0 * math.pi)
    lost = {name: apart[name] >= PARTED * scales[name] for name in apart if error[name] > 0.0}
    first = min(lost, key=lambda name: _first(lost[name]), default=None)
    parting = None
    if first is not None and lost[first].any():
        size = np.max([np.abs(again[name]) for name in kin(first, again)], axis=0)
        parting = parted(revolutions, apart[first], size, _first(lost[first]))
    return Verification(finer.words, error, relative, statistics, parting)


def _rounding(scene: Scene) -> dict[str, float]:
    """By unit, motion of the rotor that is nothing but rounding, such as a balanced rotor's."""
    profile, mass = scene.profile(), float(scene.assembly().loaded_rotor.mass.sum())
    length = NOISE * largest_force(scene) / (mass * max(profile.start, profile.end) ** 2)
    return {"m": length, "m/s": length * max(profile.start, profile.end)}


def _first(true: NDArray[np.bool_]) -> int:
    """Index of the first true value, or behind the last."""
    return int(np.argmax(true)) if true.any() else len(true)


def _over(error: float, scale: float) -> float:
    if error == 0.0:
        return 0.0
    return error / scale if scale > 0.0 else math.inf
