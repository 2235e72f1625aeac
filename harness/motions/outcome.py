"""Shares of steady motions: table, sentences, JSON."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

from ...models.readable import brief
from ...models.shares import wilson
from ..output.outcome import Outcome
from ..output.table import Sheet
from ..scene import Scene
from ..units import in_both
from .kinds import Kind, Motion

SMALLEST, SMALLEST_RATIO = 1e-7, 1e-4  # vibration [m] and its ratio to none that are told apart


@dataclass(frozen=True)
class Share:
    """A motion and how many starts end in it.

    Attributes:
        count, of: starts.
        frequency: median speed of the weights that are left behind [rad/s]; NaN: none are.
        vibration: median of the largest distance of a station from the middle [m].
    """

    motion: Motion
    count: int
    of: int
    frequency: float
    vibration: float

    @property
    def share(self) -> float:
        """Of all starts."""
        return self.count / self.of

    @property
    def interval(self) -> tuple[float, float]:
        """95 % confidence interval of it."""
        return wilson(self.count, self.of)


@dataclass(frozen=True)
class Point:
    """All starts of one kind at one speed.

    Attributes:
        speed: of the rotor [rad/s].
        shares: by motion, the most frequent first.
        alone: vibration without balancers [m].
        largest: median of the largest vibration of a run [m].
        middle: number of the start, from 0, whose largest vibration is that median, or the next
            above it.
        failure: why a run failed; else empty.
    """

    speed: float
    start: str
    shares: tuple[Share, ...]
    alone: float
    largest: float
    failure: str = ""
    middle: int = 0

    def of(self, kind: Kind) -> Share:
        """All motions of a kind together."""
        those = [s for s in self.shares if s.motion.kind is kind]
        total = self.shares[0].of
        vibration = max((s.vibration for s in those), default=math.nan)
        return Share(Motion(kind), sum(s.count for s in those), total, math.nan, vibration)

    def ratio(self, share: Share) -> float:
        """Vibration of a motion over that without balancers; NaN where that is 0 or not known."""
        return share.vibration / self.alone if self.alone else math.nan

    @property
    def balanced(self) -> Share:
        """Share that balances."""
        return self.of(Kind.BALANCED)


@dataclass(frozen=True, eq=False, repr=False)
class Motions(Outcome):
    """Steady motions of a scene.

    Attributes:
        title: of the scene.
        points: by speed and start.
        n: starts of each.
        notes: what was assumed, a sentence each.
    """

    drawn_by: ClassVar[str] = "..motions.plot:plot_motions"

    title: str
    points: tuple[Point, ...]
    n: int
    notes: tuple[str, ...]
    scene: Scene

    def table(self) -> Sheet:
        """A row for every motion found at every point."""
        columns = (
            "speed [rad/s]", "start", "motion", "starts", "share", "95 % from", "to",
            "weights turn at [rad/s]", "vibration [m]", "ratio to none",
        )  # fmt: skip
        rows = []
        for point in self.points:
            for s in point.shares:
                low, high = s.interval
                cells = (s.frequency, s.vibration, point.ratio(s))
                rows.append(
                    [point.speed, point.start, s.motion.name, s.count, s.share, low, high]
                    + ["" if math.isnan(c) else c for c in cells]
                )
        return Sheet(columns, rows, "rllrrrrrrr", self.title)

    def readable(self) -> Sheet:
        """For a terminal."""
        columns = ("speed [rad/s]", "start", "motion", "share (95 %)", "vibration [mm]", "of none")
        rows = []
        for point in self.points:
            for k, s in enumerate(point.shares):
                name = s.motion.name
                if s.motion.kind is Kind.BEHIND and not math.isnan(s.frequency):
                    counted, _, beside = name.partition(" beside ")
                    name = f"{counted} at {s.frequency:.4g} rad/s"
                    name += f" beside {beside}" if beside else ""
                low, high = s.interval
                share = f"{100 * s.share:.0f} % ({100 * low:.0f} to {100 * high:.0f})"
                ratio = point.ratio(s)
                mm = "-" if math.isnan(s.vibration) else brief(1e3 * s.vibration, 3)
                of = "-" if math.isnan(ratio) else f"{100 * ratio:.3g} %"
                mm = "below 0.0001" if s.vibration < SMALLEST else mm
                of = "below 0.01 %" if ratio < SMALLEST_RATIO else of
                at = (f"{point.speed:.5g}", point.start) if not k else ("", "")
                rows.append([*at, name, share, mm, of])
        title = f"{self.title}: steady motions of {self.n} random starts each"
        return Sheet(columns, rows, "rllrrr", title, grouped=True)

    def sentences(self) -> Iterator[str]:
        """What the shares come to, and what was assumed."""
        worst = min(self.points, key=lambda p: p.balanced.share)
        low, high = worst.balanced.interval
        if worst.balanced.count == worst.balanced.of:
            yield (
                f"Every start balances (at least {100 * low:.0f} % of all, with 95 % confidence)."
            )
        else:
            yield (
                f"Fewest starts balance at {in_both(worst.speed, 'rad/s')} from {worst.start}: "
                f"{100 * worst.balanced.share:.0f} % ({100 * low:.0f} to {100 * high:.0f} %)."
            )
        open_ = sum(p.of(Kind.UNDECIDED).count for p in self.points)
        if open_:
            yield f"{open_} of {self.n * len(self.points)} runs had not decided when they ended."
        yield from (f"A run failed: {p.failure}" for p in self.points if p.failure)
        yield from self.notes

    def as_json(self) -> dict[str, Any]:
        """Everything; `None` for what is not known."""
        return {
            "scene": self.scene.name,
            "starts": self.n,
            "notes": list(self.notes),
            "points": [
                {
                    "speed": p.speed,
                    "start": p.start,
                    "vibration_without_balancers": _number(p.alone),
                    "largest_vibration": _number(p.largest),
                    "balanced": {"share": p.balanced.share, "interval": list(p.balanced.interval)},
                    "motions": [
                        {
                            "name": s.motion.name,
                            "kind": s.motion.kind.name.lower(),
                            "weights": s.motion.weights,
                            "natural_frequency": _number(s.motion.natural),
                            "count": s.count,
                            "share": s.share,
                            "interval": list(s.interval),
                            "frequency": _number(s.frequency),
                            "vibration": _number(s.vibration),
                            "ratio": _number(p.ratio(s)),
                        }
                        for s in p.shares
                    ],
                }
                for p in self.points
            ],
        }


def _number(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None
