"""Stops and cubic springs of a rotor's supports, in a scene."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Literal

import numpy as np

from ...models.arrays import Numbers
from ...models.rotor import LinearRotor
from ...models.supports import CubicSpring, Support
from ...models.supports import Stop as ElasticStop
from .feeds import Start
from .nested import Nested
from .quantities import SI, NotNegative, Positive, RealPair, Table, Text, Whole, refusal

Cubic = Literal["radial", "axes"]


class Stop(Table):
    """An elastic stop across a support: it pushes back beyond a gap, and never pulls."""

    support: Whole | Text = 1
    """Number of the support, or the name of a body's foot, such as "tub.foot[1]"."""
    gap: Annotated[Positive, SI("m")]
    """Displacement from rest at which it is touched, to every side."""
    stiffness: Annotated[Positive, SI("N/m")]
    """Of the stop."""
    damping: Annotated[NotNegative, SI("N s/m")] = 0.0
    """Of the stop; it lets go where its force has fallen to zero."""
    kind: Literal["ring", "x", "y"] = "ring"
    """A ring around the shaft without friction, or a pair of stops along one axis."""

    @property
    def called(self) -> str:
        """What it is and where, such as "ring at support 1"."""
        what = "ring" if self.kind == "ring" else f"stop along {self.kind}"
        return f"{what} at {self.place}"

    @property
    def place(self) -> str:
        """The support or foot that has it."""
        return f"support {self.support}" if isinstance(self.support, int) else self.support

    def build(self, support: Support, number: int) -> ElasticStop:
        """The element across a support or foot of this number."""
        mask = {"ring": (1.0, 1.0), "x": (1.0, 0.0), "y": (0.0, 1.0)}[self.kind]
        rows = rows_across(support) * np.array(mask)[:, None]
        return ElasticStop(rows, self.gap, self.stiffness, self.damping, number)


def rows_across(support: Support) -> Numbers:
    """(2, n) rows of the displacement across a support along x and y."""
    return np.array([support.rows[0], support.rows[support.across - 1]])


Holding = dict[int | str, tuple[Support, int]]
"""Supports by number, feet and points by name, each with the number of its force, or 0."""


def find_support(places: Holding, which: int | str, key: str) -> tuple[Support, int]:
    """The support of this number, or the foot of this name, and the number of its force.

    Raises:
        PydanticCustomError: there is none, said of the key.
    """
    if which in places:
        return places[which]
    known = [f'"{name}"' if isinstance(name, str) else str(name) for name in places]
    raise refusal(key, f"must be {' or '.join(known)}: the rotor has no other support")


def build_cubic(
    support: Support, number: int, cubic: Sequence[float], kind: Cubic, key: str
) -> list[CubicSpring]:
    """The cubic spring across a support; one that softens is known up to where it pulls no more.

    Raises:
        PydanticCustomError: a radial spring has two stiffnesses, or a softening one no linear part.
    """
    x, y = cubic
    if kind == "radial" and x != y:
        words = 'must be one number of a radial spring; with cubic = "axes" it is one for each axis'
        raise refusal(key, words)
    if not (x or y):
        return []
    rows = rows_across(support)
    linear = [float(support.stiffness[a, a, (support.across - 1) * a, (support.across - 1) * a])
              for a in (0, 1)]  # fmt: skip
    if kind == "radial":
        return [CubicSpring(rows, (x, x), True, _limit(min(linear), x, key), number)]
    found = []
    for axis, k3 in enumerate(cubic):
        if k3:
            one = rows * np.eye(2)[axis][:, None]
            limit = _limit(linear[axis], k3, key)
            found.append(CubicSpring(one, (k3, k3), False, limit, number))
    return found


def _limit(linear: float, cubic: float, key: str) -> float:
    """Displacement at which a spring that softens pulls no more [m]; 0 of one that hardens."""
    if cubic >= 0.0:
        return 0.0
    if not linear > 0.0:
        raise refusal(key, "must not be below 0: the support has no stiffness that could soften")
    return math.sqrt(-linear / cubic)


def restraint_start(rotor: LinearRotor) -> Start:
    """Parameters of the unit: cubic springs and stops of a rotor."""
    found: Start = {}
    for k, spring in enumerate(rotor.cubics, start=1):
        found |= {
            f"cubic[{k}].stiffness_{axis}": v
            for axis, v in zip("xy", spring.stiffness, strict=True)
        }
        found |= {f"cubic[{k}].axes": float(not spring.radial), f"cubic[{k}].limit": spring.limit}
        found[f"cubic[{k}].support"] = float(spring.support)
        found |= _rows("cubic_row", k, spring.rows)
    for k, stop in enumerate(rotor.stops, start=1):
        for name in ("gap", "stiffness", "damping", "support"):
            found[f"stop[{k}].{name}"] = float(getattr(stop, name))
        found |= _rows("stop_row", k, stop.rows)
    return found


def _rows(name: str, k: int, rows: Numbers) -> Start:
    return {
        f"{name}_{axis}[{k},{j}]": float(value)
        for axis, row in zip("xy", rows, strict=True)
        for j, value in enumerate(row, start=1)
    }


CubicOfPlanar = Annotated[RealPair | None, SI("N/m^3")]
CubicOfSupports = Annotated[tuple[RealPair, RealPair] | None, SI("N/m^3")]
Stops = tuple[Nested[Stop], ...]
