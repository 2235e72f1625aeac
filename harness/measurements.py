"""Tables of measurements: columns by name, their units in the heads or the cells.

A head is a name, with its unit behind it in brackets or after an underscore, and with the plane
that it belongs to in brackets without a space: `speed [rpm]`, `amplitude [mil pp]`, `amplitude_um`,
`mass[a] [oz]`, `mass_oz[a]`.  A cell can have a unit of its own: `3.53 oz`.  All tables that a user
writes are read here, by one rule.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from pathlib import Path

import numpy as np

from ..models.arrays import Array
from .errors import UserError
from .input_files import CsvRow, read_csv
from .units import LARGEST, SMALLEST, WIDEST, to_si

NOTES = ("note", "comment")  # columns for people
_HEAD = re.compile(r"(?P<body>.*?\S)\s+[\[(](?P<unit>[^\[\]]*?)[\])]|(?P<alone>.*)")
_PLANE = re.compile(r"(?P<name>[^\[]*)\[(?P<plane>[^\]]+)\]")
_CELL = re.compile(
    r"(?P<number>[-+]?[\d.,]+(?:[eE][-+]?\d+)?)\s*(?![eE][-+]?\d)(?P<unit>[A-Za-zµμ°%].*)"
)
# how the size of a vibration is counted, and what makes it half its swing
_SIZES = {
    **dict.fromkeys(("pp", "p-p", "pk-pk", "pkpk", "peak-to-peak", "peak-peak"), 0.5),
    **dict.fromkeys(("0-peak", "0-pk", "0-p", "zero-peak", "pk", "peak"), 1.0),
    "rms": math.sqrt(2.0),
}


@dataclass(frozen=True)
class Known:
    """A column that a table can have.

    Attributes:
        name: as it is documented.
        units: SI units of what it can measure, such as ("m", "m/s"); none where it is text.
        needs_unit: a number without a unit is refused instead of taken as SI.
        per_plane: the head can name a plane.
        is_size: of a vibration: its unit can say pp, rms or 0-peak.
        others: names that mean the same.
        refused: why a table cannot have it, and what to write instead.
    """

    name: str
    units: tuple[str, ...] = ()
    needs_unit: bool = True
    per_plane: bool = False
    is_size: bool = False
    others: tuple[str, ...] = ()
    refused: str = ""


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Attributes:
        head: as in the file.
        known: what it is.
        plane: that it belongs to; empty where it names none.
        unit: of its numbers, as in the file; empty where the head has none.
        symbol: the SI unit; empty where the unit is not known, and numbers stay as they are.
        factor: to SI, and of a vibration to half its swing.
    """

    head: str
    known: Known
    plane: str = ""
    unit: str = ""
    symbol: str = ""
    factor: float = 1.0


@dataclass(frozen=True)
class Measurements:
    """A table of measurements.

    Attributes:
        path: of the file.
        columns: those for people left out.
        rows: its lines.
    """

    path: Path
    columns: tuple[Column, ...]
    rows: list[CsvRow]

    def column(self, name: str, plane: str = "") -> Column | None:
        """The column of a name and plane, or None."""
        both = (name, plane)
        return next((c for c in self.columns if (c.known.name, c.plane) == both), None)

    @property
    def planes(self) -> tuple[str, ...]:
        """Names of planes, in the order of the heads; one without a name is an empty text."""
        return tuple(dict.fromkeys(c.plane for c in self.columns if c.known.per_plane))

    def texts(self, column: Column) -> list[str]:
        """The cells of a column."""
        return [row.cells[column.head] for row in self.rows]

    def numbers(self, column: Column) -> Array:
        """(rows,) of a column in its SI unit, NaN where the cell is empty.

        Raises:
            UserError: a cell is no finite number, its unit is of another quantity, or it has none
                where one is needed.
        """
        found, told = [], column.symbol or column.unit
        for row in self.rows:
            value, symbol = self._number(row, column)
            if symbol and told and symbol != told:
                raise UserError(
                    f"{row.place}: {column.head} = {row.cells[column.head]!r}: must be in {told}, "
                    "or a unit of the same quantity, as the rest of its column"
                )
            told = told or symbol
            found.append(value)
        return np.array(found)

    def all_numbers(self, column: Column) -> Array:
        """The same of a column without empty cells.

        Raises:
            UserError: as `numbers`, or a cell is empty.
        """
        values = self.numbers(column)
        for row, value in zip(self.rows, values, strict=True):
            if math.isnan(value):
                raise UserError(f"{row.place}: {column.head}: must be a number; the cell is empty")
        return values

    def with_unit_of_a_cell(self, column: Column) -> Column:
        """A column whose head has no unit, with that of its first cell that has one."""
        for text in filter(None, self.texts(column)):
            if match := _CELL.fullmatch(text):
                symbol, factor = unit_in_si(match["unit"], column.known)
                unit = match["unit"].strip()
                return replace(column, unit=unit, symbol=symbol, factor=factor)
        return column

    def _number(self, row: CsvRow, column: Column) -> tuple[float, str]:
        """A cell in SI units, and the SI unit that it states; empty where it states none."""
        text, symbol = row.cells[column.head], ""
        if not text:
            return math.nan, ""
        match = _CELL.fullmatch(text)
        if match is None or not any(map(str.isdigit, match["number"])):
            value = column.factor * row.number(column.head)
            if column.known.needs_unit and not (column.unit or _is_raw(column)):
                head = column.head
                raise UserError(
                    f"{row.place}: {head} = {text!r}: has no unit: needs one `{head}_UNIT` or "
                    f"`{head} [UNIT]`, such as `{head} [{_example(column.known)}]`, or a unit in "
                    "every cell"
                )
        else:
            number = CsvRow(row.place, {column.head: match["number"]}, row.has_decimal_commas)
            try:
                symbol, factor = unit_in_si(match["unit"], column.known)
            except ValueError as error:
                raise UserError(f"{row.place}: {column.head} = {text!r}: {error}") from None
            value = factor * number.number(column.head)
        if not math.isfinite(value):
            raise UserError(f"{row.place}: {column.head} = {text}: must be a finite number")
        if value and not SMALLEST <= abs(value) <= LARGEST:
            raise UserError(
                f"{row.place}: {column.head} = {text}: must be 0, or from {SMALLEST:g} to "
                f"{LARGEST:g} in magnitude"
            )
        if _is_in_degrees(column, value):
            raise UserError(
                f"{row.place}: {column.head} = {text}: more than two turns; is it in degrees? "
                f"then name the column `{column.known.name} [deg]`"
            )
        return value, symbol


def _is_in_degrees(column: Column, value: float) -> bool:
    """Whether a number of a column in rad is so large that it was probably measured in degrees."""
    return column.symbol == "rad" and column.factor == 1.0 and abs(value) > WIDEST


def _is_raw(column: Column) -> bool:
    return not column.symbol and bool(column.unit)


def _example(known: Known) -> str:
    return {"m": "um", "rad": "deg", "rad/s": "rpm", "kg": "g", "s": "s"}.get(
        known.units[0], known.units[0]
    )


def unit_in_si(text: str, known: Known) -> tuple[str, float]:
    """SI unit of a unit, and the factor to it; of a vibration to half its swing.

    Raises:
        ValueError: it is not a unit of what the column measures.
    """
    given = text = text.strip()
    size = 1.0
    if known.is_size:
        words = text.replace("_", " ").split()
        size = math.prod(_SIZES.get(word.lower(), 1.0) for word in words)
        text = " ".join(word for word in words if word.lower() not in _SIZES)
        if len(words) - len(text.split()) > 1:
            raise ValueError(f"unit {given!r}: must have one of pp, rms and 0-peak at most")
    if not text:
        raise ValueError(f"unknown unit {given!r}: write the unit of length or speed before it")
    problem = ValueError(f"unknown unit {text!r}")
    for symbol in known.units:
        try:
            return symbol, size * to_si(f"1 {text}", symbol)
        except ValueError as error:
            problem = error if symbol == known.units[0] else problem
    raise problem


def read_measurements(
    path: Path,
    known: Sequence[Known],
    other: Callable[[str], Known] | None = None,
    *,
    takes_any_unit: Sequence[str] = (),
) -> Measurements:
    """Read a table in any form that `read_csv` takes.

    Args:
        known: columns that it can have.
        other: says what any other name is, such as a path of a scene, or raises UserError.
        takes_any_unit: names of columns whose unit need not be known, such as amplitudes in mV.

    Raises:
        UserError: the file cannot be read, a column is not known or given twice, or its unit is not
            one of what it measures.
    """
    heads, rows = read_csv(path)
    columns: list[Column] = []
    for head in heads:
        if head.lower() in NOTES or head.startswith("#"):
            continue
        try:
            column = _column(head, known, other, takes_any_unit)
        except (UserError, ValueError) as error:
            raise UserError(f"{path}: {error}") from None
        if any((c.known.name, c.plane) == (column.known.name, column.plane) for c in columns):
            plane = f"[{column.plane}]" if column.plane else ""
            raise UserError(f"{path}: {column.known.name}{plane}: given twice")
        columns.append(column)
    return Measurements(path, tuple(columns), rows)


def _column(
    head: str,
    known: Sequence[Known],
    other: Callable[[str], Known] | None,
    takes_any_unit: Sequence[str],
) -> Column:
    match = _HEAD.fullmatch(head)
    assert match is not None
    body, unit = match["body"] or match["alone"], (match["unit"] or "").strip()
    names = {name: one for one in known for name in (one.name, *one.others)}
    found, plane, body_unit = _found(body, names)
    if found is None:
        if any(map(str.isspace, body)):
            raise ValueError(
                f"{head}: unknown column: a column is named NAME or NAME [UNIT], such as "
                "speed [rpm]"
            )
        if other is None:
            raise ValueError(_unknown(head, body, known))
        found = other(body)
    elif unit and body_unit:
        raise ValueError(f"{head}: has two units, {body_unit} and {unit}")
    if found.refused:
        raise ValueError(f"{head}: {found.refused}")
    unit = unit or body_unit
    if not found.units:
        if unit:
            raise ValueError(f"{head}: {found.name} is text and has no unit")
        return Column(head, found, plane)
    if plane and not unit:
        _refuse_unit_as_plane(head, found, plane)
        if not found.per_plane:
            plane, unit = "", plane  # amplitude[um]: a column without planes
    if not unit:
        return Column(head, found, plane, symbol="" if len(found.units) > 1 else found.units[0])
    try:
        symbol, factor = unit_in_si(unit, found)
    except ValueError as error:
        if found.name in takes_any_unit and "unknown unit" in str(error):
            return Column(head, found, plane, unit)
        raise ValueError(f"{head}: {_wrong_unit(found, error)}") from None
    return Column(head, found, plane, unit, symbol, factor)


def _wrong_unit(found: Known, error: ValueError) -> str:
    """What is wrong about the unit of a head: it is unknown, or of another quantity."""
    expected, _, _ = str(error).partition(", such as")
    if expected == str(error):
        return expected
    example = f"`{found.name} [{_example(found)}]`"
    return f"{expected}: name the column {example}, or with another unit of that quantity"


def _found(body: str, names: dict[str, Known]) -> tuple[Known | None, str, str]:
    """The known column of a head without the unit in brackets, its plane, and a unit after _."""
    if body in names:
        return names[body], "", ""
    match = _PLANE.fullmatch(body)
    stem, plane = (match["name"], match["plane"].strip()) if match else (body, "")
    for name in sorted(names, key=len, reverse=True):
        if stem == name:
            return names[name], plane, ""
        if stem.startswith(f"{name}_"):
            unit = stem.removeprefix(f"{name}_")
            return names[name], plane, unit.replace("_s", "/s") if unit.endswith("_s") else unit
    return None, "", ""


def _refuse_unit_as_plane(head: str, found: Known, plane: str) -> None:
    if not found.per_plane:
        return
    try:
        unit_in_si(plane, found)
    except ValueError:
        return
    raise ValueError(
        f"{head}: is {plane} the unit or the plane? write `{found.name} [{plane}]` for the unit, "
        f"or `{found.name}[{plane}] [{_example(found)}]` for the plane"
    )


def _unknown(head: str, body: str, known: Sequence[Known]) -> str:
    stem, bracket, plane = body.partition("[")
    known = [one for one in known if not one.refused]
    allowed = ", ".join(one.name + "[PLANE]" * one.per_plane for one in known)
    meant = _unit_alone(body, known)
    if not meant:
        names = [name for one in known for name in (one.name, *one.others)]
        meant = next(iter(get_close_matches(stem, names, 1, 0.5)), "")
        meant += bracket + plane if meant else ""
    hint = f" (did you mean {meant}?)" if meant and meant != body else ""
    return (
        f"{head}: unknown column{hint}; allowed: {allowed}, each with its unit as NAME [UNIT], and "
        f"{NOTES[0]} for remarks"
    )


def _unit_alone(body: str, known: Sequence[Known]) -> str:
    """What a head is meant to be that is only a unit: `rpm` is `speed [rpm]`."""
    for one in known:
        try:
            unit_in_si(body, one)
        except ValueError:
            continue
        return f"{one.name} [{body}]"
    return ""
