"""Sizes of a rotor, and the parameters that several kinds of rotor have."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from .variables import Variable, parameter

SHAFTS = ("uniform", "compliance")
Values = Mapping[str, float]


@dataclass(frozen=True)
class Sizes:
    """What is fixed when a rotor is built.

    Attributes:
        stations, planes, unbalances: numbers of them.
        shaft: of a flexible rotor: "uniform" (bending stiffness) or "compliance" (a matrix).
    """

    stations: int = 1
    planes: int = 1
    unbalances: int = 1
    shaft: str = SHAFTS[0]


def supports(stiffness: float, damping: float) -> list[Variable]:
    return [
        v
        for s in (1, 2)
        for v in (
            *(
                parameter(
                    f"support[{s}].stiffness_{axis}", stiffness, "N/m", f"Along {axis}",
                    minimum=0.0, above=True,
                )
                for axis in "xy"
            ),
            *(
                parameter(
                    f"support[{s}].damping_{axis}", damping, "N.s/m", f"Along {axis}", minimum=0.0
                )
                for axis in "xy"
            ),
        )
    ]  # fmt: skip


def support_values(values: Values) -> tuple[list[list[float]], list[list[float]]]:
    stiffness, damping = (
        [[values[f"support[{s}].{what}_{axis}"] for axis in "xy"] for s in (1, 2)]
        for what in ("stiffness", "damping")
    )
    return stiffness, damping


def planes(places: list[float], where: str) -> list[Variable]:
    return [
        parameter(f"plane[{i}].position", place, "m", where) for i, place in enumerate(places, 1)
    ]


def plane_values(values: Values, sizes: Sizes) -> list[float]:
    return [values[f"plane[{i}].position"] for i in range(1, sizes.planes + 1)]


def unbalances(sizes: Sizes, place: float, where: str) -> list[Variable]:
    return [
        v
        for k in range(1, sizes.unbalances + 1)
        for v in (
            parameter(f"unbalance[{k}].position", place, "m", where),
            parameter(f"unbalance[{k}].amount", 2.0e-4 * (k == 1), "kg.m", "Static moment",
                      minimum=0.0),
            parameter(f"unbalance[{k}].angle", 0.0, "rad", "In the rotor"),
        )
    ]  # fmt: skip


def unbalance_values(values: Values, sizes: Sizes) -> list[tuple[float, float, float]]:
    return [
        (
            values[f"unbalance[{k}].position"],
            values[f"unbalance[{k}].amount"],
            values[f"unbalance[{k}].angle"],
        )
        for k in range(1, sizes.unbalances + 1)
    ]
