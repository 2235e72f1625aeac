"""Weights of finite size on one track: packed groups, forces between them, collisions.

Weights of radius r whose centres move on a circle of radius R touch when they stand
2 alpha = 2 asin(r/R) apart (Goncharov 2017 (4)).  Contacts are smooth: the pressure between
neighbours acts along the track; what it adds to their load on the race is left to the race.

Packed group.  n weights that touch share one rate.  The mean of their drives (n weights, angles
2 alpha apart about the middle t) is that of one weight at t times sin(n alpha)/(n sin alpha), so a
group moves like one weight with a smaller gain.  Which contacts last follows from Gauss's principle
of least constraint: the accelerations y of a chain are

    min sum (y_k - g_k)^2/2 + f_k |y_k|,     y_1 <= y_2 <= ... <= y_n,

with free accelerations g_k and, for weights at rest, limits f_k of rolling resistance.  It has one
solution, pooling of adjacent violators finds it exactly, and a contact between two pools opens.

Collision.  Equal masses, Newton's restitution e, and the rotor held during the blow; approaching
pairs collide first, several in a row at once by v -> (1 + e) mean - e v (Moreau's law), until none
approaches.  Each blow keeps sum v and does not raise sum v^2.  The momentum of the weights,
m R sum i v e^{i theta}, does change, since neighbours move in different directions: for two weights
that exchange the rate J by -2 m R J sin(alpha) e^{i t}.  Its opposite strikes the rotor.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from functools import lru_cache

_SWEEPS_PER_WEIGHT = 8  # a blow passes one contact a sweep; what still goes on has collapsed
_WEAKEST = 1e-4  # of the largest difference of rates: blows below it end without rebound
_NO_APPROACH = 1e-12  # the same with e = 1, where nothing dies out: rounding only


class Pools:
    """Runs of neighbours of a chain of at most N weights that share one value.

    Attributes:
        count: number of pools; the entries beyond it mean nothing.
        first, size: (N,) first weight of the chain in a pool, and how many it has.
        drive, limit: (N,) sums over its weights.
        value: (N,) what its weights share.
    """

    __slots__ = ("count", "drive", "first", "limit", "size", "value")

    def __init__(self, n: int) -> None:
        self.count = 0
        self.first, self.size = [0] * n, [0] * n
        self.drive, self.limit, self.value = [0.0] * n, [0.0] * n, [0.0] * n


def group_factor(count: int, alpha: float) -> float:
    """sin(n alpha)/(n sin alpha): mean drive of a packed group in units of one weight's."""
    if count == 1 or alpha == 0.0:
        return 1.0
    return math.sin(count * alpha) / (count * math.sin(alpha))


@lru_cache(maxsize=256)  # the sizes of groups on a few tracks
def pressure_factors(count: int, alpha: float) -> tuple[complex, ...]:
    """Factors q_1..q_{n-1} of a packed group about its middle angle t.

    With every weight driven by Im(G a e^{-i theta}), the contact after weight j carries
    Im(G a e^{-i t} q_j) kappa m R [N] of pressure: what the first j have more than their share.
    """
    units = [cmath.rect(1.0, -(2 * k - count + 1) * alpha) for k in range(count)]
    mean = sum(units) / count
    factors, total = [0j] * (count - 1), 0j
    for j in range(count - 1):
        total += units[j] - mean
        factors[j] = total
    return tuple(factors)


def pool(
    pools: Pools, drives: Sequence[float], limits: Sequence[float] | None, length: int, slack: float
) -> None:
    """Set `pools` to the accelerations of a chain of touching weights: Gauss's principle, above.

    Args:
        drives: (length,) free accelerations g along increasing angle [rad/s^2].
        limits: (length,) resistance f of weights at rest; 0 for moving ones, whose g has it
            already; None: no resistance.
        slack: tension that is taken for rounding [rad/s^2].
    """
    count = 0
    for k in range(length):
        first, size = k, 1
        drive, limit = drives[k], limits[k] if limits is not None else 0.0
        value = _shrunk(drive, limit)
        while count and pools.value[count - 1] >= value - slack:
            count -= 1
            first, size = pools.first[count], pools.size[count] + size
            drive, limit = pools.drive[count] + drive, pools.limit[count] + limit
            value = _shrunk(drive, limit) / size
        pools.first[count], pools.size[count] = first, size
        pools.drive[count], pools.limit[count], pools.value[count] = drive, limit, value
        count += 1
    pools.count = count


def expand(pools: Pools, values: list[float], begin: int = 0) -> None:
    """Give every weight of a chain the value of its pool: values[begin], values[begin + 1], ..."""
    for i in range(pools.count):
        for k in range(pools.first[i], pools.first[i] + pools.size[i]):
            values[begin + k] = pools.value[i]


def collide(rates: list[float], length: int, restitution: float, pools: Pools) -> None:
    """Collisions among a chain of touching weights.

    Args:
        rates: (length,) along increasing angle [rad/s]; afterwards they do not decrease along the
            chain, have the same sum, and no larger sum of squares.
        restitution: e of a pair, 0 to 1.
        pools: scratch of `length` entries.
    """
    largest = max(rates[:length]) - min(rates[:length])
    tiny = (_NO_APPROACH if restitution == 1.0 else _WEAKEST) * largest
    sweeps = _SWEEPS_PER_WEIGHT * length if restitution > 0.0 else 0
    while sweeps and _rebound(rates, length, restitution, tiny):
        sweeps -= 1
    unite(rates, length, pools)


def _rebound(rates: list[float], length: int, restitution: float, tiny: float) -> bool:
    """Turn round all runs of weights each of which approaches the next; False: there was none."""
    struck, k = False, 0
    while k < length - 1:
        first = k
        while k < length - 1 and rates[k] - rates[k + 1] > tiny:
            k += 1
        k += 1
        if k - first > 1:
            struck, mean = True, sum(rates[first:k]) / (k - first)
            for j in range(first, k):
                rates[j] = (1.0 + restitution) * mean - restitution * rates[j]
    return struck


def unite(rates: list[float], length: int, pools: Pools) -> None:
    """Collisions without restitution: the nearest rates that do not approach; as `collide`."""
    if any(rates[k] > rates[k + 1] for k in range(length - 1)):
        pool(pools, rates, None, length, 0.0)
        expand(pools, rates)


def strike(moment: float, angles: Sequence[float], changes: Sequence[float]) -> complex:
    """Impulse on the rotor when rates change at once, rotor frame [N s].

    Args:
        moment: m R of a weight [kg m].
        angles, changes: of the weights and of their rates [rad, rad/s].
    """
    rate = sum(dv * cmath.rect(1.0, x) for x, dv in zip(angles, changes, strict=True))
    return -1j * moment * rate


def restitution_on(
    restitution: float, mass: float, carrier: float, alpha: float, kappa: float = 1.0
) -> float:
    """Coefficient to be used with the rotor held, so that a pair on a free rotor has `restitution`.

    The rotor gives way to the strike and drives the two apart: the pair leaves at e = e' + (1 + e')
    2 x/(1 - 2 x) times the speed of approach, x = m sin^2(alpha)/(kappa M).  With e' the energy of
    rotor and pair falls by what e takes, and never rises; below e = 2 x/(1 - 2 x) there is no such
    e': 0.

    Args:
        mass, carrier: of a weight, and of the rotor with all weights as the plane feels it, M [kg].
    """
    give = 2.0 * mass * math.sin(alpha) ** 2 / (kappa * carrier)
    return max(0.0, restitution - give * (1.0 + restitution))


def _shrunk(drive: float, limit: float) -> float:
    """Least of (y - g)^2/2 + f |y|."""
    return max(drive - limit, 0.0) + min(drive + limit, 0.0)
