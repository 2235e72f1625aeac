"""The measured error of a run: the scene once more, finer, compared on the first run's own points.

The second run takes at least three steps for each of the first's, and keeps a thirtieth of its
tolerance, or of 1e-4 where steps are given: so it sees what given steps do not, such as weights
that heavy drag takes along within a part of the first step.  Where weights can collide steps stay
given, and three for one it is.  The second run meets every communication point of the first:
nothing is interpolated.  What it errs itself is added by the share of the first run's error that is
left in it: error = difference / (1 - share).
"""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...models.arrays import Array
from ..errors import SimulationError
from ..scene import Scene
from .facts import exchanging
from .names import kin
from .parting import parted
from .recorder import REPORTED, Recorder
from .result import Result
from .scales import largest_force
from .schedule import SLIVER, force_jumps, milestones
from .simulation import Simulation
from .velocity import recorded_for, with_velocities
from .verification import Verification

if TYPE_CHECKING:
    from ..output.workers import Progress

FINER = 30.0  # times smaller, the second run's tolerance
PARTS = 3  # of a step: 3^4 = 81 where a tolerance lets steps be as long as may be
FIRST = 1.0 / (1.0 + PARTS)  # share of the first run in the work
USUAL = 1e-4  # tolerance in place of given steps
CLOSED = 0.1  # of its tolerance: a run's loop is closed ten times better
TIGHTEST = 1e-12  # tolerance: below it is rounding
PARTED = 0.1  # of a signal's range: two runs that differ so much have lost each other
NOISE = 1e-12  # of what the scene's forces can move the rotor by


@dataclass(frozen=True)
class Refinement:
    """How the second run is finer.

    Attributes:
        share: of the first run's error that is left in it.
        words: for tables.
        chosen: whether a tolerance chose the steps.
    """

    share: float
    words: str
    chosen: bool


def verified(
    scene: Scene, result: Result, loaded: Callable[[Scene], Simulation], report: Progress
) -> Result:
    """The result of a run, with its errors as a second run measures them.

    Args:
        loaded: what steps a scene.

    Raises:
        SimulationError: the second run cannot be completed.
    """
    start_time, tolerance = clock.perf_counter(), (scene.coupling.tolerance or USUAL) / FINER
    while True:
        fine = controlled(scene, tolerance)
        again, finer = _repeated(loaded(fine), result, report)
        verification = compared(scene, result, again, finer)
        worst = max(verification.relative.values())
        # a first run as exact as the second's loop is closed measures nothing but that loop
        enough = worst >= CLOSED * tolerance or tolerance <= TIGHTEST
        if fine is scene or not finer.chosen or enough:
            break
        tolerance = max(worst / FINER, TIGHTEST)
    verification = replace(verification, seconds=clock.perf_counter() - start_time)
    events = (*result.events, *filter(None, [verification.note()]))
    return replace(result, verification=verification, events=events)


def _repeated(
    fine: Simulation, result: Result, report: Progress
) -> tuple[dict[str, Array], Refinement]:
    """Signals of the second run at the times of the first, and how it was stepped."""
    with fine as cosim:
        recorder = Recorder(cosim.units, *recorded_for(list(result.signals)))
        try:
            cosim.start()
            recorder.record(0.0)
            for number, time in enumerate(_points(cosim, result.time), start=1):
                recorder.record(time)
                if number % REPORTED == 0:
                    report(number / len(result.time))
        except SimulationError as error:
            raise SimulationError(f"verify: the finer repetition of the run: {error}") from error
        found = with_velocities(cosim.scene, list(result.signals), *recorder.columns())
        return found, refinement(cosim)


def controlled(scene: Scene, tolerance: float) -> Scene:
    """The scene with the second run's tolerance; itself where steps stay given."""
    if not exchanging(scene) or (force_jumps(scene) and scene.coupling.tolerance is None):
        return scene
    tighter = {"tolerance": tolerance, "scheme": "auto", "steps_per_rev": None, "corrections": None}
    tighter |= {"order": 3} if scene.coupling.order < 3 else {}
    return scene.replace({f"coupling.{key}": value for key, value in tighter.items()})


def refinement(cosim: Simulation) -> Refinement:
    """How a started co-simulation of the second run is stepped."""
    if cosim.chooses_steps:
        words = f"tolerance = {cosim.scene.coupling.tolerance:.3g}, {PARTS} steps or more for each"
        return Refinement(1.0 / FINER, words, True)
    # a collision's pulse comes at the end of its step: order 1, whatever that of the signals
    return Refinement(1.0 / PARTS, f"{PARTS} steps for each", False)


def _points(cosim: Simulation, times: Array) -> Iterator[float]:
    """Take a started co-simulation from each communication point of the first run to the next."""
    if cosim.chooses_steps:
        for begin, end in pairwise(times.tolist()):
            while end - cosim.time > SLIVER * end:
                cosim.step(end - cosim.time, (end - begin) / PARTS)
            yield end
        return
    # counted: differences of rounded times would each be a step of its own to the units
    for bound in milestones(cosim.scene):
        start, reached = cosim.time, times[times > cosim.time * (1.0 + SLIVER)]
        points = reached[reached <= bound * (1.0 + SLIVER)].tolist()
        for time in points:
            for _ in range(PARTS):
                cosim.step((bound - start) / len(points) / PARTS)
            cosim.time = time
            yield time


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
    angle = scene.profile().angle
    revolutions = np.array([angle(time) for time in result.time]) / (2.0 * math.pi)
    lost = {name: apart[name] >= PARTED * scales[name] for name in apart if error[name] > 0.0}
    first = min(lost, key=lambda name: _first(lost[name]), default=None)
    parting = None
    if first is not None and lost[first].any():
        size = np.max([np.abs(again[name]) for name in kin(first, again)], axis=0)
        parting = parted(revolutions, apart[first], size, _first(lost[first]))
    return Verification(finer.words, error, relative, parting)


def _rounding(scene: Scene) -> dict[str, float]:
    """By unit, motion of the rotor that is nothing but rounding, such as a balanced rotor's."""
    profile, mass = scene.profile(), float(scene.assembly().loaded_rotor.mass.sum())
    length = NOISE * largest_force(scene) / (mass * profile.top**2)
    return {"m": length, "m/s": length * profile.top}


def _first(true: NDArray[np.bool_]) -> int:
    """Index of the first true value, or behind the last."""
    return int(np.argmax(true)) if true.any() else len(true)


def _over(error: float, scale: float) -> float:
    if error == 0.0:
        return 0.0
    return error / scale if scale > 0.0 else math.inf
