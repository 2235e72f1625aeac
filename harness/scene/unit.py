"""The [[unit]] and [[connection]] tables: FMUs of any origin, and what is connected to what."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

from pydantic import AfterValidator, Field

from ..errors import SceneError
from .file import BUNDLED
from .messages import did_you_mean
from .patterns import NAME, PORT
from .quantities import LARGEST, Flag, Real, Table, Text


def _start_values(values: dict[str, Any]) -> dict[str, Any]:
    for name, value in values.items():
        known = isinstance(value, (bool, int, float, str))
        if not known or (isinstance(value, (int, float)) and not abs(value) <= LARGEST):
            words = "must be a finite number, true, false or text in quotes"
            raise ValueError(f"{name} {words}")
        if isinstance(value, float) and math.isnan(value):
            raise ValueError(f"{name} must be a finite number")
    return values


StartValues = Annotated[dict[str, Any], AfterValidator(_start_values)]

FmuPath = Annotated[Annotated[Text, Field(min_length=1)] | None, Field()]


class Unit(Table):
    """An FMU for co-simulation, FMI 2.0 or 3.0, of any origin."""

    name: Annotated[Text, Field(pattern=NAME)]
    """Names its signals: a letter first, then letters, digits, _ and -, at most 32; unique."""
    fmu: Annotated[Text, Field(min_length=1)]
    """Path of the FMU file, from the folder of the scene file."""
    start: StartValues = Field(default_factory=dict)
    """Start values of parameters and inputs, by name of the variable, in the units of the FMU."""


class Connection(Table):
    """An output that feeds an input; units of measurement are converted."""

    source: Annotated[Text, Field(pattern=PORT, alias="from")]
    """Output, as `unit.variable`."""
    to: Annotated[Text, Field(pattern=PORT)]
    """Input, as `unit.variable`."""
    factor: Real = 1.0
    """The output is multiplied by it; -1 changes its sign."""
    add: Flag = False
    """Added to what other connections give to the same input; default: the input has one source."""


def split_port(port: str) -> tuple[str, str]:
    """Unit and variable of `unit.variable`."""
    unit, _, variable = port.partition(".")
    return unit, variable


def fmu_path(fmu: str, scene: Path | None) -> Path:
    """The file of a unit, which a scene file names from its own folder; not a bundled scene."""
    is_user_file = scene is not None and scene.parent != BUNDLED
    return scene.parent / fmu if scene is not None and is_user_file else Path(fmu)


def name_problems(units: Sequence[Unit], taken: Collection[str]) -> list[str]:
    """A line for every unit whose name another one has, or another table."""
    names = [unit.name for unit in units]
    return [
        f'unit[{number}].name = "{name}": taken by another table; give every unit its own'
        for number, name in enumerate(names, start=1)
        if name in taken or name in names[: number - 1]
    ]


def connection_problems(
    connections: Sequence[Connection], units: Iterable[str], taken: Mapping[str, str] | None = None
) -> list[str]:
    """Connections to units that are not there, and inputs with two sources.

    Args:
        units: names of all units of the scene.
        taken: what feeds an input already, by `unit.variable`.
    """
    known, fed, lines = list(units), dict(taken or {}), []
    for number, each in enumerate(connections, start=1):
        for key, port in (("from", each.source), ("to", each.to)):
            unit = split_port(port)[0]
            if unit not in known:
                lines.append(
                    f'connection[{number}].{key} = "{port}": no unit {unit!r}'
                    f"{did_you_mean(unit, known)}; units: {', '.join(known)}"
                )
        if each.to in fed and not each.add:
            lines.append(
                f'connection[{number}].to = "{each.to}": has a source already, {fed[each.to]}; '
                "give add = true if their sum is meant, else remove one of them"
            )
        fed.setdefault(each.to, each.source)
    return lines


def with_start_values(
    units: list[dict[str, Any]], changes: Mapping[str, Any]
) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    """Tables of units with start values replaced, and the changes that are not theirs.

    A path is `unit.variable`, and `unit.fmu` the file; None takes a start value out.

    Raises:
        SceneError: a path names a unit alone.
    """
    named = {str(table.get("name")): table for table in units}
    others = {}
    for path, value in changes.items():
        first, _, variable = path.partition(".")
        if first not in named:
            others[path] = value
            continue
        if not variable:
            raise SceneError(f"{path!r}: name a variable of it, such as {first}.mass")
        table = named[first]
        if variable == "fmu":
            table["fmu"] = value
        elif value is None:
            table.setdefault("start", {}).pop(variable, None)
        else:
            table["start"] = {**table.get("start", {}), variable: value}
    return units, others
