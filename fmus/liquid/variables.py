"""Variables of the liquid balancer."""

from __future__ import annotations

from ..unit import Sizes, Unit
from ..variables import (
    Variable,
    output,
    parameter,
    plain_input,
    positive,
    signal_inputs,
    signal_outputs,
)

_LIQUID = ("chamber_radius", "height", "density")


def variables(sizes: Sizes) -> list[Variable]:
    """Parameters, the chamber's acceleration, the force on the rotor."""
    a = [f"a_{axis}" for axis in sizes.axes]
    force = [f"F_{axis}" for axis in sizes.axes]
    begins = (*_LIQUID, "inertia_as_force")
    place = "Displacement of the chamber's centre, for the clearance"
    return [
        positive("chamber_radius", 0.05, "m", "Radius r1 of the chamber"),
        positive("float_radius", 0.04, "m", "Float radius r2, below r1"),
        positive("height", 0.02, "m", "Height h of the chamber"),
        positive("density", 1000.0, "kg/m3", "Density of the liquid"),
        parameter("inertia_as_force", False, "", "True: r m2 acts in F and added_mass is zero"),
        *signal_inputs(a, "acceleration", "Acceleration of the chamber's centre"),
        plain_input("x", 0.0, "m", place, quantity="Displacement"),
        plain_input("y", 0.0, "m", place, quantity="Displacement"),
        *signal_outputs(
            force, "force", "Force on the rotor", [(name,) for name in a],
            [(f"der({name})",) for name in a],
            begins=begins, kind="fixed",
        ),
        output("added_mass", "kg", "Mass r m2 to be carried by the rotor", begins=begins),
        output("liquid_mass", "kg", "Mass m2 of the liquid", begins=(*_LIQUID, "float_radius")),
        output(
            "clearance",
            "m",
            "Gap r1 - r2 minus bending; the model is valid while it is positive",
            depends=("x", "y"),
            begins=("chamber_radius", "float_radius"),
            quantity="Displacement",
        ),
    ]  # fmt: skip


LIQUID = Unit(
    name="LiquidBalancer",
    summary="Chamber, float and liquid: the acceleration of the chamber's centre in, force out.",
    sizes=Sizes,
    variables=variables,
)
