"""Speeds at which balancing begins or ends, as found by several methods."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

from ...models.linear.regions import Crossing, Regions, Side, Undecided
from ..output.outcome import Outcome
from ..output.table import Sheet
from .whirl import Whirls

if TYPE_CHECKING:
    from ..capture.captured import Captured
    from .proved import Proof


@dataclass(frozen=True, repr=False)
class Speeds(Outcome):
    """Boundaries within a range by several methods.

    Attributes:
        scene: its name.
        range: low and high [rad/s].
        methods: crossings of every method that applies, ascending.
        lowest: what each of these finds at the low end of the range.
        undecided: regions in which a method cannot tell stable from unstable.
        refused: why each other method gives no answer.
        whirl: what remains where weights do not balance fully; None where they do, or without the
            method floquet.
        proof: what the method proved proves; None where it was not asked or gives no answer.
        captured: whether weights can be left behind at the operating speed; None without weights,
            or where the closed form does not apply.
        supports: how cubic springs and stops count; empty without any.
    """

    drawn_by: ClassVar[str] = "..stability.plot:plot_speeds"

    scene: str
    range: tuple[float, float]
    methods: dict[str, tuple[Crossing, ...]] = field(default_factory=dict)
    lowest: dict[str, Side] = field(default_factory=dict)
    undecided: dict[str, tuple[Undecided, ...]] = field(default_factory=dict)
    refused: dict[str, str] = field(default_factory=dict)
    whirl: Whirls | None = None
    proof: Proof | None = None
    captured: Captured | None = None
    supports: str = ""

    def unknown(self) -> Iterator[str]:
        """Where a method cannot tell stable from unstable, in words.

        >>> found = ab.load("filimonikhina").speeds(0.5, 12.0, "criterion,floquet")
        >>> list(found.unknown())
        []
        """
        for method, regions in self.undecided.items():
            for each in regions:
                if math.isinf(each.growth_below):
                    yield (
                        f"{method}: {each.word} from {each.low:.6g} to {each.high:.6g} rad/s: no "
                        "rest of the weights on their races was found there"
                    )
                    continue
                neutral = each.word == "neutral"
                why = "nothing damps the machine" if neutral else "the method's own error"
                yield (
                    f"{method}: {each.word} from {each.low:.6g} to {each.high:.6g} rad/s, growth "
                    f"below {each.growth_below:.2g} 1/s: {why}"
                )

    def table(self) -> Sheet:
        """A row for every crossing of every method."""
        rows = [(m, c.speed, c.above) for m, found in self.methods.items() for c in found]
        return Sheet(("method", "speed [rad/s]", "above it"), rows, "lrl", self.scene)

    def as_json(self) -> dict[str, Any]:
        """Plain lists and numbers."""
        methods = {
            name: [{"speed": c.speed, "above": c.above} for c in crossings]
            for name, crossings in self.methods.items()
        }
        proof: dict[str, Any] = {}
        if self.proof is not None:
            methods["proved"] = [band.as_json() for band in self.proof.bands]
            proof = {"proof": self.proof.as_json()}
        return {
            "scene": self.scene,
            "range": list(self.range),
            "methods": methods,
            **proof,
            "below_first": dict(self.lowest),
            "undecided": {
                name: [
                    {
                        "from": u.low,
                        "to": u.high,
                        "state": u.word,
                        "growth_below": u.growth_below if math.isfinite(u.growth_below) else None,
                    }
                    for u in regions
                ]
                for name, regions in self.undecided.items()
            },
            "errors": {name: [c.error for c in found] for name, found in self.methods.items()},
            "not_applicable": dict(self.refused),
            "whirl": None if self.whirl is None else self.whirl.as_json(),
            "supports": self.supports,
            "capture": None if self.captured is None else self.captured.as_json(),
        }

    def rows(self) -> list[dict[str, Crossing]]:
        """Crossings of the methods that belong together, one row each, ascending.

        Each method's crossing joins the nearest one of the most exact method that leads to the
        same side; what finds no partner stands alone.

        >>> found = ab.load("filimonikhina").speeds(0.5, 12.0, "criterion,floquet")
        >>> [list(row) for row in found.rows()][0]
        ['floquet', 'criterion']
        """
        order = [m for m in ("floquet", "cosim", "criterion") if m in self.methods]
        rows: list[dict[str, Crossing]] = []
        for method in order:
            left = list(self.methods[method])
            pairs = sorted(
                (abs(crossing.speed - next(iter(row.values())).speed), i, j)
                for i, row in enumerate(rows)
                for j, crossing in enumerate(left)
                if next(iter(row.values())).above == crossing.above
            )
            taken: set[int] = set()
            for _, i, j in pairs:
                if method not in rows[i] and j not in taken:
                    rows[i][method] = left[j]
                    taken.add(j)
            rows += [{method: c} for j, c in enumerate(left) if j not in taken]
        return sorted(rows, key=lambda row: next(iter(row.values())).speed)


def add_regions(result: Speeds, method: str, found: Regions) -> None:
    """Add what a method found."""
    result.methods[method] = found.crossings
    result.lowest[method] = found.lowest
    if found.undecided:
        result.undecided[method] = found.undecided
