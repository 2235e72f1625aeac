"""Matrices of the rotor in ball arithmetic, without rounding.

Arrays hold python-flint's `arb`, or `Sloped` where the machines of a set differ.  The formulas are
those of `LinearRotor`, which take such numbers; its LAPACK for the shaft rounds, and is replaced.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
from flint import arb, arb_mat

from ..arrays import Numbers
from ..bodies import Body, Foot, with_bodies
from ..constants import SAME_PLACE
from ..linear.small_motions import RotorParts
from ..rotor import LinearRotor
from ..rubber import Zener, foot_numbers, with_rubber, with_turning_rubber, zener
from ..supports import Support
from .lines import on_line
from .slopes import Exact, Number, Sloped, ball, largest

_NO_ARGUMENTS = (  # of a constructor of `LinearRotor`, or used apart from it
    "kind", "fmu", "friction", "damping_ratio", "unbalance", "unbalance_angle", "unbalances",
    "skews", "bodies", "on", "zone_limits", "support_loss_factor", "loss_frequency",
    "cubic_stiffness", "cubic", "stops", "shaft_loss_factor", "shaft_loss_frequency",
)  # fmt: skip


class Unproved(ValueError):
    """Nothing can be proved; the message says why."""


@dataclass(frozen=True, eq=False, kw_only=True)
class RotorBalls(RotorParts):
    """The matrices of a rotor, and where its unbalance is.

    Attributes:
        mass, planes: as in `LinearRotor`.
        places: (p,) of the planes [m].
        unbalances: (place [m], moment [kg m] along and across).
        rigid: the displacement at a place follows from those at two others.
    """

    mass: Numbers
    planes: Numbers
    places: tuple[Number, ...]
    unbalances: tuple[tuple[Number, Exact], ...]
    rigid: bool

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


@dataclass(frozen=True)
class RingBalls:
    """What `LinearRotor.with_ring` takes of a ring of liquid, every number a ball."""

    liquid_mass: Number
    hollow: Number
    wave_damping: Number
    viscosity: int = 0
    root_damping: int = 0

    @property
    def wave_inertia(self) -> Number:
        """As of `Ring`."""
        return self.liquid_mass * self.hollow


def rotor_balls(
    table: Mapping[str, Any],
    added: Sequence[tuple[int, Number]],
    rings: Sequence[tuple[int, RingBalls]] = (),
    speed: float = 0.0,
) -> RotorBalls:
    """The rotor of a scene's table, every number a ball, with `added` masses [kg] and rings of
    liquid at its planes.

    A bearing over the speed has a `SpeedTable` under the key `table`; the rotor has the lines of
    these tables at `speed` [rad/s].

    Raises:
        Unproved: it is not proved that there is such a rotor.
    """
    kind = table["kind"]
    if kind == "planar":
        places = [arb(0)]
        loads = [(places[0], table["unbalance"], table["unbalance_angle"])]
    else:
        places = table["stations"] if kind == "flexible" else table["planes"]
        loads = [(u["position"], u["amount"], u["angle"]) for u in table["unbalances"]]
    if table.get("skews"):
        raise Unproved("rotor.skews: no weights in planes undo the couple of a disc that is askew")
    rotor = _of_table(table, places)
    masses = balls([0] * rotor.plane_count)
    for plane, mass in added:
        masses[plane] += mass
    rotor = rotor.with_added_mass(masses)
    for plane, ring in rings:
        rotor = rotor.with_ring(cast(Any, ring), plane)
    by_speed = None
    if rotor.varies:
        rotor, growing = on_line(rotor, speed)
        by_speed = RotorParts(**_in_balls(RotorParts.of(growing)))
    return RotorBalls(
        **_in_balls(RotorParts.of(rotor)), by_speed=by_speed,
        mass=rotor.mass, planes=rotor.planes, places=tuple(places),
        unbalances=tuple((place, balls([size * angle.cos(), size * angle.sin()]))
                         for place, size, angle in loads),
        rigid=kind == "two_support",
    )  # fmt: skip


def _of_table(table: Mapping[str, Any], places: Sequence[Any]) -> LinearRotor:
    """The rotor of a table alone, with its bodies and rubber.

    Raises:
        Unproved: it is not proved that there is such a rotor.
    """
    kind = table["kind"]
    given = {key: value for key, value in table.items() if key not in _NO_ARGUMENTS}
    given["bearings"] = [
        (b["support"], b["table"]) if b["table"] is not None
        else (b["support"], b["stiffness"], b["damping"])
        for b in table["bearings"]
    ]  # fmt: skip
    if kind == "flexible":
        given |= {"elastic": _elastic, "solve": _solve, "larger": largest}
    try:
        rotor: LinearRotor = (
            _of_matrices(table) if kind == "matrices" else getattr(LinearRotor, kind)(**given)
        )
        if table["bodies"]:
            rotor = _with_bodies(rotor, table, places)
    except ValueError as error:
        raise Unproved(str(error)) from error
    if rubber := _rubber(table):
        rotor = with_rubber(rotor, rubber)
    if table.get("shaft_loss_factor"):
        one = zener(cast(Any, arb(1)), table["shaft_loss_factor"], table["shaft_loss_frequency"])
        count = len(places) + sum(bool(each) for each in table["transverse_inertias"])
        rotor = with_turning_rubber(rotor, count, one)
    return rotor


def _in_balls(parts: RotorParts) -> dict[str, Any]:
    """The fields of a rotor's parts, every number a ball."""
    names = (
        "stiffness", "half_stiffness", "damping", "half_damping", "internal", "gyroscopic",
        "centrifugal",
    )  # fmt: skip
    turning = parts.turning and tuple(map(balls, parts.turning))
    return {name: balls(getattr(parts, name)) for name in names} | {"turning": turning}


def _of_matrices(table: Mapping[str, Any]) -> LinearRotor:
    """A rotor by the matrices of its table."""
    mass = balls(table["mass_matrix"])
    n = len(mass)
    nothing = balls(np.zeros((n, n)))

    def square(key: str) -> Exact:
        return nothing if table[key] is None else balls(table[key])

    rows = np.eye(n) if table["plane_rows"] is None else table["plane_rows"]
    springs, dampers = (_axes(square(key), n) for key in ("stiffness_matrix", "damping_matrix"))
    given: dict[str, Any] = {
        "mass": mass, "elastic": nothing, "deflection": nothing[:1], "planes": balls(rows),
        "internal_damping": square("internal_damping_matrix"),
        "gyroscopic": square("gyroscopic_matrix"), "unbalance": np.zeros(n, complex),
    }  # fmt: skip
    held = Support(np.eye(n), springs, dampers, across=0)
    return LinearRotor(supports=(held,), **given)


def _axes(square: Exact, n: int) -> Exact:
    """(2, 2, n, n) by axes of a matrix (2n, 2n), or of one (n, n) along both."""
    if len(square) == n:
        found = balls(np.zeros((2, 2, n, n)))
        found[0, 0] = found[1, 1] = square
        return found
    return square.reshape(2, n, 2, n).transpose(0, 2, 1, 3)


def _with_bodies(
    rotor: LinearRotor, table: Mapping[str, Any], places: Sequence[Any]
) -> LinearRotor:
    """The rotor with the bodies of its table."""
    supports: list[Any]
    if table["kind"] == "planar":
        supports = [arb(0)]
    elif table["kind"] == "two_support":
        supports = [arb(0), table["span"]]
    else:
        supports = [places[k - 1] for k in table["supports"]]
    bodies = [
        Body(
            body["name"], body["mass"], body["transverse_inertia"], body["center"],
            tuple(Foot(f["position"], f["stiffness"], f["damping"]) for f in body["feet"]),
            body["on"], body["free"],
        )
        for body in table["bodies"]
    ]  # fmt: skip
    return with_bodies(rotor, supports, places, bodies, table["on"])


def _rubber(table: Mapping[str, Any]) -> dict[int, list[Zener]]:
    """For the number of each support or foot of rubber, its elements along x and y."""
    found = {}
    count = 1 if table["kind"] == "planar" else 2
    if table["support_loss_factor"]:
        springs = table["support_stiffness" if table["kind"] == "flexible" else "stiffness"]
        for number, spring in enumerate([springs] if count == 1 else springs):
            found[number] = _elements(spring, table["support_loss_factor"], table["loss_frequency"])
    bodies = table["bodies"]
    shapes = [(len(body["feet"]), body["free"] != "xy") for body in bodies]
    for body, numbers in zip(bodies, foot_numbers(count, shapes), strict=True):
        for foot, number in zip(body["feet"], numbers, strict=True):
            if foot["loss_factor"]:
                found[number] = _elements(
                    foot["stiffness"], foot["loss_factor"], foot["loss_frequency"]
                )
    return found


def _elements(spring: Sequence[Any], factor: Sequence[Any], frequency: Any) -> list[Zener]:
    """Of rubber along x and y; one object where both are alike, so that they are proved to be."""
    first = zener(spring[0], factor[0], frequency)
    if spring[0] is spring[1] and factor[0] is factor[1]:
        return [first, first]
    return [first, zener(spring[1], factor[1], frequency)]


def _solve(matrix: Exact, right: Exact) -> Exact:
    return solve(balls(matrix), balls(right))


def _elastic(delta: Exact, rows: Exact) -> tuple[Exact, Number]:
    """Stiffness of a shaft, and its largest compliance."""
    if not len(rows):
        return balls(np.zeros((rows.shape[1],) * 2)), arb(0)
    return rows.T @ solve(delta, rows), functools.reduce(largest, delta.diagonal())
