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
from itertools import pairwise
from typing import NamedTuple

_SWEEPS_PER_WEIGHT = 8  # a blow passes one contact a sweep; what still goes on has collapsed
_WEAKEST = 1e-4  # of the largest difference of rates: blows below it end without rebound
_NO_APPROACH = 1e-12  # the same with e = 1, where nothing dies out: rounding only


class Pool(NamedTuple):
    """Neighbours first..first + size - 1 of a chain that share one value."""

    first: int
    size: int
    drive: float
    limit: float
    value: float


def group_factor(count: int, alpha: float) -> float:
    """sin(n alpha)/(n sin alpha): mean drive of a packed group in units of one weight's."""
    if count == 1 or alpha == 0.0:
        return 1.0
    return math.sin(count * alpha) / (count * math.sin(alpha))


@lru_cache(maxsize=256)
def pressure_levers(count: int, alpha: float) -> tuple[complex, ...]:
    """Levers q_1..q_{n-1} of a packed group about its middle angle t.

    With every weight driven by Im(G a e^{-i theta}), the contact after weight j carries
    Im(G a e^{-i t} q_j) kappa m R [N] of pressure: what the first j have more than their share.
    """
    units = [cmath.rect(1.0, -(2 * k - count + 1) * alpha) for k in range(count)]
    mean = sum(units) / count
    levers, total = [], 0j
    for unit in units[:-1]:
        total += unit - mean
        levers.append(total)
    return tuple(levers)


def pools(drives: Sequence[float], limits: Sequence[float], slack: float) -> list[Pool]:
    """Accelerations of a chain of touching weights: Gauss's principle, above.

    Args:
        drives: (n,) free accelerations g along increasing angle [rad/s^2].
        limits: (n,) resistance f of weights at rest; 0 for moving ones, whose g has it already.
        slack: tension that is taken for rounding [rad/s^2].
    """
    done: list[Pool] = []
    for k, (drive, limit) in enumerate(zip(drives, limits, strict=True)):
        pool = Pool(k, 1, drive, limit, _shrunk(drive, limit))
        while done and done[-1].value >= pool.value - slack:
            last = done.pop()
            size = last.size + pool.size
            drive, limit = last.drive + pool.drive, last.limit + pool.limit
            pool = Pool(last.first, size, drive, limit, _shrunk(drive, limit) / size)
        done.append(pool)
    return done


def collide(rates: Sequence[float], restitution: float) -> list[float]:
    """Rates of a chain of touching weights after the collisions among them.

    Args:
        rates: (n,) along increasing angle [rad/s].
        restitution: e of a pair, 0 to 1.

    Returns:
        (n,) rates that do not decrease along the chain; same sum, sum of squares not larger.
    """
    v = list(rates)
    tiny = (_NO_APPROACH if restitution == 1.0 else _WEAKEST) * (max(v) - min(v))
    sweeps = _SWEEPS_PER_WEIGHT * len(v) if restitution > 0.0 else 0
    for _ in range(sweeps):
        runs = _approaching(v, tiny)
        if not runs:
            break
        for first, last in runs:
            mean = sum(v[first:last]) / (last - first)
            v[first:last] = [(1.0 + restitution) * mean - restitution * x for x in v[first:last]]
    return together(v)


def together(rates: Sequence[float]) -> list[float]:
    """Rates after collisions without restitution: the nearest ones that do not approach."""
    if all(a <= b for a, b in pairwise(rates)):
        return list(rates)
    v: list[float] = []
    for pool in pools(rates, [0.0] * len(rates), 0.0):
        v += [pool.value] * pool.size
    return v


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


def _approaching(v: Sequence[float], tiny: float) -> list[tuple[int, int]]:
    """Runs first..last - 1 of weights each of which approaches the next."""
    runs, k = [], 0
    while k < len(v) - 1:
        first = k
        while k < len(v) - 1 and v[k] - v[k + 1] > tiny:
            k += 1
        if k > first:
            runs.append((first, k + 1))
        else:
            k += 1
    return runs
