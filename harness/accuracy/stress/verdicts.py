"""How far the verdict on too coarse steps can be trusted: estimated against real errors.

    python -m autobalancer.harness.accuracy.stress.verdicts

Weights that spin faster than the rotor, on several scenes at several steps, each run to its end
whatever its verdict and compared with the monolith.
"""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import product

from ....models.constants import REFUSED, STATED_ERROR
from ....models.monolith import ReferenceDisagreement
from ...errors import SimulationError
from ...master import facts
from ...master.cosimulation import CoSimulation
from ...master.recorder import Recorder, recorded
from ...output.table import Sheet
from ...scene import Scene, load_scene
from ...scene.balancer import WeightBalancer
from .case import TOO_COARSE, against_reference

SCENES = ("two_balls", "drum", "grinder", "balls_and_liquid", "two_plane_rodrigues", "run_up")
SPINS = (1, 2, 3, 5, 8, 12, 16, 20, 30, 50)  # of the weights, in the rotor's speed
STEPS = (6, 8, 12, 20, 40)  # a revolution
REVOLUTIONS = 3
CLASSES = ((1e-3, "below 0.1 %"), (1e-2, "0.1 to 1 %"), (0.1, "1 to 10 %"), (1.0, "10 to 100 %"))
VERDICTS = ("silent", "said", "refused", "loop did not converge")


@dataclass(frozen=True)
class VerdictSample:
    """One run: its real error (None if it had no end), the one it estimates, and the verdict."""

    scene: str
    spin: float
    steps: int
    error: float | None
    estimate: float
    verdict: str


def spinning(name: str, spin: float, steps: int) -> Scene:
    """A bundled scene whose weights start at `spin` times the rotor's speed, to and fro."""
    scene = load_scene(name)
    speed = scene.profile().end
    changes = {
        f"{b.label}.speeds": [spin * speed * (-1) ** k * (1.0 - 0.1 * k) for k in range(b.count)]
        for b in scene.balancer
        if isinstance(b, WeightBalancer)
    }
    free = dict.fromkeys(f"coupling.{key}" for key in ("scheme", "order", "corrections"))
    given = {"coupling.tolerance": None, "coupling.steps_per_rev": steps}
    return scene.replace({**changes, **free, **given, "run.revolutions": REVOLUTIONS})


def judge(name: str, spin: float, steps: int) -> VerdictSample:
    """Run one of them to its end.

    Raises:
        ReferenceDisagreement: nobody knows what is right.
    """
    scene = spinning(name, spin, steps)
    names = [n for n in recorded(scene) if "angle" not in n and "clearance" not in n]
    with CoSimulation(scene) as cosim:
        recorder = Recorder(cosim.units, names)
        cosim.start()
        watch = cosim.resolution
        assert watch is not None
        watch.strict = False
        try:
            for _ in cosim.rows(recorder):
                pass
        except SimulationError:
            return VerdictSample(name, spin, steps, None, watch.estimate, VERDICTS[3])
        result = facts.result(recorder, cosim.facts(), 0.0)
    error, _ = against_reference(scene, result, rtol=1e-10, bound=1e-2)
    said = any(TOO_COARSE in event for event in result.events)
    verdict = "refused" if watch.refused else "said" if said else "silent"
    return VerdictSample(name, spin, steps, error, watch.estimate, verdict)


def table(rows: Iterable[VerdictSample]) -> str:
    """How many runs of which real error got which verdict, as Markdown."""
    counted = Counter((_class(row.error), row.verdict) for row in rows)
    names = (*(label for _, label in CLASSES), "above 100 %", "no end")
    cells = [[n, *(str(counted[n, verdict] or "-") for verdict in VERDICTS)] for n in names]
    columns = ("real error", *VERDICTS)
    return Sheet(columns, cells, "l" + "r" * len(VERDICTS)).markdown()


def _class(error: float | None) -> str:
    if error is None:
        return "no end"
    return next((label for bound, label in CLASSES if error < bound), "above 100 %")


def main(scenes: Sequence[str]) -> None:
    """Print every run, then the table."""
    rows = []
    for name, spin, steps in product(scenes or SCENES, SPINS, STEPS):
        try:
            rows.append(judge(name, spin, steps))
        except ReferenceDisagreement as error:
            print(f"{name} spin {spin} steps {steps}: {error}", file=sys.stderr)
            continue
        row = rows[-1]
        real = "-" if row.error is None else f"{row.error:.1e}"
        print(f"{name:20} {spin:3} {steps:3} {real:>8} {row.estimate:.1e} {row.verdict}")
    print(f"\nSaid from {STATED_ERROR:g}, refused from {REFUSED:g} of the motion\n\n{table(rows)}")


if __name__ == "__main__":
    main(sys.argv[1:])
