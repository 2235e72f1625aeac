"""What stands between a rotor and the ground: springs, dampers, dry friction, stops."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from .arrays import Numbers, numbers

SHAFT = "shaft"  # name of what is no support: rubber of the shaft, which turns with it
OUTSIDE = 1e-9  # of the highest speed of a table: rounding of the speed at its ends


@dataclass(frozen=True)
class Slider:
    """Dry friction along one axis: a slider, rigid or behind a spring (Jenkins 1962).

    Attributes:
        station, axis: from 0; axis 0 is x, 1 is y; a station of -1: it stands across `row`.
        limit: force at which it slips [N]; 0: there is none.
        stiffness: of the spring in series [N/m]; 0: none, the slider is rigid.
        free_stroke: way from one contact with that spring to the other, without force [m].
        row: (n,) displacement across it by that of the stations; of one at a station empty.
        support: number from 1 of the support, or foot behind them, that has it; 0: none.
    """

    station: int
    axis: int
    limit: float
    stiffness: float = 0.0
    free_stroke: float = 0.0
    row: tuple[float, ...] = ()
    support: int = 0

    @classmethod
    def across(
        cls,
        row: Numbers,
        axis: int,
        limit: float,
        stiffness: float = 0.0,
        free_stroke: float = 0.0,
        support: int = 0,
    ) -> Slider:
        """One whose displacement is `row` (n,) times that of the stations along its axis.

        A row of zeros is that of a body that does not move along the axis: no friction.

        Raises:
            ValueError: it is rigid, and more than one station moves it.
        """
        places = np.flatnonzero(row)
        alone = len(places) == 1 and float(row[places[0]]) == 1.0
        limit = limit if len(places) else 0.0
        if not alone and limit and not stiffness:
            raise ValueError(
                "a slider between bodies that move, or beside the plane of a support, requires a "
                "stiffness (N/m): it cannot be rigid"
            )
        if alone or not limit:
            at = int(places[0]) if alone else 0
            return cls(at, axis, limit, stiffness, free_stroke, support=support)
        values = tuple(float(value) for value in row)
        return cls(-1, axis, limit, stiffness, free_stroke, values, support)

    def shares(self, stations: int) -> Numbers:
        """(n,) displacement across it by that of the stations along its axis."""
        found = np.zeros(stations)
        if self.row:
            found[: len(self.row)] = self.row
        else:
            found[self.station] = 1.0
        return found


@dataclass(frozen=True, eq=False)
class CubicSpring:
    """A spring whose force is the cube of the displacement across it, beside a linear one.

    Attributes:
        rows: (2, n) displacement along x and along y from that of the stations.
        stiffness: k3 along x and y [N/m^3].
        radial: the force is k3 |d|^2 d with the first of them; else k3 x^3 and k3 y^3.
        limit: displacement up to which it is known [m]; 0: any.
        support: number from 1 of the support, or foot behind them, that has it; 0: none.
    """

    rows: Numbers
    stiffness: tuple[float, float]
    radial: bool = True
    limit: float = 0.0
    support: int = 0

    def force(self, displacement: Numbers) -> Numbers:
        """Force (2, ...) on the rotor at a displacement (2, ...) [N]."""
        d = np.asarray(displacement)
        square = (d * d).sum(axis=0) if self.radial else d * d
        k = (
            self.stiffness[0]
            if self.radial
            else np.reshape(self.stiffness, (2,) + (1,) * (d.ndim - 1))
        )
        return np.asarray(-k * square * d)

    def energy(self, displacement: Numbers) -> Numbers:
        """Energy (...,) that it holds at a displacement (2, ...) [J]."""
        d = np.asarray(displacement)
        if self.radial:
            return np.asarray(self.stiffness[0] / 4.0 * (d * d).sum(axis=0) ** 2)
        return np.asarray(np.tensordot(self.stiffness, d**4, 1) / 4.0)


@dataclass(frozen=True, eq=False)
class Stop:
    """An elastic stop with a damper: it pushes back beyond a gap, and never pulls.

    Attributes:
        rows: (2, n) displacement along x and along y from that of the stations; zeros along an axis
            that the stop does not limit: with both rows it is a ring.
        gap: g [m].
        stiffness, damping: [N/m, N s/m].
        support: as of `CubicSpring`.
    """

    rows: Numbers
    gap: float
    stiffness: float
    damping: float = 0.0
    support: int = 0

    def pressure(self, displacement: Numbers, velocity: Numbers) -> float:
        """ks (r - g) + cs r' of a displacement and a velocity (2,), whatever the sign [N]."""
        r = math.hypot(*displacement)
        rate = float(np.dot(displacement, velocity)) / r if r else 0.0
        return self.stiffness * (r - self.gap) + self.damping * rate

    def force(self, displacement: Numbers, velocity: Numbers) -> Numbers:
        """Force (2,) on the rotor [N]."""
        r = math.hypot(*displacement)
        pressure = max(0.0, self.pressure(displacement, velocity)) if r > self.gap else 0.0
        return np.asarray(-pressure * np.asarray(displacement) / (r or 1.0))


@dataclass(frozen=True, eq=False)
class SpeedTable:
    """Stiffness and damping of a bearing that change with the speed, on lines between rows.

    Attributes:
        speeds: (r,) ascending, two or more [rad/s].
        stiffness, damping: (r, 2, 2) of each row [N/m, N s/m].
    """

    speeds: Numbers
    stiffness: Numbers
    damping: Numbers

    def at(self, speed: float) -> tuple[Numbers, Numbers]:
        """Stiffness and damping (2, 2) at a speed [rad/s].

        Raises:
            ValueError: the table does not hold it.
        """
        low, high = float(self.speeds[0]), float(self.speeds[-1])
        slack = OUTSIDE * high
        if not low - slack <= speed <= high + slack:
            raise ValueError(
                f"bearing table: speed = {speed:.6g} rad/s: must be {low:.6g} to {high:.6g} rad/s, "
                "the speeds of the table; keep the speed within them, or give the table rows for "
                "this one"
            )
        row = int(np.clip(np.searchsorted(self.speeds, speed, side="right") - 1, 0, self.last))
        begin, end = float(self.speeds[row]), float(self.speeds[row + 1])
        part = (speed - begin) / (end - begin)
        first, second = (
            each[row] + part * (each[row + 1] - each[row])
            for each in (self.stiffness, self.damping)
        )
        return first, second

    @property
    def last(self) -> int:
        """Number of the last line, from 0."""
        return len(self.speeds) - 2


@dataclass(frozen=True, eq=False)
class Support:
    """A linear element: its force on the rotor is -rows^T (K d + C d'), d = rows q for each axis.

    A bearing has one row; rubber has a second one, of its inner displacement; an element that is
    known by its matrices alone has as many as stations.

    Attributes:
        rows: (s, n) displacement across it from that of the stations.
        stiffness, damping: (2, 2, s, s): force along x, y by displacement along x, y
            [N/m, N s/m].
        name: what outputs call it.
        table: what they are over the speed, of a bearing; None: the same at every speed.
        across: the first rows are the displacement across a bearing or foot: one for both axes, or
            two, of x and of y; 0: it is neither, and has no force of its own.
    """

    rows: Numbers
    stiffness: Numbers
    damping: Numbers
    name: str = ""
    table: SpeedTable | None = None
    across: int = 1

    def at(self, speed: float) -> Support:
        """The support at a speed [rad/s].

        Raises:
            ValueError: its table does not hold the speed.
        """
        return self if self.table is None else self.with_matrices(*self.table.at(speed))

    def with_matrices(self, stiffness: Numbers, damping: Numbers) -> Support:
        """The support with matrices (2, 2) in the place of its table."""
        k, c = (spread(each, self.across) for each in (stiffness, damping))
        return replace(self, stiffness=k, damping=c, table=None)

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


Bearing = tuple[int, Sequence[Sequence[float]], Sequence[Sequence[float]]] | tuple[int, SpeedTable]
"""Number of a support from 1, stiffness ((xx, xy), (yx, yy)) [N/m], damping alike [N s/m]; or
number and table over the speed."""


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
    for number, *values in bearings:
        row = rows[stations[number - 1]]
        if isinstance(values[0], SpeedTable):
            nothing = np.zeros((2, 2, 1, 1))
            found[number - 1] = Support(row[None], nothing, nothing, table=values[0])
        else:
            k, c = values
            found[number - 1] = Support.bearing(row, k, c)
    return tuple(found)


def two_ways(support: Support, x: Numbers, y: Numbers) -> Support:
    """A bearing or foot across which displacement is x (n,) along x and y (n,) along y."""
    if np.array_equal(x, y):
        return replace(support, rows=x[None])
    k, c = (spread(each[..., 0, 0], 2) for each in (support.stiffness, support.damping))
    return replace(support, rows=np.array([x, y]), stiffness=k, damping=c, across=2)


def spread(square: Numbers, across: int) -> Numbers:
    """(2, 2, across, across) of a bearing's (2, 2)."""
    if across == 1:
        return square.reshape(2, 2, 1, 1)
    pair = np.array([0, 1])
    found = np.zeros((2, 2, 2, 2), square.dtype)
    found[pair[:, None], pair, pair[:, None], pair] = square
    return found


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
