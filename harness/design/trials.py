"""Candidates switched on as the real machine is: shares that balance, peaks, settling times."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ...models.arrays import Array
from ...models.capture import Capture
from ...models.shares import wilson
from ..capture.captured import captured_or_none
from ..errors import SimulationError, UserError
from ..motions.batch import squared_distances
from ..motions.settle import alone
from ..motions.starts import Job, job
from ..scene import Scene
from .candidates import Candidate

BALANCED = 0.05  # of the vibration without balancers
LIKELY = 0.9  # share of starts whose interval must reach above it: a candidate that balances
LAST = 0.1  # of the time at speed: where a run is judged
EXTENDED = 3.0  # times as long a run that has not balanced is run once more,
MOST_EXTENDED = 16.0  # and so long one whose vibration still falls then
FALLS = 0.9  # to so much of the vibration halfway


@dataclass(frozen=True)
class Corner:
    """One drag and one unbalance of a candidate, run from many starts.

    Attributes:
        drag, unbalance: [N s/m, kg m].
        settled: (n,) by start, time at speed after which the vibration stays below `BALANCED` of
            that without balancers [s]; infinite: not within the run.
        left: (n,) vibration at the end over that without balancers.
        peak: (n,) largest vibration of the run [m].
        peak_alone: of the same drive without balancers [m].
        margin: drag over the one from which on no weights can be left behind; infinite: none can;
            NaN: the closed form cannot tell.
        failure: why a run failed; else empty.
        seconds: at speed, in which the starts had to balance [s]; 0: it is not known.
        falls: (n,) vibration at the end over that halfway at speed; empty: it is not known.
    """

    drag: float
    unbalance: float
    settled: Array
    left: Array
    peak: Array
    peak_alone: float
    margin: float
    failure: str = ""
    seconds: float = 0.0
    falls: Array = field(default_factory=lambda: np.empty(0))

    @property
    def of(self) -> int:
        """Starts."""
        return len(self.settled)

    @property
    def balanced(self) -> int:
        """Starts that balance."""
        return int(np.isfinite(self.settled).sum())

    @property
    def share(self) -> float:
        """Of the starts that balance."""
        return self.balanced / self.of

    def with_more(self, other: Corner) -> Corner:
        """The same corner with more starts."""
        return replace(
            self,
            settled=np.concatenate([self.settled, other.settled]),
            left=np.concatenate([self.left, other.left]),
            peak=np.concatenate([self.peak, other.peak]),
            failure=self.failure or other.failure,
            seconds=max(self.seconds, other.seconds),
            falls=np.concatenate([self.falls, other.falls]),
        )


@dataclass(frozen=True)
class Trial:
    """A candidate with all its corners."""

    candidate: Candidate
    corners: tuple[Corner, ...]

    @property
    def worst(self) -> Corner:
        """The corner in which fewest starts balance."""
        return min(self.corners, key=lambda c: (c.share, -float(np.median(c.left))))

    @property
    def interval(self) -> tuple[float, float]:
        """95 % interval of the share that balances in the worst corner."""
        return wilson(self.worst.balanced, self.worst.of)

    @property
    def margin(self) -> float:
        """The smallest of the closed form's; NaN where it cannot tell."""
        return float(np.min([c.margin for c in self.corners]))

    @property
    def peak(self) -> float:
        """Median of the largest vibration in the worst corner [m]."""
        return max(float(np.median(c.peak)) for c in self.corners)

    @property
    def peak_alone(self) -> float:
        """Largest vibration without balancers, of the largest unbalance [m]."""
        return max(c.peak_alone for c in self.corners)

    @property
    def peak_ratio(self) -> float:
        """The one over the other."""
        return self.peak / self.peak_alone

    @property
    def left(self) -> float:
        """Median of the vibration at the end over that without balancers, in the worst corner."""
        return float(np.median(self.loudest.left))

    @property
    def loudest(self) -> Corner:
        """The corner that vibrates most at the end of its runs."""
        return max(self.corners, key=lambda c: float(np.median(c.left)))

    @property
    def still_falls(self) -> bool:
        """Whether the vibration there falls at the end of half of its runs or more."""
        falls = self.loudest.falls
        return len(falls) > 0 and float(np.median(falls)) < FALLS

    @property
    def settling(self) -> float:
        """Median time at speed until it balances, in the slowest corner [s]."""
        return max(float(np.median(c.settled)) for c in self.corners)

    @property
    def total(self) -> float:
        """Mass of all weights [kg]."""
        return self.candidate.count * self.candidate.mass

    def with_more(self, other: Trial) -> Trial:
        """The same candidate with more starts."""
        pairs = zip(self.corners, other.corners, strict=True)
        return replace(self, corners=tuple(mine.with_more(more) for mine, more in pairs))

    @property
    def failure(self) -> str:
        """Why a run failed; else empty."""
        return next((c.failure for c in self.corners if c.failure), "")


WORSE_PEAK = 1.05  # times the largest vibration without balancers


def preference(one: Trial) -> tuple[float, float]:
    """Smaller is better: the peak as far as it exceeds that without balancers, then the mass."""
    return max(one.peak_ratio, WORSE_PEAK), one.total


def run_corner(work: tuple[Scene, float, str, int, int]) -> Corner:
    """Starts of one corner.

    Args:
        work: the scene, its unbalance [kg m], the kind of start, and its first start and their
            number.
    """
    scene, unbalance, start, first, count = work
    speed = scene.profile().end
    balls = scene.balancer[0]
    drag = float(balls.device.each[0].drag)  # type: ignore[union-attr]
    found = captured_or_none(scene, speed)
    margin = _margin(found.found) if found else math.nan
    bare = alone(scene, speed)
    try:
        made, _ = job(scene, speed, start, 1, first, count)
        peak_alone = _largest_alone(made)
        seen, failure = _judged(made, bare)
        seconds, open_ = made.settled, np.flatnonzero(~np.isfinite(seen[0]))
        for factor in (EXTENDED, MOST_EXTENDED):
            if not len(open_):
                break
            late, why = _judged(made.longer(factor, open_), bare)
            for mine, again in zip(seen, late, strict=True):
                mine[open_] = again
            seconds, failure = factor * made.settled, failure or why
            open_ = open_[~np.isfinite(late[0]) & (late[3] < FALLS)]
        settled, left, peak, falls = seen
    except (UserError, SimulationError) as error:
        nothing = np.full(count, math.nan)
        never = np.full(count, math.inf)
        return Corner(drag, unbalance, never, nothing, nothing, math.nan, margin, str(error))
    return Corner(drag, unbalance, settled, left, peak, peak_alone, margin, failure, seconds, falls)


def _margin(found: Capture) -> float:
    """Drag over its limit."""
    if found.all_pass is None:
        return math.nan
    return 1.0 / found.drag_ratio if found.drag_ratio else math.inf


def _judged(made: Job, bare: float) -> tuple[list[Array], str]:
    """Settling times, vibration left over none, largest vibration [m], vibration at the end over
    that halfway, each (n,), and why a run failed."""
    squares, reasons = squared_distances(made)
    size = np.sqrt(squares)
    points = size.shape[1]
    times = np.linspace(0.0, made.seconds, points)
    at_speed = times >= made.seconds - made.settled
    high = size > BALANCED * bare
    last = np.where(high.any(axis=1), points - 1 - np.argmax(high[:, ::-1], axis=1), 0)
    settled = np.maximum(times[last] - (made.seconds - made.settled), 0.0)
    judged = times >= made.seconds - LAST * made.settled
    failed = np.array([bool(reason) for reason in reasons])
    settled[high[:, judged].any(axis=1) | failed] = math.inf
    ends = size[:, at_speed & judged].max(axis=1)
    halfway = at_speed & ~judged & (times >= made.seconds - (0.5 + LAST) * made.settled)
    halfway &= times <= made.seconds - 0.5 * made.settled
    falls = ends / size[:, halfway].max(axis=1)
    return [settled, ends / bare, size.max(axis=1), falls], next((r for r in reasons if r), "")


def _largest_alone(made: Job) -> float:
    """Largest vibration of the same drive without balancers [m]."""
    bare = replace(made, scene=made.scene.without_balancers(), columns=(), values=np.zeros((1, 0)))
    squares, reasons = squared_distances(bare)
    if any(reasons):
        raise SimulationError(f"without balancers: {reasons[0]}")
    return float(np.sqrt(squares.max()))


def corner_scenes(
    scene: Scene, one: Candidate, drags: Sequence[float], unbalances: Sequence[float]
) -> list[tuple[Scene, float]]:
    """The scene with a candidate, at every drag and unbalance."""
    label = scene.balancer[0].label
    sized = {
        "count": one.count, "mass": one.mass, "track_radius": one.track,
        "weight_radius": one.radius, "angles": None, "speeds": None,
    }  # fmt: skip
    named = {f"{label}.{key}": value for key, value in sized.items()}
    return [
        (scene.replace({"rotor.unbalance": u, f"{label}.drag": drag, **named}), u)
        for drag in drags
        for u in unbalances
    ]
