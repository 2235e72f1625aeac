"""Decay of co-simulated runs against Goncharov's slow root (1) and the exact spectrum."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ..design.decay import Decay
from ..design.recommendation import deviations, excluded
from ..design.scenes import batches, sized
from ..scene import Scene
from .goncharov import facing_start, settled_runs, weights_with_slow_root
from .row import Row, Rows

DECAY = 0.05  # of the rate: (1) takes the rotor as fast, and other motions are still in the fit
SOURCE = "Goncharov 2017 (1)"
MOST = 8  # weights
WIDTH = {"balls": 0.25, "rollers": 0.1}  # m: room for the balls of Table 1; height of the rollers
UNBALANCE = {"balls": 0.046, "rollers": 0.142}  # kg m
REVOLUTIONS = 1000  # the slowest motions are the ones wanted
TOLERANCE = 1e-6  # of the runs: what has decayed is fitted down to a thousandth


def check_slow_root(
    scene: Scene, most: int = MOST, starts: int = 20, revolutions: float = REVOLUTIONS
) -> Iterator[Row]:
    """Fitted rates of runs from two groups face to face, where p is large and (1) decides."""
    rows, kind = Rows(scene.name, "slow_root"), weights_with_slow_root(scene).kind
    amount, scene = (
        UNBALANCE[kind],
        scene.replace({"run.revolutions": revolutions, "coupling.tolerance": TOLERANCE}),
    )
    scenes = sized(scene, range(2, most + 1), amount, width=WIDTH[kind])
    work = [b for s in scenes.values() for b in batches(s, amount, starts, facing_start)]
    found = [run.decay for run in settled_runs(work) if run.decay]
    yield from decay_rows(found, rows)


def decay_rows(found: Sequence[Decay], rows: Rows) -> Iterator[Row]:
    """How many runs have a dominant slow root, and how far their rates are off."""
    chosen = [one for one in found if one.dominant]
    touching = sum(one.touching for one in chosen)
    shown = f"{len(chosen)} of {len(found)}, {touching} with weights that touch"
    if reasons := excluded(found):
        shown += f"; others: {reasons}"
    source = "spectrum where the run ended; see harness/manual/results/goncharov.md"
    yield rows.statement("runs whose slow root is dominant", "some", shown, bool(chosen), source)
    for name, (middle, worst) in (deviations(chosen) if chosen else {}).items():
        label = f"{name}: worst of {len(chosen)} (median {middle:.2g})"
        yield rows.number(label, 0.0, worst, DECAY, SOURCE, 1.0)
