"""Bearings over the speed in balls: between two rows of a table K(w) = steady + w slope.

The speeds of the rows are the doubles that a scene holds.  Where the speeds that were written
differ from them by rounding, the lines differ by less than the radius that is added here.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np
from flint import arb

from ..rotor import LinearRotor
from ..supports import OUTSIDE, SpeedTable
from .slopes import Exact

_ROUNDED = arb(2) ** -48  # relative: what a conversion of units rounds in a dozen operations
Lines = tuple[Exact, Exact]  # steady and slope, (2, 2) each


def row_speeds(rotor: LinearRotor) -> list[float]:
    """Speeds [rad/s] of the rows of all tables, ascending: between two of them all are lines."""
    found: list[float] = rotor.tables[0].tolist()
    return found


def piece_around(rotor: LinearRotor, speed: float) -> tuple[float, float]:
    """The speeds [rad/s] between which every table is one line, `speed` among them."""
    speeds = row_speeds(rotor)
    if not speeds:
        return 0.0, np.inf
    slack = OUTSIDE * speeds[-1]
    at = min(max(bisect_right(speeds, speed), 1), len(speeds) - 1)
    low, high = speeds[at - 1], speeds[at]
    return low - slack * (at == 1), high + slack * (at == len(speeds) - 1)


def on_line(rotor: LinearRotor, speed: float) -> tuple[LinearRotor, LinearRotor]:
    """A rotor whose tables are their lines at a speed, without what grows with the speed, and a
    rotor of nothing but that, for 1 rad/s."""
    steady, slopes = [], []
    for support in rotor.supports:
        if support.table is None:
            steady.append(support)
            continue
        stiffness, damping = _lines(support.table, speed)
        steady.append(support.with_matrices(stiffness[0], damping[0]))
        slopes.append(support.with_matrices(stiffness[1], damping[1]))
    nothing = np.zeros_like(rotor.elastic)
    growing = replace(
        rotor, supports=tuple(slopes), elastic=nothing, internal_damping=nothing,
        gyroscopic=nothing, waves=(),
    )  # fmt: skip
    return replace(rotor, supports=tuple(steady)), growing


def _lines(table: SpeedTable, speed: float) -> Iterator[Lines]:
    """Of stiffness and damping."""
    speeds = [float(w) for w in table.speeds]
    at = min(max(bisect_right(speeds, speed), 1), table.last + 1) - 1
    for values in (table.stiffness, table.damping):
        rows = [_balls_of(row) for row in values]
        slopes = [
            (rows[k + 1] - rows[k]) / (arb(high) - arb(low))
            for k, (low, high) in enumerate(pairwise(speeds))
        ]
        near = slopes[max(0, at - 1) : at + 2]
        steepest = np.array([_largest([one[k] for one in near]) for k in np.ndindex(2, 2)], object)
        radius = steepest.reshape(2, 2) * (arb(speeds[-1]) * _ROUNDED)
        yield rows[at] - slopes[at] * arb(speeds[at]) + radius * arb(0, 1), slopes[at]


def _balls_of(row: Exact) -> Exact:
    """Numbers that were rounded as they were converted to SI units."""
    found = np.empty((2, 2), object)
    for at, value in np.ndenumerate(row):
        found[at] = arb(float(value)) * (1 + arb(0, 1) * _ROUNDED)
    return found


def _largest(values: list[arb]) -> arb:
    bound = arb(0)
    for value in values:
        bound = bound.max(abs(value).upper())
    return bound
