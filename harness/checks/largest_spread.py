"""Settling from the positions of largest p: two packed groups face to face, with contact."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ...models.papers import capacity as theory
from ...models.papers.settling import settling_time, slow_root
from ...models.papers.touching import facing_measure
from ..design.scenes import drag_limit, sized, weights_of
from ..design.settling import SETTLED_UNBALANCE, Batch
from ..scene import Scene
from .goncharov import settled_runs, weights_with_slow_root
from .row import Row, Rows
from .slow_root import MOST, WIDTH

TIMES = 0.05  # of the predicted time: a change of 1e-3 of the capacity is not yet a small one
SPREAD_ROUNDING = 1e-12  # of p, a sum of a few cosines
SOURCE = "Goncharov 2017 (1), (10), (13)"
UNBALANCE_CHANGE = 1e-3  # of the unbalance, either way, in capacities
REVOLUTIONS = 500


def check_largest_spread(
    scene: Scene, most: int = MOST, revolutions: float = REVOLUTIONS
) -> Iterator[Row]:
    """The slower of both ways in which the unbalance changes a little, for every number."""
    rows = Rows(scene.name, "largest_spread")
    kind = weights_with_slow_root(scene).kind
    scene = scene.replace({"run.revolutions": revolutions})
    scenes = sized(scene, range(2, most + 1), 0.0, width=WIDTH[kind])
    work = [b for s in scenes.values() for b in _both_ways(s)]
    seconds = [run.seconds for run in settled_runs(work)]
    slower: dict[int, float] = {}
    for (count, one), *pair in zip(scenes.items(), seconds[::2], seconds[1::2], strict=True):
        fast, slower[count] = sorted(pair)
        yield _row(one, fast, slower[count], rows)
    claimed = theory.fastest_count(kind, scenes)
    best = min(slower, key=lambda count: slower[count])
    yield rows.statement(
        f"{kind}: fastest of all from the position of largest p, slower way",
        str(claimed),
        str(best),
        best == claimed,
        "Goncharov 2017, Fig. 7, which leaves contact out",
    )


def _row(scene: Scene, fast: float, slow: float, rows: Rows) -> Row:
    """The slower way against the slow root with contact; both in seconds."""
    balls, limit = weights_of(scene), drag_limit(scene)
    device, alpha = balls.device, balls.half_angle
    number, p = facing_measure(balls.count, alpha)
    free = settling_time(slow_root(device, theory.largest_alignment(balls.count, alpha), limit))
    name = f"{balls.count} {balls.kind} at the largest p, slower way"
    if p > 1.0 - SPREAD_ROUNDING:  # on one line, across which nothing drives them
        return rows.statement(
            f"{name}: slow direction",
            "never settles",
            "not settled" if math.isinf(slow) else f"settled in {slow:.3g} s",
            math.isinf(slow),
            f"{SOURCE}: {free:.3g} s without contact; the other way took {fast:.3g} s",
        )
    expected = settling_time(slow_root(device, p, limit, number), SETTLED_UNBALANCE)
    return rows.number(
        f"{name} [s] ({free:.3g} without contact)",
        expected,
        slow,
        TIMES,
        f"{SOURCE} with contact; the other way took {fast:.3g} s",
    )


def _both_ways(scene: Scene) -> list[Batch]:
    """Two packed groups at the unbalance that they balance, changed by a part of the capacity."""
    balls = weights_of(scene)
    alpha = balls.half_angle
    small = balls.count // 2
    large = balls.count - small
    unit = balls.mass * balls.track_radius
    held = unit * (theory.packed_sine(large, alpha) - theory.packed_sine(small, alpha))
    change = UNBALANCE_CHANGE * unit * theory.packed_sine(balls.count, alpha)
    angles = [math.pi + alpha * (2 * k - large + 1) for k in range(large)]
    angles += [alpha * (2 * k - small + 1) for k in range(small)]
    found = []
    for amount in (held + change, held - change):
        facing = 0.0 if amount >= 0.0 else math.pi
        turned = {"rotor.unbalance": abs(amount), "rotor.unbalance_angle": facing}
        found.append(Batch(scene.replace(turned), (tuple(angles),), change))
    return found
