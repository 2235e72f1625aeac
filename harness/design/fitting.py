"""Which weights to fit, if any: candidates over number and size, judged from the real start."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from ...models.readable import readable_unbalance
from ..motions.starts import drive_to, run_up_begins
from ..output.outcome import Outcome
from ..output.table import Sheet
from ..output.workers import Progress, Workers, in_order
from ..scene import Scene
from .candidates import Candidate, candidates, largest_capacity
from .drags import DragRange
from .scenes import unbalance_of, weights_of
from .space import Space
from .trials import LIKELY, Trial, corner_scenes, preference, run_corner

_HELD = 2.0  # times the settling time that a saved scene runs at its speed
SMALL = 0.1  # of the largest unbalance: the smallest that is tried where none is given
MOST = 24  # candidates that are run: the lightest
FIRST = 6  # starts of every candidate and corner
KEPT = 4  # of those whose share may be `LIKELY`, the best, make all starts


@dataclass(frozen=True, repr=False)
class Fitting(Outcome):
    """All candidates for one rotor and space, and what came of them.

    Attributes:
        title: of the scene.
        kind: of the weights.
        space: what they must fit into and hold.
        trials: of the candidates that were run.
        not_run: how many more there were.
        most: the candidate of largest capacity, where none has enough.
        start: rest, turning or run-up.
        assumed: drive, drag and unbalance, a sentence each.
        starts: runs of every corner.
        driven: the scene with its drive.
    """

    drawn_by: ClassVar[str] = "..design.fitting_plot:plot_fitting"

    title: str
    kind: str
    space: Space
    trials: tuple[Trial, ...]
    not_run: int
    most: Candidate
    start: str
    assumed: tuple[str, ...]
    starts: int
    driven: Scene

    def scene(self) -> Scene | None:
        """The scene with the recommended weights at the smallest drag tried; None: none is.

        After a run-up its run lasts twice as long as such weights took to balance.
        """
        from .answer import sure

        if not (good := sure(self)):
            return None
        least = min(corner.drag for corner in good[0].corners)
        largest = [self.space.unbalance]
        ((found, _),) = corner_scenes(self.driven, good[0].candidate, [least], largest)
        own = self.driven.document["rotor"].get("unbalance")  # as it was written
        same = math.isclose(unbalance_of(self.driven), largest[0], rel_tol=1e-9)
        found = found.replace({"rotor.unbalance": own}) if same else found
        if not found.profile().changes:
            return found
        seconds = found.profile().times[-1] + _HELD * good[0].settling
        return found.replace({"run.duration": float(f"{seconds:.3g}"), "run.revolutions": None})

    def table(self) -> Sheet:
        """A row for every candidate."""
        columns = (
            "n", "diameter [m]", "mass of all [kg]", "capacity [kg m]", "balances", "95 % from",
            "to", "drag over limit", "peak [m]", "peak over none", "left over none",
            "settling time [s]", "failure",
        )  # fmt: skip
        rows = []
        for one in self.trials:
            c, (low, high) = one.candidate, one.interval
            numbers = (one.margin, one.peak, one.peak_ratio, one.left, one.settling)
            cells = ["" if not math.isfinite(x) else x for x in numbers]
            size = (c.count, 2.0 * c.radius, one.total, c.capacity)
            rows.append([*size, one.worst.share, low, high, *cells, one.failure])
        return Sheet(columns, rows, "r" * (len(columns) - 1) + "l", self.title)

    def as_json(self) -> dict[str, Any]:
        """The rows of the table, and the numbers from 0 of those recommended and also good."""
        from .answer import alternatives, sure

        row = {id(one): k for k, one in enumerate(self.trials)}
        recommended, also = (
            [row[id(one)] for one in those] for those in (sure(self)[:1], alternatives(self))
        )
        return {**super().as_json(), "recommended": recommended, "also_good": also}

    def words(self) -> list[str]:
        """The recommendation with its reasons, after what was assumed."""
        from .answer import words

        return words(self)


def fitting(
    scene: Scene,
    space: Space,
    drags: DragRange,
    *,
    counts: Sequence[int],
    start: str = "run-up",
    starts: int = 40,
    standard: bool = False,
    drive: Mapping[str, Any] | None = None,
    workers: Workers = 1,
    progress: Progress | None = None,
) -> Fitting:
    """Judge candidates; arguments and errors as `Scene.design`, in SI units.

    Args:
        drive: changes of the scene that make its run-up; default: a slow one.
    """
    balls = weights_of(scene)
    found = candidates(scene, space, counts, standard)
    unbalances = _unbalances(space)
    assumed = [drags.said, *_assumed(scene.replace(drive or {}), start, unbalances)]
    chosen = sorted(found, key=lambda one: one.count * one.mass)[:MOST]
    driven = scene.replace(drive or {})
    corners = [corner_scenes(driven, one, drags.of(one), unbalances) for one in chosen]
    first = min(starts, max(FIRST, starts // 5))
    run = _Runs(start, workers, progress)
    trials = run.starts_of(chosen, corners, 0, first)
    again = [k for k, one in enumerate(trials) if one.interval[1] >= LIKELY and first < starts]
    again = sorted(again, key=lambda k: (-trials[k].worst.share, *preference(trials[k])))[:KEPT]
    more = run.starts_of(
        [chosen[k] for k in again], [corners[k] for k in again], first, starts - first
    )
    for k, one in zip(again, more, strict=True):
        trials[k] = trials[k].with_more(one)
    most = largest_capacity(scene, space, counts)
    return Fitting(
        scene.heading, balls.kind, space, tuple(trials), len(found) - len(chosen), most, start,
        tuple(line for line in assumed if line), starts, driven,
    )  # fmt: skip


class _Runs:
    """Runs of candidates, with progress over both looks."""

    def __init__(self, start: str, workers: Workers, progress: Progress | None) -> None:
        self.start, self.workers, self.progress = start, workers, progress
        self.done = 0.0

    def starts_of(
        self,
        chosen: Sequence[Candidate],
        corners: Sequence[list[tuple[Scene, float]]],
        first: int,
        count: int,
    ) -> list[Trial]:
        """Some starts of candidates in all their corners."""
        work = [(s, u, self.start, first, count) for each in corners for s, u in each]
        found = iter(in_order(run_corner, work, self.workers, self._half))
        self.done = 0.5
        return [
            Trial(one, tuple(next(found) for _ in each))
            for one, each in zip(chosen, corners, strict=True)
        ]

    def _half(self, fraction: float) -> None:
        if self.progress is not None:
            self.progress(self.done + 0.5 * fraction)


def _unbalances(space: Space) -> tuple[float, ...]:
    """Smallest and largest to be tried [kg m]."""
    least = max(space.least, SMALL * space.unbalance)
    return (least, space.unbalance) if least < space.unbalance else (space.unbalance,)


def _assumed(scene: Scene, start: str, unbalances: Sequence[float]) -> list[str]:
    said = []
    if start == "turning":
        said.append("Starts: weights turn with the rotor at its speed, the friendliest start.")
    elif start == "rest":
        said.append("Starts: the rotor at its speed, weights at rest.")
    else:
        driven, reached, word = drive_to(scene, scene.profile().end, "run-up")
        word = (
            f"{word}. Give --run-up 4s for your own" if word else f"full speed at {reached:.4g} s"
        )
        said.append(f"Starts: {run_up_begins(driven)}; {word}.")
    if len(unbalances) > 1:
        low, high = map(readable_unbalance, unbalances)
        said.append(f"Unbalance: tried at {low} and at {high}.")
    return said
