"""The rotor of a scene's table in ball arithmetic, without rounding.

The formulas are those of `LinearRotor`, which take such numbers; its LAPACK for the shaft rounds,
and is replaced.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from typing import Any, cast

import numpy as np
from flint import arb

from ..bodies import Body, Foot, with_bodies
from ..rotor import LinearRotor
from ..rubber import Zener, foot_numbers, with_rubber, with_turning_rubber, zener
from ..supports import Support
from .arrays import Unproved, balls, solve
from .slopes import Exact, Number, largest

_NO_ARGUMENTS = (  # of a constructor of `LinearRotor`, or used apart from it
    "kind", "fmu", "friction", "damping_ratio", "unbalance", "unbalance_angle", "unbalances",
    "skews", "bodies", "on", "zone_limits", "support_loss_factor", "loss_frequency",
    "cubic_stiffness", "cubic", "stops", "shaft_loss_factor", "shaft_loss_frequency",
)  # fmt: skip


def rotor_of_table(table: Mapping[str, Any], places: Sequence[Any]) -> LinearRotor:
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
