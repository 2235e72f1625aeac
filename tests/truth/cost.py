"""What a run costs that asks for nothing, against given steps and an integration in one piece."""

from __future__ import annotations

import math
import statistics
import time as clock
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from autobalancer.harness.errors import SimulationError, UserError
from autobalancer.harness.master.global_error import Controlled
from autobalancer.harness.master.recorder import Recorder, recorded
from autobalancer.harness.master.run import load
from autobalancer.harness.master.schedule import at_fixed_steps, end_time
from autobalancer.harness.output.table import Sheet
from autobalancer.harness.scene import Scene
from autobalancer.models.monolith import simulate
from tests.truth.draw import draw

RTOL = 1e-6  # of the integration in one piece
REPEATED = 3  # the shortest counts


@dataclass(frozen=True)
class Costs:
    """Processor time of one scene's runs [s], without loading units; NaN where one is refused.

    Attributes:
        family: of the scene.
        units, one_file: by the tolerance of a scene that asks for nothing.
        units_given, one_file_given: at the default number of given steps.
        one_piece: LSODA.
    """

    family: str
    units: float
    units_given: float
    one_file: float
    one_file_given: float
    one_piece: float


def costs(counts: dict[str, int], seed: int) -> Iterator[Costs]:
    """Of the drawn scenes in which force is exchanged, and weights do not collide."""
    for family, count in counts.items():
        for number in range(count):
            scene = Scene.from_document(draw(family, seed, number))
            if any(b.exchanges_force for b in scene.balancer) and family not in (
                "finite",
                "impacts",
            ):
                yield _costs(family, scene)


def _costs(family: str, scene: Scene) -> Costs:
    given, start = at_fixed_steps(scene), scene.run.initial.motion()
    drive = scene.operation.drive()
    points = np.linspace(0.0, end_time(scene), math.ceil(40 * scene.run.revolutions) + 1)

    def one_piece() -> None:
        simulate(scene.assembly(), drive, points, initial=start, method="LSODA", rtol=RTOL)

    return Costs(
        family,
        _run(scene, separate=True),
        _run(given, separate=True),
        _run(scene),
        _run(given),
        _shortest(one_piece),
    )


def _run(scene: Scene, separate: bool = False) -> float:
    names = list(recorded(scene))
    with load(scene, separate=separate) as cosim:

        def run() -> None:
            if scene.coupling.tolerance is not None:
                Controlled(cosim, names).run(None)
            else:
                cosim.start()
                cosim.record(Recorder(cosim.units, names), None)

        return _shortest(run)


def _shortest(run: Callable[[], object]) -> float:
    times = []
    for _ in range(REPEATED):
        begun = clock.process_time()
        try:
            run()
        except (SimulationError, UserError, ArithmeticError):
            return math.nan
        times.append(clock.process_time() - begun)
    return min(times)


def _median(ratios: Iterable[float]) -> float:
    """Of those that are known; NaN where none is."""
    known = [ratio for ratio in ratios if not math.isnan(ratio)]
    return statistics.median(known) if known else math.nan


def cost_table(found: Sequence[Costs]) -> Sheet:
    """Medians of the ratios of run times by family."""
    ratios = {
        "units: over given steps": ("units", "units_given"),
        "over LSODA": ("units", "one_piece"),
        "one file: over given steps": ("one_file", "one_file_given"),
        "over given steps of units": ("one_file", "units_given"),
        "one file over LSODA": ("one_file", "one_piece"),
    }
    rows = []
    for name in [*dict.fromkeys(one.family for one in found), "all"]:
        mine = [one for one in found if name in (one.family, "all")]
        medians = [
            _median(getattr(one, over) / getattr(one, under) for one in mine)
            for over, under in ratios.values()
        ]
        rows.append([name, str(len(mine)), *(f"{value:.2g}" for value in medians)])
    return Sheet(["family", "scenes", *ratios], rows, "l" + "r" * (len(ratios) + 1))
