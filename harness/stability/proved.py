"""Speeds at which balancing is proved to be stable or unstable, for all machines in tolerance.

`models/proof` proves an interval of speeds and a box of parameters at once.  Here the range is
divided until everything is decided, or what is undecided is narrow.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import flint

from ...models.boundaries import Crossing
from ...models.proof.certificate import State
from ...models.proof.window import WindowBalls, ends
from ..output.workers import Progress
from ..scene import Scene
from ..units import rounded_outwards, shown_in
from .band_search import Band, Search, merged
from .exact import tolerances, window

PRECISION = 128  # bits, of balls
NARROWEST = 1e-7  # of the range: an undecided band, where nothing else is asked for
NARROWEST_WITHIN = 1e-3  # of machines within tolerances: each has its own boundaries


@dataclass(frozen=True)
class Proof:
    """What is proved of a range of speeds.

    Attributes:
        bands: of the whole range, ascending, without gaps.
        narrowest: width to which undecided bands were divided [rad/s].
        certificates: number of speeds about which modes were computed.
        boxes: largest number of boxes into which the tolerances were divided.
        within: the tolerances, as they were given.
        window: Dubovik's limits, where they apply.
    """

    bands: tuple[Band, ...]
    narrowest: float
    certificates: int
    boxes: int = 1
    within: str = ""
    window: WindowBalls | None = None

    @property
    def undecided(self) -> float:
        """Share of the range that is undecided."""
        width = sum(b.high - b.low for b in self.bands if b.state == "undecided")
        return width / (self.bands[-1].high - self.bands[0].low)

    @property
    def boundaries(self) -> list[tuple[Band, Crossing]]:
        """Undecided bands between two states, each with the boundary in its middle."""
        return [
            (band, Crossing(0.5 * (band.low + band.high), after.state))
            for before, band, after in zip(self.bands, self.bands[1:], self.bands[2:], strict=False)
            if band.state == "undecided" and {before.state, after.state} == {"stable", "unstable"}
            and after.state != "undecided"
        ]  # fmt: skip

    def lines(self) -> Iterator[str]:
        """What the bands do not show."""
        if self.window is not None:
            lower, upper = self.window.lower, self.window.upper
            yield (
                f"the window is {self.window.state}: less bending than without liquid above "
                f"{_enclosed(lower)}"
            )
            if upper is not None:
                yield f"stable below {_enclosed(upper)}"
        else:
            boxes = f" and up to {self.boxes} boxes of parameters" if self.boxes > 1 else ""
            several = "s" * (self.certificates != 1)
            yield (
                f"{self.certificates} certificate{several}{boxes}; "
                f"{100.0 * self.undecided:.3g} % of the range undecided"
            )

    def as_json(self) -> dict[str, Any]:
        """The certificate's data."""
        return {
            "precision": PRECISION,
            "narrowest": self.narrowest,
            "certificates": self.certificates,
            "boxes": self.boxes,
            "within": self.within,
            "undecided_share": self.undecided,
            "boundaries": [
                {"from": band.low, "to": band.high, "above": crossing.above}
                for band, crossing in self.boundaries
            ],
            "window": None if self.window is None else self.window.as_json(),
        }


def prove(
    scene: Scene,
    low: float,
    high: float,
    *,
    narrowest: float | None = None,
    within: str = "",
    progress: Progress | None = None,
) -> Proof:
    """Bands of stability and instability from `low` to `high` [rad/s].

    Args:
        narrowest: width to which undecided bands are divided [rad/s].
        within: tolerances of parameters, see `exact.tolerances`.

    Raises:
        Unproved: nothing can be proved of the scene, and why.
        UserError: the tolerances are wrong.
    """
    with flint.ctx.workprec(PRECISION):
        changes = tolerances(within, scene) if within else ()
        share = NARROWEST_WITHIN if within else NARROWEST
        width = share * (high - low) if narrowest is None else narrowest
        limits = window(scene, changes)
        if limits is not None:
            return Proof(_outside(limits, low, high), width, 0, 1, within, limits)
        search = Search(scene, changes, width, progress)
        bands = merged(search.bands(low, high))
        return Proof(bands, width, search.certificates, search.most_boxes, within)


def _enclosed(speed: flint.arb) -> str:
    """The two speeds between which that of every machine lies, in the unit that is shown."""
    unit, factor = shown_in("rad/s")
    below, above = ends(speed)
    low, high = rounded_outwards(factor * below, factor * above)
    return f"{low} to {high} {unit}"


def _outside(limits: WindowBalls, low: float, high: float) -> tuple[Band, ...]:
    """Stable below Dubovik's upper limit, unstable above it."""
    below, above = (math.inf, math.inf) if limits.upper is None else ends(limits.upper)
    nodes = [low, min(max(low, below), high), min(max(low, above), high), high]
    states: tuple[State, ...] = ("stable", "undecided", "unstable")
    parts = (Band(a, b, s) for a, b, s in zip(nodes, nodes[1:], states, strict=False) if a < b)
    return tuple(parts)
