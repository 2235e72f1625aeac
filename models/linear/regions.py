"""Regions of speed in which a motion is stable or unstable, and those that stay undecided.

A growth rate decides where it exceeds the error of the method that found it.  A limit is stated
only between two speeds that are decided; where no speed is decided over more than a small width,
that width is a region of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Side = Literal["stable", "unstable", "undecided", "neutral"]
Measure = Callable[[NDArray], tuple[NDArray, NDArray]]

NARROW = 1e-4  # of the speed: an undecided region narrower than that is the error of a limit
EDGE = 1e-5  # of the speed, to which the end of an undecided region is found
_ISLAND = 4.0  # times its error: what exceeds it somewhere is no rounding between undecided speeds
_SPLIT = 12  # parts of a bracket per round of refinement


@dataclass(frozen=True)
class Crossing:
    """A boundary of stability: its speed [rad/s], what holds just above it, and its error [rad/s].

    The error is the half of the width in which the method cannot tell one side from the other.
    """

    speed: float
    above: Side
    error: float = 0.0


@dataclass(frozen=True)
class Undecided:
    """A region in which a method cannot tell stable from unstable.

    Attributes:
        low, high: its ends [rad/s].
        growth_below: |growth rate| is smaller at every speed that was looked at [1/s].
        word: "undecided", or "neutral" where nothing damps the machine.
    """

    low: float
    high: float
    growth_below: float
    word: Side = "undecided"


@dataclass(frozen=True)
class Regions:
    """What a method finds over a range of speeds.

    Attributes:
        lowest: what holds at the low end of the range.
        crossings: where another thing begins to hold, ascending; neighbours differ.
        undecided: the regions above which "undecided" or "neutral" stands.
    """

    lowest: Side
    crossings: tuple[Crossing, ...] = ()
    undecided: tuple[Undecided, ...] = ()


@dataclass(frozen=True, eq=False)
class Samples:
    """Growth rates and their errors [1/s] at speeds [rad/s], (s,) each, ascending in speed."""

    speeds: NDArray[np.float64]
    growth: NDArray[np.float64]
    error: NDArray[np.float64]

    @property
    def signs(self) -> NDArray[np.int_]:
        """+1 unstable, -1 stable, 0 undecided."""
        return np.where(np.abs(self.growth) > self.error, np.sign(self.growth), 0).astype(int)

    def with_more(self, speeds: NDArray, growth: NDArray, error: NDArray) -> Samples:
        """The same and others, each speed once."""
        parts = zip((self.speeds, self.growth, self.error), (speeds, growth, error), strict=True)
        w, g, e = (np.concatenate([one, np.ravel(other)]) for one, other in parts)
        w, first = np.unique(w, return_index=True)
        return Samples(w, g[first], e[first])


@dataclass(frozen=True)
class _Stretch:
    """Neighbouring samples of one sign: its ends, and how far these may be off [rad/s]."""

    sign: int
    low: float
    high: float
    off: float  # of the high end
    growth_below: float

    @property
    def width(self) -> float:
        return self.high - self.low


def find_regions(
    measure: Measure, samples: Samples, tolerance: float, word: Side = "undecided"
) -> Regions:
    """Regions from samples that are refined wherever the sign changes.

    Args:
        measure: growth rates and errors [1/s] at speeds of any shape [rad/s].
        samples: to begin with; a change between two of them that have one sign is missed.
        tolerance: relative error of a limit.
        word: for what cannot be decided.
    """
    while True:
        w, signs = samples.speeds, samples.signs
        left, right = w[:-1], w[1:]
        fine = np.where(signs[:-1] * signs[1:] == 0, np.maximum(EDGE, tolerance), tolerance)
        coarse = (signs[:-1] != signs[1:]) & (right - left > fine * right)
        if not coarse.any():
            return regions_of(samples, word)
        inner = np.linspace(0.0, 1.0, _SPLIT + 1)[1:-1]
        nodes = left[coarse, None] + (right - left)[coarse, None] * inner
        samples = samples.with_more(nodes, *measure(nodes))


def regions_of(samples: Samples, word: Side = "undecided") -> Regions:
    """Regions between samples as they are; limits lie in the middle of two neighbours."""
    stretches = _merged(_stretches(samples, _without_islands(samples)))
    sides: dict[int, Side] = {1: "unstable", -1: "stable", 0: word}
    return Regions(
        sides[stretches[0].sign],
        tuple(Crossing(a.high, sides[b.sign], a.off) for a, b in pairwise(stretches)),
        tuple(
            Undecided(*_ends(stretches, k, word), s.growth_below, word)
            for k, s in enumerate(stretches)
            if s.sign == 0
        ),
    )


def _ends(stretches: Sequence[_Stretch], number: int, word: Side) -> tuple[float, float]:
    """Of a region: for a neutral one the outermost speeds that are known to be in it."""
    one, before = stretches[number], stretches[number - 1].off if number else 0.0
    if word == "neutral":
        return one.low + before, one.high - one.off
    return one.low, one.high


def _without_islands(samples: Samples) -> NDArray[np.int_]:
    """Signs; what barely exceeds its error between undecided speeds is undecided too."""
    signs = samples.signs
    clear = np.abs(samples.growth) > _ISLAND * samples.error
    begins = np.flatnonzero(np.diff(signs, prepend=2))
    for begin, end in zip(begins, [*begins[1:].tolist(), len(signs)], strict=True):
        inside = begin > 0 and end < len(signs) and signs[begin - 1] == 0 == signs[end]
        if inside and not clear[begin:end].any():
            signs[begin:end] = 0
    return signs


def _stretches(samples: Samples, signs: NDArray[np.int_]) -> list[_Stretch]:
    w, most = samples.speeds, np.abs(samples.growth) + samples.error
    begins = np.flatnonzero(np.diff(signs, prepend=2)).tolist()
    ends = [*begins[1:], len(w)]
    found: list[_Stretch] = []
    for begin, end in zip(begins, ends, strict=True):
        low = found[-1].high if found else w[0]
        last = end == len(w)
        high = w[-1] if last else (w[end - 1] + w[end]) / 2.0
        off = 0.0 if last else (w[end] - w[end - 1]) / 2.0
        below = float(most[begin:end].max())
        found.append(_Stretch(int(signs[begin]), float(low), float(high), float(off), below))
    return found


def _merged(stretches: list[_Stretch]) -> list[_Stretch]:
    """Undecided stretches that are narrow become the error of a limit, or part of a neighbour."""
    found: list[_Stretch] = []
    for number, one in enumerate(stretches):
        is_last = number == len(stretches) - 1
        narrow = one.sign == 0 and one.width <= NARROW * one.high
        if narrow and found:  # a limit in its middle, unless both sides are alike
            end = one.high if is_last else (one.low + one.high) / 2.0
            off = max(found[-1].off, one.off) + one.width / 2.0
            found[-1] = replace(found[-1], high=end, off=0.0 if is_last else off)
        elif narrow and not is_last:
            stretches[1] = replace(stretches[1], low=one.low)
        elif found and found[-1].sign == one.sign:
            below = max(found[-1].growth_below, one.growth_below)
            found[-1] = replace(found[-1], high=one.high, off=one.off, growth_below=below)
        else:
            found.append(replace(one, low=found[-1].high if found else one.low))
    return found
