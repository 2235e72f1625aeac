"""Study: do runs in one piece state their error and keep their tolerance?

    python -m tests.studies.one_piece COUNT [FAMILY ...]

Random machines of the truth study, each run with one of four tolerances, against a run of the same
equations whose steps err as little as rounding.  The equations themselves are
compared with those of the reference in `tests/native/test_machine_rates.py`, and the truth study
compares whole runs with its integrations, which takes ten thousand times as long.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from autobalancer.harness import Scene
from autobalancer.harness.errors import SimulationError
from autobalancer.harness.master.compared import largest_difference, motion_signals
from autobalancer.harness.master.one_file_run import OneFileRun
from autobalancer.harness.master.recorder import Recorder, Signal
from autobalancer.harness.master.scales import least_motion
from autobalancer.harness.master.two_tolerances import TwoTolerances
from tests.studies.truth.draw import draw

FAMILIES = (
    *("planar", "run_up", "two_support", "flexible", "liquid", "heavy", "offset", "gravity"),
    *("motor", "unequal", "profile", "changing"),
)
EVENTFUL = ("finite", "impacts", "harsh", "sticking", "friction")
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-6)
SEED = 77
FINEST, NEXT = 1e-13, 3e-12  # tolerances of the reference, and of one that tells what it knows
RESOLVED = 1e-11  # of the motion: what it knows at most
FACTOR = 3.0  # by which an error may exceed its estimate


@dataclass(frozen=True)
class Compared:
    """One machine: tolerance, true error, that of the reference, and the estimate; relative.

    `unknown` says why the error is not known, and is empty where it is.
    """

    tolerance: float
    true: float
    own: float
    estimate: float
    unknown: str = ""

    @property
    def is_chaotic(self) -> bool:
        """Whether neighbouring motions part so far that the reference knows too little."""
        return self.own > 1e-2 * max(1e-2 * self.tolerance, 1e-9)

    @property
    def is_understated(self) -> bool:
        allowed = FACTOR * self.estimate + max(FACTOR * self.own, RESOLVED)
        return self.true > allowed and not self.unknown

    @property
    def is_missed(self) -> bool:
        """Whether the error exceeds the tolerance though the estimate is within it."""
        return self.true > self.tolerance >= self.estimate


def compared(scene: Scene) -> Compared | None:
    """A scene's run and its true error; None where it keeps no tolerance."""
    tolerance = scene.coupling.tolerance
    assert tolerance is not None
    with OneFileRun(scene) as run:
        if not run.coupled:
            return None
        names = motion_signals(scene)
        controlled = TwoTolerances(run, names)
        recorder = controlled.run(None)
        times, signals = recorder.columns()
        units = recorder.signal_units
        exact, near = (_at(run, names, times, each / tolerance) for each in (FINEST, NEXT))
    least = least_motion(scene)
    scale = {name: least.get(unit, 0.0) for name, unit in units.items()}
    true, own = (largest_difference(each, exact, scale) for each in (signals, near))
    return Compared(tolerance, true, own, controlled.error, controlled.unknown)


def _at(run: OneFileRun, names: Sequence[str], times: Signal, share: float) -> Mapping[str, Signal]:
    recorder = Recorder(run.units, names)
    run.start(share, times)
    run.record(recorder, None)
    return recorder.columns()[1]


def drawn(family: str, number: int) -> Scene | None:
    """A scene with weights; None where the draw has none."""
    try:
        scene = Scene.from_document(draw(family, SEED, number))
    except ZeroDivisionError:  # a profile that never turns
        return None
    if not scene.assembly().weights:
        return None
    return scene.replace({"coupling.tolerance": TOLERANCES[number % len(TOLERANCES)]})


def line(family: str, count: int) -> str:
    """What came of the scenes of a family, in one line."""
    found: list[Compared] = []
    refused = others = 0
    for number in range(count):
        scene = drawn(family, number)
        try:
            result = compared(scene) if scene else None
        except SimulationError:
            refused += 1
            continue
        others += scene is not None and result is None
        found += [result] if result else []
    known = [one for one in found if not one.is_chaotic]
    worst = max((one.true / max(one.estimate, RESOLVED) for one in known), default=0.0)
    unknown = sum(bool(one.unknown) for one in known)
    return (
        f"{family:12} {len(known):5} compared, {len(found) - len(known)} chaotic, {others} without "
        f"a tolerance, {refused} refused; {unknown} not known, "
        f"understated {sum(o.is_understated for o in known)}, "
        f"tolerance missed {sum(o.is_missed for o in known)}; worst error over estimate {worst:.2g}"
    )


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    for name in sys.argv[2:] or (*FAMILIES, *EVENTFUL):
        print(line(name, int(sys.argv[1])), flush=True)
