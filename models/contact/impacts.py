"""Collisions of the weights of a ring, and which contacts last after them.

Bounces do not go on for ever: one that would rise less than `LOWEST_BOUNCE` ends in contact, which
takes energy, never gives it.
"""

from __future__ import annotations

from collections.abc import Sequence

from .contact import collide, pools, strike, together
from .ring import TOUCH, Instant, Ring

LOWEST_BOUNCE = 1e-9  # rad: less than what the surfaces of real weights yield in contact


def approaching(ring: Ring) -> bool:
    """True when weights that touch have rates towards each other."""
    if not ring.solid or ring.full:
        return False
    v, count = ring.v, ring.count
    for k in range(count):
        if v[k] > v[(k + 1) % count] and not ring.joined[k] and ring.gap(k) <= TOUCH:
            return True
    return False


def settle(ring: Ring, now: Instant, spin_up: float, closed: int = -1) -> complex:
    """Let all weights that touch collide, and set who stays in contact.

    Args:
        closed: weight whose gap to the next has just closed, whatever rounding says of it.

    Returns:
        Impulse on the rotor in the rotor frame [N s].
    """
    touching = [ring.joined[k] or ring.gap(k) <= TOUCH for k in range(ring.count)]
    if closed >= 0:
        touching[closed] = True
    before = ring.v[:]
    for chain in ring.chains(touching):
        if len(chain) > 1:
            rates = collide([ring.v[k] for k in chain], ring.track.restitution)
            _capture(ring, chain, rates, now, spin_up)
    changes = [v - old for v, old in zip(ring.v, before, strict=True)]
    blow = strike(ring.moment, ring.x, changes) if any(changes) else 0j
    ring.align()
    return blow


def _capture(
    ring: Ring, chain: Sequence[int], rates: list[float], now: Instant, spin_up: float
) -> None:
    """Set rates and contacts of a chain; too low bounces are taken for contact."""
    inner = chain[:-1]
    for _ in chain:
        for k, rate in zip(chain, rates, strict=True):
            ring.v[k] = rate
        for j, k in enumerate(inner):
            ring.joined[k] = rates[j + 1] == rates[j]
        bends = _bends(ring, chain, now, spin_up)
        low = None
        for j in range(len(inner)):
            opening, closing = rates[j + 1] - rates[j], bends[j] - bends[j + 1]
            if opening > 0.0 and opening**2 <= 2.0 * closing * LOWEST_BOUNCE:
                low = j
                break
        if low is None:
            return
        rates = _merged(rates, low)


def _bends(ring: Ring, chain: Sequence[int], now: Instant, spin_up: float) -> list[float]:
    """Accelerations of a chain's weights with the contacts that are set."""
    bends: list[float] = []
    part: list[int] = []
    for k in chain:
        part.append(k)
        if k == chain[-1] or not ring.joined[k]:
            for pool in pools(*ring.drives(part, now, spin_up), 0.0):
                bends += [pool.value] * pool.size
            part = []
    return bends


def _merged(rates: list[float], low: int) -> list[float]:
    """Rates after the weights `low` and `low` + 1 of a chain, with all that move alike, unite."""
    first, last = low, low + 1
    while first > 0 and rates[first - 1] == rates[low]:
        first -= 1
    while last < len(rates) - 1 and rates[last + 1] == rates[low + 1]:
        last += 1
    mean = sum(rates[first : last + 1]) / (last + 1 - first)
    united = rates[:]
    united[first : last + 1] = [mean] * (last + 1 - first)
    return together(united)
