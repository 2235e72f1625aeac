"""Rows of three and more weights that collide at once, whose last impacts no run resolves.

A row that comes together bounces in ever smaller and faster impacts.  Impacts whose gaps are below
1e-11 rad are taken as one, bounces below 1e-9 rad are not followed, and that decides which gap of
the row opens first.  Other tolerances and neighbouring starts repeat the decision.  Runs in one
piece that follow more of it, and less, show it (`two_tolerances`).
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..scene import Scene
from .recorder import Signal

# of the motion: 14 such rows over one revolution differ from an integration in one piece by at most
# 1e-5 (validity.md), but for one of restitution 0.02
UNRESOLVED = 1e-5
_CLOSED = 1e-7  # rad: gaps that are smaller take part in one row of impacts


def can_cascade(scene: Scene) -> bool:
    """Whether three weights of a track can bounce off each other."""
    return any(
        m.half_angle > 0.0 and len(m.angles) >= 3 and m.restitution > 0.0
        for m in scene.assembly().weights
    )


def has_cascade(scene: Scene, signals: Mapping[str, Signal]) -> bool:
    """Whether three neighbours come together that were apart before.

    Args:
        signals: with the angles of all weights, (T,) each.
    """
    from ...models.linear.room import Gaps  # few scenes have such weights
    from ...models.linear.weight_table import WeightTable

    table = WeightTable.of(scene.assembly())
    angles = []
    for mounted in scene.assembly().weights:
        names = [f"{mounted.name}.weight[{k}].angle" for k in range(1, len(mounted.angles) + 1)]
        angles += [signals[name] for name in names]
    path = np.array(angles).T
    for rows, sines in table.tracks:
        gaps = Gaps.of([(rows, sines)], table.angle)
        if len(gaps.offset) < 3:
            continue
        closed = path @ gaps.matrix.T + gaps.offset < _CLOSED
        pairs = closed & np.roll(closed, -1, axis=1)
        if (pairs[1:] & ~pairs[:-1]).any():
            return True
    return False
