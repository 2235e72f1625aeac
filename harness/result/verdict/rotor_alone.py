"""Steady vibration of a rotor without balancers by runs, where no formula gives it."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from ...scene import Scene
from .ahead import MOST_PASSES, changed_until, kept
from .case import STEADY_SIZE
from .lasting import is_steady, part_sizes
from .passages import run_bare
from .stretches import Stretch

REACHED = 0.02  # of a vibration: that of a steady motion changes by less over half a run
SURELY = 1e-4  # of it: one that changes by less over half a run will not change in a longer one
LONGER, RUNS = 5.0, 4  # times the run before, and how many runs, until a rotor alone is steady
SHORTEST = 50.0  # revolutions of the first of them

_Plateau = tuple[float, float, tuple[float, ...]]


class RotorAlone:
    """The rotor of one scene without balancers.

    What it settles to on a plateau does not depend on how long that lasts.  It is kept, therefore,
    for the shorter plateaus of a search for the length after which the weights balance.

    Args:
        end: of the run [s].
    """

    def __init__(self, scene: Scene, end: float) -> None:
        self._scene, self._end = scene, end
        self._found: dict[_Plateau, tuple[float, float | None]] = {}

    def vibration(self, stretch: Stretch) -> float | None:
        """Steady vibration on a plateau [m], by runs that keep its speed for ever longer.

        None: it has settled in none of them, or they cannot be completed.
        """
        changes = tuple(
            one.time for one in self._scene.operation.unbalance_changes if one.time <= stretch.end
        )
        plateau = (stretch.begin, stretch.speed, changes)
        length, vibration = self._found.get(plateau, (0.0, None))
        if length < stretch.revolutions:
            vibration = self._by_runs(stretch)
            self._found[plateau] = stretch.revolutions, vibration
        return vibration

    def _by_runs(self, stretch: Stretch) -> float | None:
        scene = self._scene.without_balancers()
        if scene.operation.motor:  # it would take another speed without balancers
            steady = {"operation.motor": None, "operation.speed": abs(stretch.speed)}
            scene, begin, turned = scene.replace(steady), 0.0, 0.0
        else:
            scene, begin = kept(scene, stretch, self._end), stretch.begin
            turned = scene.profile().angle(begin) / math.tau
        scene = changed_until(scene, stretch.end)
        changes = [one.time for one in scene.operation.unbalance_changes]
        turned = max([turned, *(scene.profile().angle(time) / math.tau for time in changes)])
        parts: list[float] = []
        lengths = _lengths(stretch.revolutions)
        for further, following in pairwise([*lengths, math.inf]):
            found = run_bare(scene.replace({"run.revolutions": turned + further}))
            if found is None:
                return None
            time, motion, passes = found
            shown = time >= max([begin, *changes])
            parts = part_sizes(time[shown], motion[:, shown])
            if is_steady(parts, REACHED if further >= stretch.revolutions else SURELY):
                return float(np.median(parts[len(parts) // 2 :]))
            if passes * following / further > MOST_PASSES and further >= stretch.revolutions:
                break
        return float(np.median(parts)) if is_steady(parts, STEADY_SIZE) else None


def _lengths(revolutions: float) -> list[float]:
    """Revolutions of runs, each longer than the one before: short ones in which a rotor may settle
    soon, then from the plateau's on."""
    longest, short = max(SHORTEST, revolutions), SHORTEST
    found = []
    while short * LONGER <= longest:
        found.append(short)
        short *= LONGER
    return [*found, *(longest * LONGER**k for k in range(RUNS))]
