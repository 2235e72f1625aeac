"""Matrices of the rotor in ball arithmetic, without rounding.

Arrays hold python-flint's `arb`, or `Sloped` where the machines of a set differ.  Geometry comes
from `rotor_kinds` and `shaft`, whose functions take such arrays.  What these do with LAPACK, and
the sum of both axes' stiffness with the shaft's, stands here again: rounding would void the proof,
and in a difference of sums equal slopes do not cancel.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from flint import arb, arb_mat

from ..constants import SAME_PLACE
from ..rotor_kinds import line_rows
from ..shaft import beam_compliance, bending_rows
from .slopes import Exact, Number, Sloped, ball, largest


class Unproved(ValueError):
    """Nothing can be proved; the message says why."""


@dataclass(frozen=True, eq=False)
class RotorBalls:
    """As `LinearRotor`, with the mean of both axes and half their difference.

    Attributes:
        places: (p,) of the planes [m].
        unbalances: (place [m], moment [kg m] along and across).
        rigid: the displacement at a place follows from those at two others.
    """

    mass: Exact
    stiffness: Exact
    half_stiffness: Exact
    damping: Exact
    half_damping: Exact
    internal: Exact
    gyroscopic: Exact
    planes: Exact
    places: tuple[Number, ...]
    unbalances: tuple[tuple[Number, Exact], ...]
    rigid: bool = False

    def with_added_mass(self, plane: int, mass: Number) -> Exact:
        """The mass matrix with `mass` [kg] at a plane."""
        row = self.planes[plane]
        return self.mass + np.outer(row, row) * mass

    def at_planes(self, used: Sequence[int], loads: Sequence[tuple[Number, Exact]]) -> list[Exact]:
        """Moments at `used` planes that do what `loads` at their places do.

        Raises:
            Unproved: no moments there do.
        """
        total = [balls([0, 0]) for _ in used]
        span = max((ball(place).abs_upper() for place in self.places), default=arb(0))
        slack = arb(0) if self.rigid else span * SAME_PLACE
        for place, moment in loads:
            same = [
                k for k, p in enumerate(used)
                if self.places[p] is place or _at_most(ball(self.places[p] - place), slack)
            ]  # fmt: skip
            if same:
                total[same[0]] = total[same[0]] + moment
            elif self.rigid and len(used) == 2:
                first, second = (self.places[p] for p in used)
                share = (place - first) / (second - first)
                total[0] = total[0] + moment * (1 - share)
                total[1] = total[1] + moment * share
            elif not all(ball(part).is_zero() for part in moment):
                raise Unproved(
                    f"an unbalance at {float(ball(place)):g} m is not proved to be one in the "
                    "planes that carry weights: put it in such a plane, or weights in two planes"
                )
        return total


def _at_most(difference: arb, slack: arb) -> bool:
    return bool(abs(difference) <= slack + arb(2) ** -100)


def balls(values: Any) -> Exact:
    """An array of balls."""
    given = np.array(values, object)
    flat = [arb(x) if isinstance(x, (int, float)) else x for x in given.ravel()]
    out = np.empty(len(flat), object)
    out[:] = flat
    return out.reshape(given.shape)


def solve(matrix: Exact, right: Exact) -> Exact:
    """matrix^-1 right.

    Raises:
        Unproved: the matrix is not proved to be regular.
    """
    value = arb_mat([[ball(x) for x in row] for row in matrix])
    try:
        inverse = balls(value.inv().tolist())
    except ZeroDivisionError:
        raise Unproved("a mass or compliance matrix is not proved to be regular") from None
    found = inverse @ np.vectorize(ball, otypes=[object])(right)
    rest = inverse @ (right - matrix @ found)  # its slopes are those of the solution
    for at in np.ndindex(found.shape):
        if isinstance(rest[at], Sloped):
            found[at] = Sloped(found[at], rest[at].slopes)
    return found


def _axes(pairs: Sequence[Sequence[Number]]) -> tuple[Exact, Exact]:
    """Diagonal matrices: mean of x and y, and half their difference."""
    return _diagonal([(x + y) / 2 for x, y in pairs]), _diagonal([(x - y) / 2 for x, y in pairs])


def _diagonal(values: Sequence[Number]) -> Exact:
    result = balls(np.zeros((len(values), len(values))))
    for k, value in enumerate(values):
        result[k, k] = value
    return result


def _moments(unbalances: Sequence[Mapping[str, Any]]) -> tuple[tuple[Number, Exact], ...]:
    return tuple((u["position"], rotated(u["amount"], u["angle"])) for u in unbalances)


def rotated(length: Any, angle: Any) -> Exact:
    """length e^{i angle}, both parts."""
    return balls([length * angle.cos(), length * angle.sin()])


def planar(table: Mapping[str, Any]) -> RotorBalls:
    """A disc in one plane."""
    stiffness, half_stiffness = _axes([table["stiffness"]])
    damping, half_damping = _axes([table["damping"]])
    zero = arb(0)
    return RotorBalls(
        balls([[table["mass"]]]), stiffness, half_stiffness, damping, half_damping,
        balls([[table["internal_damping"]]]), balls([[0]]), balls([[1]]), (zero,),
        ((zero, rotated(table["unbalance"], table["unbalance_angle"])),),
    )  # fmt: skip


def two_support(table: Mapping[str, Any]) -> RotorBalls:
    """A rigid body on two supports."""
    span = table["span"]
    (centre,) = line_rows([span / 2 if table["com"] is None else table["com"]], span)
    tilt = balls([-1 / span, 1 / span])
    stiffness, half_stiffness = _axes(table["stiffness"])
    damping, half_damping = _axes(table["damping"])
    return RotorBalls(
        np.outer(centre, centre) * table["mass"] + np.outer(tilt, tilt) * table["inertia"],
        stiffness, half_stiffness, damping, half_damping, balls(np.zeros((2, 2))),
        np.outer(tilt, tilt) * table["polar_inertia"], balls(line_rows(table["planes"], span)),
        tuple(table["planes"]), _moments(table["unbalances"]), rigid=True,
    )  # fmt: skip


def flexible(table: Mapping[str, Any]) -> RotorBalls:
    """Discs on a massless shaft."""
    z, ends = table["stations"], tuple(s - 1 for s in table["supports"])
    zero = balls(np.zeros((len(z), len(z))))
    shaft, internal = zero, zero
    if len(z) > len(ends):
        rows = balls(bending_rows(z, ends))
        if table["compliance"] is not None:
            given = balls(table["compliance"])
            delta = (given + given.T) / 2
        else:
            delta = beam_compliance(z, ends, table["bending_stiffness"])
        shaft = rows.T @ solve(delta, rows)
        softest = functools.reduce(largest, delta.diagonal())
        internal = shaft * (table["internal_damping"] * softest)

    def at_supports(pairs: Sequence[Sequence[Number]]) -> tuple[Exact, Exact]:
        mean, half = _axes(pairs)
        both = zero.copy(), zero.copy()
        for matrix, small in zip(both, (mean, half), strict=True):
            for k, end in enumerate(ends):
                matrix[end, end] = small[k, k]
        return both

    stiffness, half_stiffness = at_supports(table["support_stiffness"])
    damping, half_damping = at_supports(table["support_damping"])
    return RotorBalls(
        _diagonal(table["masses"]), stiffness + shaft, half_stiffness, damping, half_damping,
        internal, zero, _diagonal([arb(1)] * len(z)), tuple(z), _moments(table["unbalances"]),
    )  # fmt: skip


KINDS = {"planar": planar, "two_support": two_support, "flexible": flexible}
