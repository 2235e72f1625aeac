"""Which parameter of a unit a key of the scene feeds, said once beside the key."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from .quantities import Table

Start = dict[str, float | bool]  # parameters and start values of a unit, by name


@dataclass(frozen=True)
class Feeds:
    """Metadata of an `Annotated` field: the unit's parameter that its value goes to.

    Attributes:
        parameter: `{n}` stands for the number of a list's element, from 1, `{axis}` for x and y of
            a pair; before the keys of a table it is their prefix.  Default: the key's own name.
    """

    parameter: str = ""


def fed(table: Table, prefix: str = "") -> Start:
    """Parameters that a table's keys feed; a key that is left out (None) feeds nothing."""
    values: Start = {}
    for name, field in type(table).model_fields.items():
        for feeds in field.metadata:
            if isinstance(feeds, Feeds):
                values |= _spread(prefix + (feeds.parameter or name), getattr(table, name))
    return values


def _spread(parameter: str, value: Any) -> Start:
    """One value, every element of a list, x and y of a pair, or every key of a table."""
    if value is None:
        return {}
    if isinstance(value, Table):
        return fed(value, parameter)
    if "{n}" in parameter:
        return _each("{n}", ((str(n), v) for n, v in enumerate(value, start=1)), parameter)
    if "{axis}" in parameter:
        return _each("{axis}", zip("xy", value, strict=True), parameter)
    return {parameter: value}


def _each(mark: str, parts: Iterable[tuple[str, Any]], parameter: str) -> Start:
    values: Start = {}
    for text, value in parts:
        values |= _spread(parameter.replace(mark, text), value)
    return values
