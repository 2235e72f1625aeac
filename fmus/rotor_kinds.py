"""Kinds of rotor: which parameters each has, and how they make a `LinearRotor`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from ..models.rotor import LinearRotor
from .rotor_flexible import flexible, flexible_variables
from .rotor_parts import Sizes, Values
from .rotor_two_support import two_support, two_support_variables
from .variables import Variable, parameter


@dataclass(frozen=True)
class Kind:
    """A kind of rotor.

    Attributes:
        variables: its own parameters; raises ValueError when it does not exist in that size.
        rotor: the rotor that values of these parameters describe.
        gyroscopic: whether it has gyroscopic coupling of the axes.
    """

    variables: Callable[[Sizes], list[Variable]]
    rotor: Callable[[Values, Sizes], LinearRotor]
    gyroscopic: bool = False


def _planar_variables(sizes: Sizes) -> list[Variable]:
    if sizes.stations != 1:
        raise ValueError(f"stations = {sizes.stations!r}: a planar rotor has exactly 1")
    return [
        parameter("mass", 2.0, "kg", "Disc without weights or liquid", minimum=0.0, above=True),
        parameter("stiffness_x", 8.0e4, "N/m", "Of the supports, along x", minimum=0.0),
        parameter("stiffness_y", 8.0e4, "N/m", "Of the supports, along y", minimum=0.0),
        parameter("damping_x", 40.0, "N.s/m", "Of the supports, along x", minimum=0.0),
        parameter("damping_y", 40.0, "N.s/m", "Of the supports, along y", minimum=0.0),
        parameter("internal_damping", 0.0, "N.s/m", "Of the turning shaft", minimum=0.0),
        parameter("unbalance", 2.0e-4, "kg.m", "Static moment", minimum=0.0),
        parameter("unbalance_angle", 0.0, "rad", "Of the unbalance, in the rotor"),
    ]


def _planar(values: Values, sizes: Sizes) -> LinearRotor:
    rotor = LinearRotor.planar(
        values["mass"],
        (values["stiffness_x"], values["stiffness_y"]),
        (values["damping_x"], values["damping_y"]),
        values["internal_damping"],
        values["unbalance"],
        values["unbalance_angle"],
    )
    # several planes are several ports at the one disc
    return replace(rotor, planes=np.ones((sizes.planes, 1)))


KINDS: dict[str, Kind] = {
    "planar": Kind(_planar_variables, _planar),
    "two_support": Kind(two_support_variables, two_support, gyroscopic=True),
    "flexible": Kind(flexible_variables, flexible),
}
