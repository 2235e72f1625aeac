"""In which order units step, so that as few signals as possible are assumed; and their loops.

A signal to a unit that steps before its source is assumed over the step and answered at its end.
The fewest such signals are a minimum feedback arc set: of up to `MOST_TRIED` units every order is
tried, of more one is made by the rule of Eades, Lin & Smyth 1993 (sources first, sinks last, then
whatever sends the most beyond what it receives).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import permutations

MOST_TRIED = 7  # 5040 orders
Edge = tuple[str, str, bool]  # from unit, to unit, whether the signal depends on inputs directly


def order_of(units: Sequence[str], edges: Iterable[Edge]) -> list[str]:
    """The units in an order with the fewest assumed signals.

    Among those of equally many the one wins that assumes the fewest which depend directly on
    inputs, and then the one next to the given order.
    """
    weights: dict[tuple[str, str], tuple[int, int]] = {}
    for source, target, direct in edges:
        if source != target:
            count, directs = weights.get((source, target), (0, 0))
            weights[source, target] = count + 1, directs + direct
    if len(units) > MOST_TRIED:
        return _by_rule(units, weights)

    def cost(order: Iterable[str]) -> tuple[int, int]:
        place = {unit: k for k, unit in enumerate(order)}
        back = [w for (source, target), w in weights.items() if place[source] > place[target]]
        return sum(w[0] for w in back), sum(w[1] for w in back)

    return list(min(permutations(units), key=cost))  # the first of equals


def _by_rule(units: Sequence[str], weights: Mapping[tuple[str, str], tuple[int, int]]) -> list[str]:
    left, first, last = list(units), [], []  # type: list[str], list[str], list[str]
    while left:
        sends = {
            u: sum(w[0] for (s, t), w in weights.items() if s == u and t in left) for u in left
        }
        takes = {
            u: sum(w[0] for (s, t), w in weights.items() if t == u and s in left) for u in left
        }
        if sinks := [u for u in left if not sends[u] and takes[u]]:
            last.insert(0, sinks[-1])
            left.remove(sinks[-1])
            continue
        sources = [u for u in left if not takes[u]]
        chosen = sources[0] if sources else max(left, key=lambda u: sends[u] - takes[u])
        first.append(chosen)
        left.remove(chosen)
    return first + last


def loops_of(feeds: Mapping[str, Iterable[str]]) -> list[list[str]]:
    """Loops among signals, each the names of those that feed each other at one instant.

    Args:
        feeds: by signal, the signals that depend on it directly.
    """
    import numpy as np
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import connected_components

    names = list(feeds)
    if not names:
        return []
    place = {name: k for k, name in enumerate(names)}
    pairs = [(place[a], place[b]) for a, others in feeds.items() for b in others]
    rows, columns = np.array(pairs, int).reshape(-1, 2).T
    graph = csr_matrix((np.ones(len(pairs)), (rows, columns)), (len(names), len(names)))
    _, label = connected_components(graph, directed=True, connection="strong")
    groups = [[n for n, own in zip(names, label, strict=True) if own == k] for k in set(label)]
    return [group for group in groups if len(group) > 1 or group[0] in feeds[group[0]]]
