"""What stands between a rotor and the ground: springs and dampers, dry friction."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from .arrays import Numbers, numbers


@dataclass(frozen=True)
class Slider:
    """Dry friction at a station along one axis: a slider, rigid or behind a spring (Jenkins 1962).

    Attributes:
        station, axis: from 0; axis 0 is x, 1 is y.
        limit: force at which it slips [N]; 0: there is none.
        stiffness: of the spring in series [N/m]; 0: none, the slider is rigid.
    """

    station: int
    axis: int
    limit: float
    stiffness: float = 0.0


@dataclass(frozen=True, eq=False)
class Support:
    """A linear element: its force on the rotor is -rows^T (K d + C d'), d = rows q for each axis.

    A bearing has one row; an element that is known by its matrices alone has as many as stations.

    Attributes:
        rows: (s, n) displacement across it from that of the stations.
        stiffness, damping: (2, 2, s, s): force along x, y by displacement along x, y
            [N/m, N s/m].
        name: what outputs call it.
    """

    rows: Numbers
    stiffness: Numbers
    damping: Numbers
    name: str = ""

    @classmethod
    def bearing(
        cls,
        row: Numbers,
        stiffness: Sequence[Sequence[float]],
        damping: Sequence[Sequence[float]],
        name: str = "",
    ) -> Support:
        """One with a row (n,), and stiffness and damping ((xx, xy), (yx, yy))."""
        k, c = (numbers(each).reshape(2, 2, 1, 1) for each in (stiffness, damping))
        return cls(row[None], k, c, name)

    @classmethod
    def straight(
        cls, row: Numbers, stiffness: Sequence[float], damping: Sequence[float], name: str = ""
    ) -> Support:
        """One with a row (n,) and stiffness and damping (x, y), without cross terms."""
        k, c = (diagonal_pair(each) for each in (stiffness, damping))
        return cls.bearing(row, k, c, name)

    def at_stations(self, block: Numbers) -> Numbers:
        """`stiffness` or `damping` as (2, 2, n, n) matrices of the stations."""
        return self.rows.T @ block @ self.rows


Bearing = tuple[int, Sequence[Sequence[float]], Sequence[Sequence[float]]]
"""Number of a support from 1, stiffness ((xx, xy), (yx, yy)) [N/m], damping alike [N s/m]."""


def supported(
    stations: Sequence[int],
    count: int,
    stiffness: Iterable[Sequence[float]],
    damping: Iterable[Sequence[float]],
    bearings: Sequence[Bearing] = (),
) -> tuple[Support, ...]:
    """Supports at stations (from 0) of `count`, each with stiffness and damping (x, y).

    Bearings take the place of springs and dampers of their support.
    """
    rows = np.eye(count)
    found = [
        Support.straight(rows[at], k, c)
        for at, k, c in zip(stations, stiffness, damping, strict=True)
    ]
    for number, k, c in bearings:
        found[number - 1] = Support.bearing(rows[stations[number - 1]], k, c)
    return tuple(found)


def diagonal_pair(values: Sequence[float]) -> list[list[float]]:
    """((x, 0), (0, y))."""
    x, y = values
    return [[x, 0.0], [0.0, y]]


def summed(supports: Sequence[Support], what: str, stations: int) -> Numbers:
    """`stiffness` or `damping` of all supports, (2, 2, n, n)."""
    total: Numbers = np.zeros((2, 2, stations, stations))
    for support in supports:
        total = total + support.at_stations(getattr(support, what))
    return total
