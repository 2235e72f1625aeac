"""Study: machines as they are built, of every kind, against integrations and against each other.

    python -m tests.studies.built COUNT [FAMILY ...] [--from K] [--floquet N] [--proved N]

Random machines of the truth study with balls on them.  A run of the default settings is compared
with SciPy's fastest integration of the equations in one piece; runs are cut so that the fastest
rate turns by `LONGEST` at most, and an unstable rotor grows by e^`MOST_GROWTH`.  A run that seems
to err beyond its estimate is judged by a finer integration with another method: at `RTOL` the first
one can err more.  Of the first N that can balance, the growth about balance is compared with
that by derivatives of the same equations over one period (`one_period`), and its sign with what is
proved.
"""

from __future__ import annotations

import itertools
import math
import sys
import time as clock
import warnings
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from autobalancer.harness import Scene
from autobalancer.harness.errors import SimulationError, UserError
from autobalancer.harness.result.result import Result
from autobalancer.harness.result.run import cosimulate
from autobalancer.harness.scene.begin import motion_at_start
from autobalancer.models.linear.balanced import CannotBalance
from autobalancer.models.monolith import equations, simulate
from autobalancer.models.stability import find_growth
from tests.studies.one_period import growth_over_a_period
from tests.studies.truth.draw import draw
from tests.studies.truth.judge import RESOLVED, deviations

FAMILIES = ("tilting", "bearings", "bodies", "rubber", "tables", "one_way")
SEED = 46
LONGEST = 250.0  # rad or 1/s s: of the fastest rate over a run
# e-foldings of the rotor alone over a run: pendulums that are accelerated without end turn ever
# faster, in ever more steps, and the sizes are none of a machine
MOST_GROWTH = 12.0
RTOL = 1e-10
FINER = {"method": "DOP853", "rtol": 1e-12}
FACTOR = 3.0  # by which an error may exceed its estimate
RIGHT = 0.01
COLLOCATION = 4e-7  # of growth per revolution: its error where its sign is clear and none is stated
TRIED = 30  # machines for each one that is to be judged: few of them can balance


@dataclass(frozen=True)
class Outcome:
    """One machine: error of the run over its size, and its estimate; or why there is none."""

    name: str
    error: float = math.nan
    estimate: float = math.nan
    why: str = ""
    seconds: float = 0.0

    @property
    def word(self) -> str:
        """What it counts as."""
        if self.why:
            return self.why.partition(":")[0]
        if self.error <= FACTOR * self.estimate + RESOLVED:
            return "within"
        return "silent" if self.error > RIGHT else "beyond"


def scene_of(family: str, number: int) -> Scene:
    """A random machine, whose run is cut."""
    scene = Scene.from_document(draw(family, SEED, number))
    drive = scene.operation.drive()
    fastest = equations(scene.assembly(), drive).fastest_mode
    profile = scene.profile()
    seconds = profile.time_of(scene.revolutions * math.tau)
    most = min(LONGEST / fastest, MOST_GROWTH / max(growth_of_rotor(scene), 1e-300))
    if not seconds > most:
        return scene
    return scene.replace({"run.duration": most, "run.revolutions": None})


def growth_of_rotor(scene: Scene) -> float:
    """Largest growth rate [1/s] of the rotor with its weights at rest in it, at its last speed."""
    speed = scene.profile().end
    rotor = scene.assembly().at_speed(speed).loaded_rotor
    mass, damping, stiffness = rotor.real_coefficients(speed)
    size = len(mass)
    lower = -np.linalg.solve(mass, np.hstack([stiffness, damping]))
    upper = np.hstack([np.zeros((size, size)), np.eye(size)])
    return float(np.linalg.eigvals(np.vstack([upper, lower])).real.max())


def compare(family: str, number: int) -> Outcome:
    """A run and the integration of its equations."""
    name, begun = f"{family} {number}", clock.process_time()
    try:
        scene = scene_of(family, number)
        run = cosimulate(scene)
    except (SimulationError, UserError) as refusal:
        return Outcome(name, why=f"refused: {str(refusal)[:90]}")
    for method in ({"method": "odeint", "rtol": RTOL}, FINER):
        try:
            error = largest_deviation(scene, run, method)
        except ArithmeticError as failed:
            return Outcome(name, why=f"no reference: {failed}")
        found = Outcome(name, error, run.estimated_error, "", clock.process_time() - begun)
        if found.word == "within":
            break
    return found


def largest_deviation(scene: Scene, run: Result, method: Mapping[str, Any]) -> float:
    """Largest difference of a run's signals from an integration of the equations."""
    right = simulate(
        scene.assembly(), scene.operation.drive(), run.time, initial=motion_at_start(scene),
        **method,
    )  # fmt: skip
    names = [n for n in run.signals if not n.endswith((".angle", ".clearance"))]
    return max(deviations(run, {n: right.signal(n) for n in names}).values())


def growth_word(family: str, number: int) -> str:
    """Whether Floquet's growth is that of the derivatives; empty where no weights can balance."""
    try:
        scene = scene_of(family, number)
        if not scene.assembly().weights:
            return ""
        speed = scene.profile().end
        found = find_growth(scene.assembly(), speed)
    except CannotBalance:
        return ""
    except (ValueError, ArithmeticError) as error:
        return f"no growth: {family} {number}: {str(error)[:80]}"
    try:
        expected, error = growth_over_a_period(scene.assembly(), speed)
    except ArithmeticError as failed:
        return f"no derivatives: {family} {number}: {failed}"
    stated = found.error or COLLOCATION * speed / math.tau
    alike = abs(found.rate - expected) <= error + stated
    return "alike" if alike else f"DIFFERS: {family} {number}: {found.rate:g}, {expected:g}"


def proof_word(family: str, number: int) -> str:
    """Whether what is proved about the speed is the sign of Floquet's growth; as `growth_word`."""
    try:
        scene = scene_of(family, number)
        speed = scene.profile().end
        growth = find_growth(scene.assembly(), speed)
    except CannotBalance:
        return ""
    except (ValueError, ArithmeticError) as error:
        return f"no growth: {family} {number}: {str(error)[:80]}"
    from autobalancer import Scene as Called

    least, most = scene.assembly().rotor.table_speeds
    low, high = max(0.9999 * speed, least), min(1.0001 * speed, most)
    found = Called.from_document(scene.document).speeds(low, high, "proved", narrowest=1e-4 * speed)
    if found.proof is None:
        return f"refused by name: {found.refused['proved'][:60]}"
    for band in found.proof.bands:
        if band.low <= speed <= band.high and band.state != "undecided":
            alike = growth.is_neutral or band.state == growth.state
            return "alike" if alike else f"DIFFERS: {family} {number}: {band.state}"
    return f"undecided at a growth of {growth.rate / speed:.0e} of the speed"


def first_words(judge: Callable[[str, int], str], family: str, count: int) -> Counter[str]:
    """What a judge says of the first `count` machines that can balance."""
    said = filter(None, (judge(family, k) for k in range(TRIED * count)))
    return Counter(itertools.islice(said, count))


def main(arguments: Sequence[str]) -> None:
    """Print what came of each family."""
    warnings.simplefilter("ignore")
    extra = {"--from": 0, "--floquet": 0, "--proved": 0}
    left = list(arguments)
    for key in extra:
        if key in left:
            at = left.index(key)
            extra[key] = int(left[at + 1])
            del left[at : at + 2]
    count, families = int(left[0]), left[1:] or FAMILIES
    for family in families:
        found = []
        for k in range(extra["--from"], extra["--from"] + count):
            found.append(compare(family, k))
            if found[-1].word != "within":
                one = found[-1]
                why = one.why or one.word
                print(f"  {one.name}: {why} {one.error:.2g} {one.estimate:.2g}", flush=True)
        known = [one for one in found if not one.why]
        words = Counter(one.word for one in found)
        worst = max((one.error for one in known), default=math.nan)
        seconds = sum(one.seconds for one in found)
        print(f"{family}: {dict(words)}; largest error {worst:.2g}; {seconds:.0f} s", flush=True)
        for name, judge in (("--floquet", growth_word), ("--proved", proof_word)):
            if extra[name]:
                said = first_words(judge, family, extra[name])
                print(f"  {name[2:]}: {dict(said)}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
