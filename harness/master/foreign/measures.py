"""Units of measurement of two variables compared: a factor between them, or why there is none."""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING, Any

from ..names import readable

if TYPE_CHECKING:
    from fmpy.model_description import BaseUnit, ModelDescription, ModelVariable


_EXPONENTS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
_POWER = re.compile(r"(?<=[A-Za-z])(-?\d+)")
Measure = tuple[tuple[int, ...], float, float]  # exponents, factor and offset to SI


class Incompatible(ValueError):
    """Two variables measure different things."""


def measured(variable: ModelVariable) -> str:
    """Name of a variable's unit of measurement; empty where none is declared."""
    declared = variable.unit or getattr(variable.declaredType, "unit", None)
    return declared or ""


def measured_in(description: ModelDescription) -> dict[str, str]:
    """Unit of measurement of every variable, for people; empty where none is declared."""
    return {v.name: readable(measured(v)) for v in description.modelVariables}


def measures(description: ModelDescription) -> dict[str, BaseUnit]:
    """Units of measurement that an FMU defines by base units."""
    return {one.name: one.baseUnit for one in description.unitDefinitions if one.baseUnit}


def conversion(source: str, target: str, defined: tuple[Any, Any]) -> float:
    """What a value in one unit of measurement is multiplied by to be one in another.

    Args:
        source, target: their names; empty: not declared, taken to be the other's.
        defined: base units of both, where their FMUs define them.

    Raises:
        Incompatible: the dimensions differ, or the zeros do.
    """
    if not source or not target or source == target:
        return 1.0
    one, other = (_measure(n, d) for n, d in zip((source, target), defined, strict=True))
    if one is None or other is None:
        unknown = source if one is None else target
        raise Incompatible(f"the unit of measurement {unknown!r} is not known")
    if one[0] != other[0]:
        raise Incompatible(f"{source} and {target} are of different dimensions")
    if one[2] != other[2]:
        raise Incompatible(f"{source} and {target} differ in their zero")
    return one[1] / other[1]


def _measure(name: str, defined: BaseUnit | None) -> Measure | None:
    if defined is not None:
        # an angle is a ratio in SI, and tools declare rad or leave it out
        exponents = tuple(int(getattr(defined, key)) for key in _EXPONENTS[:-1])
        return exponents, float(defined.factor), float(defined.offset)
    return _by_pint(name)


@cache
def _by_pint(name: str) -> Measure | None:
    registry = _registry()
    text = _POWER.sub(r"**\1", name.replace(".", "*").replace("^", ""))
    try:
        quantity = registry.Quantity(1.0, registry.parse_units(text)).to_base_units()
        dimensions = {k.strip("[]"): v for k, v in quantity.dimensionality.items()}
        zero = registry.Quantity(0.0, registry.parse_units(text)).to_base_units().magnitude
    except Exception:  # of pint, of Python's tokenizer, or a failed assertion of it
        return None
    names = ("mass", "length", "time", "current", "temperature", "substance", "luminosity")
    if set(dimensions) - set(names):
        return None
    exponents = tuple(int(dimensions.get(key, 0)) for key in names)
    return exponents, float(quantity.magnitude - zero), float(zero)


@cache
def _registry() -> Any:
    from pint import UnitRegistry  # nearly half a second: only where names must be understood

    return UnitRegistry(autoconvert_offset_to_baseunit=True)
