"""The units' declarations for the C units: `layout.h`.

The variables of a unit of any size follow from those of a few sizes: names that differ in their
index alone make a block, which C repeats.  What a start value depends on is left to C (`starts` of
each unit).
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from ....models import constants as shared
from ...catalogue import sized_unit
from ...composite.variables import COMPOSITE
from ...rotor.matrices import FORCES, GIVEN, TABLED
from ...variables import Layout, Variable
from ...xml.archive import source

_RESTRAINTS = ("cubic", "stop", "slider")  # that stand across rows of the stations
# what a variable stands once for each of, by the word before its index
_REPEATS = {
    "station": "SIZE_STATIONS",
    "support": "SIZE_TWO",
    "plane": "SIZE_PLANES",
    "unbalance": "SIZE_UNBALANCES",
    "unbalance_change": "SIZE_UNBALANCES",
    "weight": "SIZE_WEIGHTS",
    "slider": "SIZE_SLIDERS",
    "cubic": "SIZE_CUBICS",
    "stop": "SIZE_STOPS",
    "point": "SIZE_POINTS",
    "race": "SIZE_LOBES",
    "corner": "SIZE_POINTS",
    "compliance": "SIZE_TRIANGLE",
    **dict.fromkeys(GIVEN, "SIZE_SQUARE"),
    "plane_row": "SIZE_PLANE_ROWS",
    "unbalance_row": "SIZE_UNBALANCE_ROWS",
    "bending_row": "SIZE_BENDING_ROWS",
    "table_speed": "SIZE_SPEEDS",
    **{f"{name}_row_{axis}": f"SIZE_{name.upper()}_ROWS" for name in _RESTRAINTS for axis in "xy"},
    "table_row": "SIZE_TABLE_ROWS",
    **dict.fromkeys(TABLED, "SIZE_TABLE_SPEEDS"),
    "force": "SIZE_FORCES",
    **dict.fromkeys(FORCES, "SIZE_FORCE_ROWS"),
    "foot": "SIZE_FEET",
}
_FORCES_OF_SUPPORTS = tuple(f"support[#].force_{axis}" for axis in "xy")
_SEVERAL = 3  # of everything, so that a block is seen to repeat
_OF_SUPPORTS = ("sliders", "cubics", "stops")
_PLANAR = {"planes": _SEVERAL, **dict.fromkeys(_OF_SUPPORTS, _SEVERAL), "stations": 1}
_ROTOR = {**_PLANAR, "stations": 5, "unbalances": _SEVERAL}

_GIVEN = {**_ROTOR, "kind": "matrices", "tables": _SEVERAL, "speeds": _SEVERAL}
_GIVEN |= {"supports": 2, "feet": _SEVERAL}

# what the C library holds: unit, and options of the sizes looked at
TABLES: tuple[tuple[str, dict[str, Any]], ...] = (
    ("RotorOnSupports", {**_PLANAR, "kind": "planar"}),
    ("RotorOnSupports", {**_ROTOR, "kind": "two_support", "stations": 2}),
    ("RotorOnSupports", {**_ROTOR, "kind": "flexible", "shaft": "uniform"}),
    ("RotorOnSupports", {**_ROTOR, "kind": "flexible", "shaft": "compliance"}),
    ("RotorOnSupports", _GIVEN),
    ("LiquidBalancer", {}),
    ("RingBalancer", {}),
    ("BallBalancer", {"weights": _SEVERAL, "unequal": 1, "lobes": _SEVERAL}),
    ("Motor", {"points": _SEVERAL}),
    ("Composite", {"planes": _SEVERAL, "corners": _SEVERAL, "unbalances": _SEVERAL}),
    ("Composite", {"planes": _SEVERAL, "kind": "motor"}),
)

_INDEX = re.compile(r"(?<=[\[,])\d+(?=[\],])")
# starts that depend on index or size: C computes them
_STARTS_IN_C = (
    "station[#].z",
    "support[#].position",
    "plane[#].position",
    "unbalance[#].position",
    "unbalance[#].amount",
    "compliance[#,#]",
    *(f"{name}[#,#]" for name in (*GIVEN, "plane_row", "unbalance_row", "table_row")),
    "table_speed[#]",
    *(f"{name}_row_{axis}[#,#]" for name in _RESTRAINTS for axis in "xy"),
    "weight[#].angle0",
    "point[#].speed",
    "point[#].torque",
)
_UNIT_LENGTH = 7


@dataclass
class _Block:
    """A group of variables that C repeats: once for each station, for example."""

    repeat: str
    variables: dict[str, list[Variable]] = field(default_factory=dict)  # that have a pattern


@cache
def header() -> str:
    """Text of `layout.h`.

    Raises:
        ValueError: the declarations are not of a form that C can repeat.
    """
    parts = [
        "/* Variables of every unit; written by layout.py from the declarations: do not edit.\n\n"
        "   In a name # stands for an index and @1, @2 for the axes of the coupling signals. */"
    ]
    records = []
    for unit, options in TABLES:
        kind, shaft = options.get("kind", ""), options.get("shaft", "")
        title = "_".join(filter(None, (unit.lower(), kind, shaft)))
        blocks = _blocks(unit, options)
        rows = [_row(*row) for b in blocks for row in b.variables.items()]
        parts.append(f"static const Declared {title}[] = {{\n    " + ",\n    ".join(rows) + "};")
        counts = ", ".join(f"{{{b.repeat}, {len(b.variables)}}}" for b in blocks)
        parts.append(f"static const Block {title}_blocks[] = {{{counts}}};")
        flags = _layout(unit, frame="rotor", **options).booleans
        booleans = [f'{{"{v.name}", {int(bool(v.start))}}}' for v in flags]
        where = "0"
        if booleans:
            where = f"{title}_booleans"
            parts.append(f"static const Flag {where}[] = {{{', '.join(booleans)}}};")
        records.append(
            f'{{"{unit}", "{kind}", "{shaft}", {title}, {title}_blocks, {len(blocks)}, '
            f"{where}, {len(booleans)}}}"
        )
    parts.append("static const Table TABLES[] = {\n    " + ",\n    ".join(records) + "};")
    parts.append(f"enum {{ TABLE_COUNT = {len(records)} }};")
    return "\n\n".join(parts) + "\n"


def constants() -> str:
    """Text of `constants.h`: the constants that Python and C share."""
    text = source(Path(shared.__file__))
    rows = re.findall(r"^([A-Z_0-9]+) = (\S+)  # (.*)$", text, re.M)
    lines = [f"#define {name} {value.replace('_', '')} /* {why} */" for name, value, why in rows]
    return "\n".join(["#ifndef CONSTANTS_H", "#define CONSTANTS_H", "", *lines, "", "#endif", ""])


@cache
def weight_parameters() -> str:
    """Text of `weights_parameters.h`: places of the balls' parameters among their variables."""
    names = [v.name for v in sized_unit("BallBalancer").layout.reals]
    alike = names[: names.index("weight[1].angle0")]
    places = ", ".join([*map(str.upper, alike), "FIRST_ANGLE"])
    lines = ["#ifndef WEIGHTS_PARAMETERS_H", "#define WEIGHTS_PARAMETERS_H", ""]
    lines += ["/* Written by layout.py from the declaration. */", f"enum {{ {places} }};"]
    return "\n".join([*lines, "", "#endif", ""])


def _group(variable: Variable) -> str:
    return {"parameter": "p", "input": "i", "output": "vo"[not variable.observed]}[
        variable.causality
    ]


def _layout(unit: str, **options: Any) -> Layout:
    return (
        COMPOSITE.sized(options) if unit == COMPOSITE.name else sized_unit(unit, **options)
    ).layout


def _blocks(unit: str, options: dict[str, Any]) -> list[_Block]:
    """Variables of a unit in order, those that repeat together in one block."""
    turning, fixed = (_layout(unit, frame=frame, **options).reals for frame in ("rotor", "fixed"))
    left_out = (*_OF_SUPPORTS, "unequal", "lobes")
    smooth = _layout(unit, frame="rotor", **{k: v for k, v in options.items() if k not in left_out})
    blocks: list[_Block] = []
    index = 1  # of the variable before
    for v, other in zip(turning, fixed, strict=True):
        pattern = _INDEX.sub("#", _without_axis(v.name, other.name))
        if not blocks or pattern not in blocks[-1].variables:
            repeat = _repeat(pattern, v.name in smooth.index)
            if not blocks or blocks[-1].repeat != repeat or index > 1:
                blocks.append(_Block(repeat))
        blocks[-1].variables.setdefault(pattern, []).append(v)
        index = max(map(int, _INDEX.findall(v.name)), default=1)
    return blocks


def _repeat(pattern: str, always: bool) -> str:
    """What a variable is repeated by; `always`: it also stands there without options."""
    if pattern in _FORCES_OF_SUPPORTS:
        return "SIZE_SUPPORTS"
    word = re.search(r"(\w+)\[#", pattern)
    if not word:
        return "SIZE_ONE" if always else "SIZE_SLIDING"
    repeat = _REPEATS[word[1]]
    return "SIZE_UNEQUAL" if repeat == "SIZE_WEIGHTS" and not always else repeat


def _without_axis(turning: str, fixed: str) -> str:
    """A name with @1 or @2 where it depends on the frame of the signals."""
    if turning == fixed:
        return turning
    for axis, (rotating, still) in {"@1": ("_xi", "_x"), "@2": ("_eta", "_y")}.items():
        if turning.replace(rotating, still) == fixed:
            return turning.replace(rotating, f"_{axis}")
    raise ValueError(f"{turning} and {fixed}: C knows the axes xi, eta and x, y")


def _row(pattern: str, variables: Sequence[Variable]) -> str:
    """Initialiser of a `Declared`."""
    one = variables[0]
    if any((v.unit, v.minimum, v.above) != (one.unit, one.minimum, one.above) for v in variables):
        raise ValueError(f"{one.name}: every one of it must have the same unit and limits")
    if len(one.unit) > _UNIT_LENGTH or not float(one.minimum or 0.0).is_integer():
        raise ValueError(
            f"{one.name}: C takes units of at most {_UNIT_LENGTH} letters, and whole least values"
        )
    varies = pattern in _STARTS_IN_C
    if not varies and any(v.start != one.start for v in variables):
        raise ValueError(f"{one.name}: C has one start value for all of them")
    flags = [
        *(["HAS_MINIMUM"] if one.minimum is not None else []),
        *(["ABOVE_MINIMUM"] if one.above else []),
        *(["START_VARIES"] if varies else []),
        *(["TUNABLE"] if one.variability == "tunable" else []),
    ]
    start = 0.0 if varies or one.start is None else float(one.start)
    low = 0.0 if one.minimum is None else float(one.minimum)
    return (
        f'{{"{pattern}", "{one.unit}", \'{_group(one)}\', {" | ".join(flags) or 0}, '
        f"{low!r}, {start!r}}}"
    )
