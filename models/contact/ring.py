"""The weights of a track in the order in which they stand on it, and who touches whom.

Every array has one entry a weight and is allocated once.  Weights that are linked are a run of
neighbours, told by its first weight and its size; it may pass the last weight and go on with the
first.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from .contact import Pools
from .track import Track

_OVERLAP = 1e-7  # rad: of a start; rounding of angles after a million turns stays below
_ALIGNED = 1e-12  # rad: contacts this exact are left alone, so that resting weights never creep


class Runs:
    """Runs of neighbours among N weights.

    Attributes:
        count: number of runs; the entries beyond it mean nothing.
        first: (N,) first weight of each.
        size: (N,) number of its weights: first, first + 1, ..., modulo N.
    """

    __slots__ = ("count", "first", "size")

    def __init__(self, n: int) -> None:
        self.count = 0
        self.first, self.size = [0] * n, [0] * n


class Groups(Runs):
    """Runs of weights that move as one.

    Attributes:
        middle, angle_rate: (N,) [rad, rad/s].
        sign: (N,) direction in which a group slides; 0.0 without resistance or at rest.
        resting: (N,) True when held by resistance.
        end_middle, end_rate: (N,) after the stretch of time that is looked at.
    """

    __slots__ = ("angle_rate", "end_middle", "end_rate", "middle", "resting", "sign")

    def __init__(self, n: int) -> None:
        super().__init__(n)
        self.middle, self.angle_rate = [0.0] * n, [0.0] * n
        self.sign, self.resting = [0.0] * n, [False] * n
        self.end_middle, self.end_rate = [0.0] * n, [0.0] * n


@dataclass(slots=True)
class WeightsInOrder:
    """State of the weights, and the arrays that are needed to move them.

    Attributes:
        order: (N,) which of the weights, as they were given, stands here.
        given: (N,) angles as they were given [rad].
        begin: (N,) the same in order and within a turn.
        angle, angle_rate: (N,) in order, ascending and within a turn [rad, rad/s].
        joined: (N,) True where a weight lastingly touches the next.
        chains, groups: runs that were found last.
        pools, drives, limits, sides, linked: scratch of N entries.
    """

    track: Track
    count: int
    order: list[int]
    given: list[float]
    begin: list[float]
    angle: list[float]
    angle_rate: list[float]
    joined: list[bool]
    chains: Runs
    groups: Groups
    pools: Pools
    drives: list[float]
    limits: list[float]
    sides: list[float]
    linked: list[bool]


def put_in_order(
    track: Track, angles: Sequence[float], speeds: Sequence[float], contacts: Sequence[float]
) -> WeightsInOrder:
    """Weights as they stand on the track.

    Args:
        angles, speeds: (N,) [rad, rad/s].
        contacts: (N,) not 0.0 where a weight lastingly touches the next along increasing angle.

    Raises:
        ValueError: weights overlap.
    """
    n = track.weights.count
    within = [angle % math.tau for angle in angles]
    order = list(range(n))
    if track.solid:
        order.sort(key=within.__getitem__)
    begin = [within[k] for k in order]
    weights = WeightsInOrder(
        track=track,
        count=n,
        order=order,
        given=list(angles),
        begin=begin,
        angle=begin[:],
        angle_rate=[speeds[k] for k in order],
        joined=[track.full or (track.solid and bool(contacts[k])) for k in order],
        chains=Runs(n),
        groups=Groups(n),
        pools=Pools(n),
        drives=[0.0] * n,
        limits=[0.0] * n,
        sides=[0.0] * n,
        linked=[False] * n,
    )
    if track.solid:
        align(weights)
    return weights


def as_given(weights: WeightsInOrder) -> tuple[list[float], list[float], list[float]]:
    """Angles, rates and contacts in the order in which they were given.

    Turns are kept, and a weight that has not moved keeps its angle to the last digit.
    """
    n = weights.count
    angles, speeds, contacts = weights.given[:], [0.0] * n, [0.0] * n
    for j, k in enumerate(weights.order):
        angles[k] += weights.angle[j] - weights.begin[j]
        speeds[k] = weights.angle_rate[j]
        contacts[k] = 1.0 if weights.joined[j] else 0.0
    return angles, speeds, contacts


def gap(weights: WeightsInOrder, k: int) -> float:
    """Free angle between weight k and the next [rad]."""
    angle, after = weights.angle, k + 1
    ahead = angle[after] if after < weights.count else angle[0] + math.tau
    return ahead - angle[k] - 2.0 * weights.track.alpha


def find_chains(weights: WeightsInOrder, linked: Sequence[bool]) -> None:
    """Set `chains`, the runs of weights each of which is linked to the next."""
    n, chains = weights.count, weights.chains
    start = 0
    if weights.track.solid:  # behind the first link that is missing
        while start < n and linked[start]:
            start += 1
        start = 0 if start == n else start + 1
    first, count = start, 0
    for k in range(start, start + n):
        if k == start + n - 1 or not linked[k % n]:
            chains.first[count], chains.size[count] = first % n, k + 1 - first
            first, count = k + 1, count + 1
    chains.count = count


def align(weights: WeightsInOrder) -> None:
    """Exact distances and one rate in every chain of lasting contacts; refuse overlaps."""
    joined = weights.joined
    for k in range(weights.count):
        free = gap(weights, k)
        if free < -_OVERLAP:
            raise ValueError(
                f"weights overlap by {-free:.3g} rad: neighbours need "
                f"{2 * weights.track.alpha:.6g} rad"
            )
        if joined[k] and free > _OVERLAP:
            joined[k] = False
    if True not in joined:
        return
    find_chains(weights, joined)
    for i in range(weights.chains.count):
        first, size = weights.chains.first[i], weights.chains.size[i]
        if size > 1 and not _aligned(weights, first, size):
            middle = rate = 0.0
            for j in range(first, first + size):
                k = j % weights.count
                middle += weights.angle[k] + (math.tau if k < first else 0.0)
                rate += weights.angle_rate[k]
            place(weights, first, size, middle / size, rate / size)


def _aligned(weights: WeightsInOrder, first: int, size: int) -> bool:
    n, rate = weights.count, weights.angle_rate
    for j in range(first, first + size - 1):
        if abs(gap(weights, j % n)) > _ALIGNED or rate[(j + 1) % n] != rate[first]:
            return False
    return True


def place(weights: WeightsInOrder, first: int, size: int, middle: float, rate: float) -> None:
    """Put a run of weights that touch about the angle `middle`."""
    for j in range(size):
        k = first + j
        angle = middle + (2 * j - size + 1) * weights.track.alpha
        if k >= weights.count:
            k, angle = k - weights.count, angle - math.tau
        weights.angle[k], weights.angle_rate[k] = angle, rate
