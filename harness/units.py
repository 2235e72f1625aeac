"""Units of measurement: text such as "1200 rpm" as a number in SI units, and SI as engineers read.

Angles have a dimension of their own here, so that rpm and Hz are speeds, and 1/s is none.
"""

from __future__ import annotations

import math
import re
from contextlib import suppress
from contextvars import ContextVar
from decimal import ROUND_CEILING, ROUND_FLOOR, Context
from functools import cache
from typing import Any, NamedTuple

from ..models.readable import rounded
from .errors import UserError

_WITH_UNIT = (
    r"\s*(?P<number>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*"
    r"(?![eE][-+]?\d)(?P<unit>[A-Za-zµμ°%(][\w °%µμ·./*^()²³-]*?)\s*"
)
_HYPHEN = r"(?<=[A-Za-z])-(?=[A-Za-z])"  # g-mm and oz-in are products
_GRADE = r"\s*G\s*\d+(?:\.\d+)?\s*"  # of ISO 21940-11
_SPAN = r"\s*\d+(?:\.\d+)?\s*\w*\s*(?:-|:|\.\.|,)\s*\d+(?:\.\d+)?\s*\w*\s*"
_NUMBER = r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?"
_IN_WORDS = (
    rf"(?<![\w.])(?P<numbers>(?:{_NUMBER}(?:, | to | and ))*{_NUMBER}) "
    r"(?P<unit>rad/s|rad|kg m|m)(?![\w/^])"
)
_DEFINITIONS = f"""
giga- = 1e9 = G-; mega- = 1e6 = M-; kilo- = 1e3 = k-; deci- = 0.1 = d-; centi- = 1e-2 = c-
milli- = 1e-3 = m-; micro- = 1e-6 = µ- = μ- = u-; nano- = 1e-9 = n-
meter = [length] = m; second = [time] = s; gram = [mass] = g; radian = [angle] = rad
degree = {math.pi / 180.0!r} * radian = deg = °; turn = {math.tau!r} * radian = rev = revolution
minute = 60 * second = min; hour = 3600 * second = h; percent = 0.01 = %
rpm = turn / minute; hertz = turn / second = Hz
newton = kilogram * meter / second**2 = N; pascal = newton / meter**2 = Pa
inch = 0.0254 * meter = in; pound = 0.45359237 * kilogram = lb; ounce = pound / 16 = oz
mil = 0.001 * inch = thou; foot = 12 * inch = ft; micron = 1e-6 * meter
ips = inch / second; pound_force = 9.80665 * pound * meter / second**2 = lbf
"""


RPM = math.pi / 30.0  # rad/s
LARGEST = 1e60  # in SI units: products of five such numbers still fit into a double
SMALLEST = 1.0 / LARGEST  # of a number above 0: quotients fit as well
WIDEST = 4.0 * math.pi  # rad: an angle beyond two turns is in degrees


class Quantity(NamedTuple):
    """What is measured in an SI unit, with two examples, and the unit that engineers read.

    Attributes:
        engineering: unit, and how many of it are one SI unit.
    """

    name: str
    examples: tuple[str, str]
    engineering: tuple[str, float] | None = None


QUANTITIES = {
    "": Quantity("a ratio", ("5 %", "0.1 %")),
    "kg": Quantity("a mass", ("50 g", "0.05 kg")),
    "m": Quantity("a length", ("200 mm", "0.2 m"), ("mm", 1e3)),
    "s": Quantity("a time", ("3 s", "200 ms")),
    "rad": Quantity("an angle", ("120 deg", "2.094 rad"), ("deg", 180.0 / math.pi)),
    "rad/s": Quantity("a speed", ("1200 rpm", "125.7 rad/s"), ("rpm", 30.0 / math.pi)),
    "1/s": Quantity("a rate of decay", ("0.5 s^-1", "30 min^-1")),
    "m^2/s": Quantity("a kinematic viscosity", ("1 mm^2/s", "1e-6 m^2/s")),
    "m/s": Quantity("a velocity", ("2 mm/s", "0.002 m/s"), ("mm/s", 1e3)),
    "m/s^2": Quantity("an acceleration", ("9.81 m/s^2", "9810 mm/s^2")),
    "kg m": Quantity("an unbalance", ("300 g mm", "3e-4 kg m"), ("g mm", 1e6)),
    "kg m^2": Quantity("a moment of inertia", ("500 g m^2", "0.5 kg m^2")),
    "kg/m^3": Quantity("a density", ("7.8 g/cm^3", "7800 kg/m^3")),
    "N": Quantity("a force", ("5 N", "0.2 kN")),
    "N m": Quantity("a torque", ("5 N m", "800 N mm")),
    "N/m": Quantity("a stiffness", ("20 kN/m", "20 N/mm")),
    "N/m^3": Quantity("a cubic stiffness", ("5e9 N/m^3", "5 N/mm^3")),
    "N s/m": Quantity("a damping or drag", ("80 N s/m", "0.08 N s/mm")),
    "Pa s": Quantity("a viscosity", ("0.03 Pa s", "30 mPa s")),
    "N m^2": Quantity("a bending stiffness", ("80 N m^2", "8e7 N mm^2")),
    "m/N": Quantity("a compliance", ("2 mm/kN", "2e-6 m/N")),
}
engineering: ContextVar[bool] = ContextVar("engineering", default=False)  # shown instead of SI


@cache
def _registry() -> Any:
    from pint import UnitRegistry  # nearly half a second: only where text has a unit

    registry: Any = UnitRegistry(None)
    for definition in re.split(r"[;\n]", _DEFINITIONS.strip()):
        registry.define(definition.strip())
    return registry


def to_si(text: str, symbol: str) -> float:
    """A number with its unit in the SI unit of this symbol.

    Raises:
        ValueError: it is no number with a unit, or one of another quantity.
    """
    match = re.fullmatch(_WITH_UNIT, text)
    if match is None:
        raise ValueError(_expected(symbol) + _hint(text, symbol))
    from pint import DimensionalityError

    units = _registry()
    try:
        given = units.parse_units(re.sub(_HYPHEN, "*", match["unit"]))
    except Exception as error:  # of pint, of Python's tokenizer, or a failed assertion of it
        hint = _hint(text, symbol)
        raise ValueError(f"unknown unit {match['unit']!r}: {_expected(symbol)}{hint}") from error
    try:
        return float(units.Quantity(float(match["number"]), given).to(symbol).magnitude)
    except DimensionalityError as error:
        raise ValueError(_expected(symbol) + _hint(text, symbol)) from error


def _expected(symbol: str) -> str:
    """What fits, such as 'a speed is expected, such as "1200 rpm" or "125.7 rad/s"'."""
    quantity = QUANTITIES[symbol]
    first, second = quantity.examples
    alone = f"a number in {symbol}" if symbol else "a number"
    return f'{quantity.name} is expected, such as "{first}" or "{second}", or {alone}'


def _hint(text: str, symbol: str) -> str:
    """How to state what was probably meant; empty where that is not known."""
    if symbol == "kg m" and re.fullmatch(_GRADE, text):
        speed = "a grade is no unbalance: that of G6.3 is 6.3e-3 m/s * mass / speed"
        return f"; {speed}, such as 0.0063 * 8 kg / 150 rad/s = 3.4e-4 kg m"
    if symbol == "N s/m" and text.strip().endswith("%"):
        return "; of a damping ratio it is 2 * ratio * sqrt(stiffness * mass)"
    if symbol == "rad/s" and re.fullmatch(_SPAN, text):
        return "; two speeds are written apart: 100rpm 2000rpm"
    return ""


def has_unit(text: str) -> bool:
    """Whether it looks like a number with a unit."""
    return re.fullmatch(_WITH_UNIT, text) is not None


def si_number(value: float | str, symbol: str, what: str) -> float:
    """A number in SI units: as it is, written as text, or with a unit.

    Args:
        what: the value is, for messages.

    Raises:
        UserError: as `to_si`.
    """
    with suppress(ValueError, TypeError):
        if not isinstance(value, bool):
            return float(value)
    try:
        return to_si(str(value), symbol)
    except ValueError as error:
        raise UserError(f"{what} {value}: {error}") from error


def shown_in(symbol: str, name: str = "") -> tuple[str, float]:
    """Unit in which an SI unit is shown, and the factor to it: itself unless engineers' are.

    Args:
        name: of what is shown; a frequency is in Hz, a speed in rpm.
    """
    readable = QUANTITIES[symbol].engineering if symbol in QUANTITIES else None
    if readable is None or not engineering.get():
        return symbol, 1.0
    return ("Hz", 1.0 / math.tau) if readable[0] == "rpm" and "frequency" in name else readable


def scaled(text: str, factor: float) -> str:
    """Text with every number in it multiplied."""
    if factor == 1.0:
        return text
    return re.sub(_NUMBER, lambda match: f"{float(match[0]) * factor:.6g}", text)


def in_words(text: str) -> str:
    """A line with its numbers in the units that are shown."""

    def converted(match: re.Match[str]) -> str:
        unit, factor = shown_in(match["unit"])
        return f"{scaled(match['numbers'], factor)} {unit}"

    return re.sub(_IN_WORDS, converted, text) if engineering.get() else text


def in_both(value: float, symbol: str) -> str:
    """A value in SI and engineers' units, such as '125.7 rad/s = 1200 rpm', or in the latter."""
    readable = engineers(value, symbol)
    return readable if engineering.get() else f"{value:.4g} {symbol} = {readable}"


def engineers(value: float, symbol: str, digits: int = 4) -> str:
    """A value in engineers' units, such as '1200 rpm'."""
    unit, factor = QUANTITIES[symbol].engineering or (symbol, 1.0)
    return f"{rounded(value * factor, digits)} {unit}"


def rounded_outwards(low: float, high: float, digits: int = 10) -> tuple[str, str]:
    """The ends of an interval with so many digits: the lower one rounded down, the upper one up."""
    down, up = (Context(prec=digits, rounding=way) for way in (ROUND_FLOOR, ROUND_CEILING))
    return f"{down.create_decimal(low):f}", f"{up.create_decimal(high):f}"
