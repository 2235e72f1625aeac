"""Collisions of the weights of a track, and which contacts last after them.

Bounces do not go on for ever: one that would rise less than `LOWEST_BOUNCE` ends in contact, which
takes energy, never gives it.
"""

from __future__ import annotations

from .centre import Instant
from .contact import collide, expand, pool, strike, unite
from .groups import fill_drives
from .ring import WeightsInOrder, align, find_chains, gap
from .track import TOUCH

LOWEST_BOUNCE = 1e-9  # rad: less than what the surfaces of real weights yield in contact


def approaching(weights: WeightsInOrder) -> bool:
    """True when weights that touch have rates towards each other."""
    if not weights.track.solid or weights.track.full:
        return False
    rate, n = weights.angle_rate, weights.count
    for k in range(n):
        if rate[k] > rate[(k + 1) % n] and not weights.joined[k] and gap(weights, k) <= TOUCH:
            return True
    return False


def settle(weights: WeightsInOrder, now: Instant, closed: int = -1) -> complex:
    """Let all weights that touch collide, and set who stays in contact.

    Args:
        closed: weight whose gap to the next has just closed, whatever rounding says of it.

    Returns:
        Impulse on the rotor in the rotor frame [N s].
    """
    n, linked, chains = weights.count, weights.linked, weights.chains
    for k in range(n):
        linked[k] = k == closed or weights.joined[k] or gap(weights, k) <= TOUCH
    before = weights.angle_rate[:]
    find_chains(weights, linked)
    for i in range(chains.count):
        first, size = chains.first[i], chains.size[i]
        if size > 1:
            rates = [weights.angle_rate[(first + j) % n] for j in range(size)]
            collide(rates, size, weights.track.restitution, weights.pools)
            _capture(weights, first, rates, now)
    changes = [rate - old for rate, old in zip(weights.angle_rate, before, strict=True)]
    moment = weights.track.weights.moment
    blow = strike(moment, weights.angle, changes) if any(changes) else 0j
    align(weights)
    return blow


def _capture(weights: WeightsInOrder, first: int, rates: list[float], now: Instant) -> None:
    """Set rates and contacts of a chain; too low bounces are taken for contact."""
    n, size = weights.count, len(rates)
    accelerations = [0.0] * size
    for _ in range(size):
        for j in range(size):
            weights.angle_rate[(first + j) % n] = rates[j]
        for j in range(size - 1):
            weights.joined[(first + j) % n] = rates[j + 1] == rates[j]
        _fill_accelerations(weights, first, accelerations, now)
        low = _lowest_bounce(rates, accelerations)
        if low < 0:
            return
        _merge(weights, rates, low)


def _lowest_bounce(rates: list[float], accelerations: list[float]) -> int:
    """The first weight of a chain that bounces off the next too low; -1: none."""
    for j in range(len(rates) - 1):
        opening, closing = rates[j + 1] - rates[j], accelerations[j] - accelerations[j + 1]
        if opening > 0.0 and opening**2 <= 2.0 * closing * LOWEST_BOUNCE:
            return j
    return -1


def _fill_accelerations(
    weights: WeightsInOrder, first: int, accelerations: list[float], now: Instant
) -> None:
    """Accelerations of a chain's weights with the contacts that are set."""
    n, size, begin = weights.count, len(accelerations), 0
    for j in range(size):
        if j == size - 1 or not weights.joined[(first + j) % n]:
            length = j + 1 - begin
            fill_drives(weights, (first + begin) % n, length, now)
            pool(weights.pools, weights.drives, weights.limits, length, 0.0)
            expand(weights.pools, accelerations, begin)
            begin = j + 1


def _merge(weights: WeightsInOrder, rates: list[float], low: int) -> None:
    """Unite the weights `low` and `low` + 1 of a chain, with all that move alike."""
    first, last = low, low + 1
    while first > 0 and rates[first - 1] == rates[low]:
        first -= 1
    while last < len(rates) - 1 and rates[last + 1] == rates[low + 1]:
        last += 1
    mean = sum(rates[first : last + 1]) / (last + 1 - first)
    for j in range(first, last + 1):
        rates[j] = mean
    unite(rates, len(rates), weights.pools)
