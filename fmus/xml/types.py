"""Units of measurement and type definitions of the model descriptions."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple
from xml.etree.ElementTree import Element, SubElement

from ...models.constants import NOMINAL_ANGULAR_VELOCITY, NOMINAL_DISPLACEMENT, NOMINAL_VELOCITY
from ..variables import Variable

# exponents of kg, m, s, rad
SI_UNITS: dict[str, dict[str, int]] = {
    "1": {},
    "kg": {"kg": 1},
    "m": {"m": 1},
    "s": {"s": 1},
    "rad": {"rad": 1},
    "kg.m": {"kg": 1, "m": 1},
    "kg.m2": {"kg": 1, "m": 2},
    "kg/m3": {"kg": 1, "m": -3},
    "1/kg": {"kg": -1},
    "1/s": {"s": -1},
    "m2/s": {"m": 2, "s": -1},
    "rad/s": {"rad": 1, "s": -1},
    **{f"rad/s{k}": {"rad": 1, "s": -k} for k in range(2, 6)},
    "m/N": {"kg": -1, "s": 2},
    "N.m2": {"kg": 1, "m": 3, "s": -2},
    "N/m": {"kg": 1, "s": -2},
    "N/m3": {"kg": 1, "m": -2, "s": -2},
    "N.s/m": {"kg": 1, "s": -1},
    **{f"m/s{k if k > 1 else ''}": {"m": 1, "s": -k} for k in range(1, 8)},
    "N": {"kg": 1, "m": 1, "s": -2},
    **{f"N/s{k if k > 1 else ''}": {"kg": 1, "m": 1, "s": -2 - k} for k in range(1, 6)},
    "N.m": {"kg": 1, "m": 2, "s": -2},
    **{f"N.m/s{k if k > 1 else ''}": {"kg": 1, "m": 2, "s": -2 - k} for k in range(1, 4)},
    "W": {"kg": 1, "m": 2, "s": -3},
}

# unit -> display unit, and how many of it make one
DISPLAY_UNITS = {
    "m": ("mm", 1e3),
    "rad": ("deg", 180.0 / math.pi),
    "rad/s": ("rpm", 30.0 / math.pi),
}


class Type(NamedTuple):
    """What is measured: its unit, and the magnitude that is usual (FMI's nominal)."""

    unit: str
    nominal: float


# magnitudes of a machine of some kilograms at some hundred radians per second; the first type of a
# unit is that of variables which do not say more
TYPES = {
    "Ratio": Type("1", 1.0),
    "Mass": Type("kg", 1.0),
    "Length": Type("m", 0.1),
    "Displacement": Type("m", NOMINAL_DISPLACEMENT),
    "Time": Type("s", 1.0),
    "Angle": Type("rad", 1.0),
    "StaticMoment": Type("kg.m", 1e-3),
    "MomentOfInertia": Type("kg.m2", 0.1),
    "Density": Type("kg/m3", 1e3),
    "DecayRate": Type("1/s", 1.0),
    "KinematicViscosity": Type("m2/s", 1e-6),
    "Mobility": Type("1/kg", 1.0),
    "AngularVelocity": Type("rad/s", NOMINAL_ANGULAR_VELOCITY),
    "AngularAcceleration": Type("rad/s2", 1e2),
    "AngularJerk": Type("rad/s3", 1e4),
    "AngularAccelerationDerivative2": Type("rad/s4", 1e6),
    "AngularAccelerationDerivative3": Type("rad/s5", 1e8),
    "Compliance": Type("m/N", 1e-6),
    "BendingStiffness": Type("N.m2", 1e3),
    "TranslationalSpringConstant": Type("N/m", 1e5),
    "CubicStiffness": Type("N/m3", 1e9),
    "TranslationalDampingConstant": Type("N.s/m", 1e2),
    "Velocity": Type("m/s", NOMINAL_VELOCITY),
    "Acceleration": Type("m/s2", 1.0),
    "Jerk": Type("m/s3", 1e2),
    "AccelerationDerivative2": Type("m/s4", 1e4),
    "AccelerationDerivative3": Type("m/s5", 1e6),
    "AccelerationDerivative4": Type("m/s6", 1e8),
    "AccelerationDerivative5": Type("m/s7", 1e10),
    "Force": Type("N", 1.0),
    "ForceDerivative": Type("N/s", 1e2),
    "ForceDerivative2": Type("N/s2", 1e4),
    "ForceDerivative3": Type("N/s3", 1e6),
    "ForceDerivative4": Type("N/s4", 1e8),
    "ForceDerivative5": Type("N/s5", 1e10),
    "Torque": Type("N.m", 1.0),
    "TorqueDerivative": Type("N.m/s", 1e2),
    "TorqueDerivative2": Type("N.m/s2", 1e4),
    "TorqueDerivative3": Type("N.m/s3", 1e6),
    "Power": Type("W", 1e2),
}
_OF_UNIT = {kind.unit: name for name, kind in reversed(TYPES.items())}


def type_name(variable: Variable) -> str:
    """Name of a Real's type definition."""
    return variable.quantity or _OF_UNIT[variable.unit]


def type_names(variables: Iterable[Variable]) -> list[str]:
    """Type definitions that Reals need."""
    return sorted({type_name(v) for v in variables})


def bounds(variable: Variable) -> dict[str, str]:
    """`min` and `max`, both of them allowed values; a bound that is not allowed is left out."""
    found = {}
    if variable.minimum is not None and not variable.above:
        found["min"] = repr(variable.minimum)
    if variable.maximum is not None:
        found["max"] = repr(variable.maximum)
    return found


def described(variable: Variable) -> str:
    """Description of a variable, with the bound that `bounds` leaves out."""
    if not variable.above:
        return variable.description
    unit = "" if variable.unit == "1" else f" {variable.unit}"
    return f"{variable.description} (above {variable.minimum:g}{unit})"


def unit_definitions(root: Element, types: list[str]) -> None:
    """UnitDefinitions, the same in both versions of FMI."""
    definitions = SubElement(root, "UnitDefinitions")
    for name in sorted({TYPES[kind].unit for kind in types}):
        unit = SubElement(definitions, "Unit", {"name": name})
        SubElement(unit, "BaseUnit", {k: str(v) for k, v in SI_UNITS[name].items()})
        if name in DISPLAY_UNITS:
            display, factor = DISPLAY_UNITS[name]
            SubElement(unit, "DisplayUnit", {"name": display, "factor": repr(factor)})


def type_attributes(name: str) -> dict[str, str]:
    """What a type definition says, in both versions of FMI."""
    kind = TYPES[name]
    attributes = {"quantity": name, "unit": kind.unit, "nominal": repr(kind.nominal)}
    if kind.unit in DISPLAY_UNITS:
        attributes["displayUnit"] = DISPLAY_UNITS[kind.unit][0]
    return attributes
