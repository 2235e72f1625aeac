"""The rule of signals' names, in one place, and what they are measured in."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from functools import cache

from ...fmus.rotor.variables import station

ANGLE = "angle in the rotor"  # of a weight
OF_STOPS = ("largest_force", "touches")  # what a run records of every stop
_AXIS = r"(^v?|_)(x|y|xi|eta)$"  # x, vx, a_x, F_xi: one part of a vector
_POWER = r"(?<=[a-z])(\d+)"


def is_count(signal: str) -> bool:
    """Whether a signal counts events: one more or less is no error of the motion."""
    return signal.endswith(".touches")


def stations(count: int) -> list[str]:
    """Prefixes of all stations."""
    return [station(number, count) for number in range(1, count + 1)]


def displacements(count: int) -> list[str]:
    """Signals of x and y of every station, station by station."""
    return [f"rotor.{prefix}{axis}" for prefix in stations(count) for axis in "xy"]


def along_axes(count: int) -> tuple[list[str], list[str]]:
    """Signals of x of every station, and those of y."""
    both = displacements(count)
    return both[::2], both[1::2]


def station_residuals(count: int) -> list[str]:
    """What many runs call the amplitudes of all stations in the last revolution."""
    return [f"rotor.{prefix}residual" for prefix in stations(count)]


def turning_parts(count: int) -> dict[str, tuple[str, int]]:
    """What many runs call the parts of displacements at the rotor's frequency: signal and part.

    x = in_phase cos theta - quadrature_lead sin theta + ..., with the rotor's angle theta.
    """
    return {
        f"rotor.{prefix}{axis}.{name}": (f"rotor.{prefix}{axis}", part)
        for prefix in stations(count)
        for axis in "xy"
        for part, name in enumerate(("in_phase", "quadrature_lead"))
    }


def of_angles(outputs: Iterable[str], what: str) -> dict[str, str]:
    """What many runs call what they make of weights' angles, such as `mean_angle`: angles by it."""
    angle = re.compile(r"^(.*\.weight\[\d+\]\.)angle$")
    return {f"{found[1]}{what}": name for name in outputs if (found := angle.match(name))}


def of_moments(outputs: Iterable[str]) -> dict[str, str]:
    """What many runs call the means of weights' moments, `mean_moment_xi`: moments by it."""
    moment = re.compile(r"^(.*\.)(moment_(?:xi|eta))$")
    return {f"{found[1]}mean_{found[2]}": name for name in outputs if (found := moment.match(name))}


def plane(number: int, what: str) -> str:
    """A variable of a rotor's plane, such as `plane[1].a`."""
    return f"plane[{number}].{what}"


def weight(number: int, what: str) -> str:
    """A variable of a balancer's weight, such as `weight[2].angle`."""
    return f"weight[{number}].{what}"


def components(name: str) -> list[str]:
    """The two variables of a coupling signal such as `plane[1].F`."""
    return [f"{name}_xi", f"{name}_eta"]


def signals(names: Sequence[str], order: int) -> list[str]:
    """Variables of coupling signals: all values, then all first derivatives, up to `order`.

    The units declare them in this order, so that they are exchanged as one slice.
    """
    values = [component for name in names for component in components(name)]
    orders = zip(*(derivatives(name, order) for name in values), strict=True)
    return [name for group in orders for name in group]


def derivatives(name: str, order: int) -> list[str]:
    """A variable and its derivatives up to `order`."""
    found = [name, f"der({name})", *(f"der({name},{k})" for k in range(2, order + 1))]
    return found[: order + 1]


def kin(name: str, names: Iterable[str]) -> list[str]:
    """Those of `names` that one scale measures: x and y of a place, both parts of a vector."""
    owner, _, what = name.rpartition(".")
    kind = re.sub(_AXIS, "", what)
    return [
        other
        for other in names
        if (parts := other.rpartition("."))[0] == owner and re.sub(_AXIS, "", parts[2]) == kind
    ]


def by_unit(names: Iterable[str]) -> dict[str, list[str]]:
    """Variables such as `station[1].x` by their unit, from signals such as `rotor.station[1].x`."""
    found: dict[str, list[str]] = {}
    for name in names:
        unit, _, variable = name.partition(".")
        found.setdefault(unit, []).append(variable)
    return found


@cache
def readable(unit: str) -> str:
    """A unit of measurement as people write it: `kg.m2/s2` is kg m^2/s^2."""
    return re.sub(_POWER, r"^\1", unit.replace(".", " "))


def quantity(name: str, unit: str) -> str:
    """What a signal in this unit is, for people; signals of one quantity are drawn together."""
    if unit == "m" and name.endswith((".x", ".y")):
        return "displacement"
    if ".weight[" in name and name.endswith(".angle"):
        return ANGLE
    last = name.rpartition(".")[2].removesuffix("_xi").removesuffix("_eta").replace("_", " ")
    return "unbalance of the balancers" if last == "moment" else last
