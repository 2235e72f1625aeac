"""Where a scene's balancers work, as the strip under the page's speed slider shows it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ...models.linear.critical import speeds_of_interest
from ...models.linear.on_race import has_lobes
from ...models.papers.window import OPEN_END, LiquidWindow
from ..scene import Scene
from ..stability.boundaries import speeds

OF_LOBES = 50  # intervals of the range in which weights on races with lobes are looked at
FOLLOWED = 1.15  # times the upper limit of a window: what is beyond it is seen

Kind = Literal["good", "poor", "unstable", "unknown"]
_KINDS: dict[str, Kind] = {"stable": "good", "unstable": "unstable"}


@dataclass(frozen=True)
class Window:
    """Speeds from `low` to `high` [rad/s] and what the balancers do there.

    Attributes:
        ends: (n,) upper ends of what `kinds` tells, ascending; empty where there is no answer.
        kinds: (n,) good: they balance, or the liquid lessens the bending; poor: stable, and does
            not; unstable; unknown: the method cannot tell, or weights have no rest there.
        words: what was asked, or why there is no answer.
    """

    low: float
    high: float
    ends: tuple[float, ...]
    kinds: tuple[Kind, ...]
    words: str


def window(scene: Scene) -> Window:
    """Of liquids by Dubovik 2006 (10), (11), of weights by Floquet."""
    low, high = speeds_of_interest(scene.assembly().rotor, scene.profile().end)
    if not scene.balancer:
        return Window(low, high, (), (), "the scene has no balancer")
    if not (scene.assembly().weights or scene.assembly().rings):
        try:
            return _liquid(LiquidWindow.of(scene.assembly()), low, high)
        except ValueError as error:
            return Window(low, high, (), (), str(error))
    narrowest = (high - low) / OF_LOBES if has_lobes(scene.assembly()) else None
    boundaries = speeds(scene, (low, high), ["floquet"], narrowest=narrowest, whirl=False)
    if "floquet" not in boundaries.methods:
        return Window(low, high, (), (), boundaries.refused["floquet"])
    crossings = boundaries.methods["floquet"]
    sides = [boundaries.lowest["floquet"], *(c.above for c in crossings)]
    kinds = tuple(_KINDS.get(side, "unknown") for side in sides)
    return Window(low, high, (*(c.speed for c in crossings), high), kinds, "exact stability")


def _liquid(liquid: LiquidWindow, low: float, high: float) -> Window:
    upper = liquid.upper
    if upper is not None and upper < OPEN_END * liquid.lower:
        high = max(high, FOLLOWED * upper)
    limits = sorted({s for s in (liquid.lower, upper, high) if s is not None and s <= high})
    kinds: list[Kind] = []
    for end in limits:
        stable = upper is None or end <= upper
        kinds.append("unstable" if not stable else "good" if end > liquid.lower else "poor")
    return Window(low, high, tuple(limits), tuple(kinds), "window of Dubovik 2006")
