"""Candidates of a design: every number of weights in several sizes that fit and hold enough."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from scipy.optimize import brentq

from ...models.papers import capacity as theory
from ..scene import Scene
from .scenes import weights_of
from .space import Space

ABOVE = 1e-6  # of the capacity that is needed, beyond it: the smallest size is found by iteration
SIZES = 3  # of each number: the smallest that holds enough, one between, the largest that fits
# nominal diameters of steel balls for rolling bearings, ISO 3290-1, in part [m]
STANDARD = tuple(
    1e-3 * d
    for d in (
        *(1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 5.5, 6.0, 6.5, 7.0, 7.5, 8.0, 8.5, 9.0),
        *(9.5, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0, 16.0, 17.0, 18.0, 19.0, 20.0, 22.0, 24.0),
        *(25.0, 26.0, 28.0, 30.0, 32.0, 34.0, 35.0, 36.0, 38.0, 40.0, 45.0, 50.0),
    )
)


@dataclass(frozen=True)
class Candidate:
    """A number and size of weights.

    Attributes:
        count: of weights.
        radius, mass: of each [m, kg].
        capacity: [kg m].
        track: radius of the circle on which the centres move [m].
    """

    count: int
    radius: float
    mass: float
    capacity: float
    track: float


def candidates(
    scene: Scene, space: Space, counts: Sequence[int], standard: bool
) -> list[Candidate]:
    """All that hold the largest unbalance with the reserve, and fit.

    Args:
        standard: only diameters of `STANDARD`.
    """
    kind = weights_of(scene).kind
    found = []
    for count in counts:
        low, high = _limits(kind, space, count)
        if low is None:
            continue
        for radius in _radii(low, high, standard):
            found.append(_candidate(kind, space, count, radius))
    return [one for one in found if one.capacity >= space.required]


def largest_capacity(scene: Scene, space: Space, counts: Sequence[int]) -> Candidate:
    """The one that holds most."""
    kind = weights_of(scene).kind
    most = [_candidate(kind, space, n, _largest(kind, space, n)) for n in counts]
    return max(most, key=lambda one: one.capacity)


def _limits(kind: str, space: Space, count: int) -> tuple[float | None, float]:
    """Smallest radius that holds enough, None where none does, and the largest that fits [m]."""
    high = _largest(kind, space, count)
    most = _candidate(kind, space, count, high).capacity
    if most < space.required:
        return None, high
    low, needed = 1e-3 * high, min(most, space.required * (1.0 + ABOVE))

    def missing(radius: float) -> float:
        return _candidate(kind, space, count, radius).capacity - needed

    return (low if missing(low) >= 0.0 else float(brentq(missing, low, high, rtol=1e-9))), high


def _largest(kind: str, space: Space, count: int) -> float:
    """Of the radii up to the one of largest capacity, the largest that the room allows [m]."""
    radius = theory.best_ratio(kind, count) * space.race
    room = 0.5 * (space.width - space.clearance)
    return min(radius, room) if kind == "balls" else radius


def _radii(low: float, high: float, standard: bool) -> Iterator[float]:
    if standard:
        fit = [0.5 * d for d in STANDARD if low <= 0.5 * d * (1.0 + 1e-9) and 0.5 * d <= high]
        places = sorted({round(k * (len(fit) - 1) / (SIZES - 1)) for k in range(SIZES)})
        yield from (fit[k] for k in places if fit)
        return
    steps = 1 if high <= 1.05 * low else SIZES - 1
    yield from (low * (high / low) ** (k / steps) for k in range(steps + 1))


def _candidate(kind: str, space: Space, count: int, radius: float) -> Candidate:
    mass = theory.weight_mass(kind, radius, space.density, space.width - space.clearance)
    track = space.race - radius
    held = theory.capacity(mass, track, radius, count)
    return Candidate(count, radius, mass, held, track)
