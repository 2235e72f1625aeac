"""The rigid rotor on two supports as a unit's parameters: Polushkin 2016."""

from __future__ import annotations

from ..models.rotor import LinearRotor
from .rotor_parts import (
    Sizes,
    Values,
    plane_values,
    planes,
    support_values,
    supports,
    unbalance_values,
    unbalances,
)
from .variables import Variable, parameter


def two_support_variables(sizes: Sizes) -> list[Variable]:
    if sizes.stations != 2:
        raise ValueError(
            f"stations = {sizes.stations!r}: a rotor on two supports has exactly 2, its supports"
        )
    span = 0.8
    places = [span * i / (sizes.planes + 1) for i in range(1, sizes.planes + 1)]
    return [
        parameter("mass", 12.0, "kg", "Without weights or liquid", minimum=0.0, above=True),
        parameter("inertia", 0.7, "kg.m2", "Transverse, about the centre", minimum=0.0, above=True),
        parameter("polar_inertia", 0.1, "kg.m2", "About the axis of rotation", minimum=0.0),
        parameter("span", span, "m", "Between the supports", minimum=0.0, above=True),
        parameter("com", span / 2.0, "m", "Centre of mass from support 1"),
        *supports(2.0e5, 150.0),
        *planes(places, "From support 1"),
        *unbalances(sizes, places[0], "From support 1"),
    ]


def two_support(values: Values, sizes: Sizes) -> LinearRotor:
    stiffness, damping = support_values(values)
    return LinearRotor.two_support(
        mass=values["mass"],
        inertia=values["inertia"],
        polar_inertia=values["polar_inertia"],
        span=values["span"],
        com=values["com"],
        stiffness=stiffness,
        damping=damping,
        planes=plane_values(values, sizes),
        unbalances=unbalance_values(values, sizes),
    )
