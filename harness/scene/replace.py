"""Values put into a scene's document by path, such as `weights.drag` or `rotor.stiffness[2]`."""

from __future__ import annotations

import copy
import re
from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import BaseModel

from ..errors import SceneError
from .file import MOST_LEVELS
from .messages import choose_table, did_you_mean, tables_in
from .quantities import fields_of
from .run import DRIVES, UNCORRECTED

# giving one of these takes the place of the others
_ALTERNATIVES = {
    **{f"operation.{drive}": tuple(o for o in DRIVES if o != drive) for drive in DRIVES},
    "rotor.damping": ("damping_ratio",),
    "rotor.support_damping": ("damping_ratio",),
    "rotor.damping_ratio": ("damping", "support_damping"),
    "run.revolutions": ("duration",),
    "run.duration": ("revolutions",),
    "coupling.steps_per_rev": ("tolerance",),
    "coupling.tolerance": ("steps_per_rev", "corrections"),
}
SPEED = "operation.speed"
_AXES = r"\b(\w*(?:stiffness|damping|damping_ratio|limit)(?:\[\d+\])?)\[([xy])\]"
_PART = r"(?P<key>[A-Za-z_][A-Za-z0-9_-]*)(?P<indices>(?:\[\d+\])*)$"

Document = dict[str, Any]
TableType = type[BaseModel]


def in_full(path: str, bodies: Sequence[str] = ()) -> str:
    """A path with `speed`, short for operation.speed, in full, and [x] and [y] as [1] and [2].

    Args:
        bodies: names of the scene's bodies, which a path may begin with, as with `body[n]`; both
            stand for rotor.bodies[n].
    """
    if path == "speed":
        return SPEED
    first, dot, rest = path.partition(".")
    if first in bodies:
        path = f"rotor.bodies[{bodies.index(first) + 1}]{dot}{rest}"
    elif first.startswith("body["):
        path = f"rotor.bodies{path.removeprefix('body')}"
    return re.sub(_AXES, lambda found: f"{found[1]}[{'xy'.index(found[2]) + 1}]", path)


def replaced(
    document: Document,
    changes: Mapping[str, Any],
    tables: Mapping[str, TableType],
    balancers: Mapping[str, int],
    bodies: Sequence[str] = (),
) -> Document:
    """A copy of a document with values replaced.

    Args:
        tables: what a path may begin with, and the table class behind it.
        balancers: for a balancer's name, its place in the document's list.
        bodies: names that a path may begin with, as in `in_full`.

    Raises:
        SceneError: a path is unknown; the message says what is possible.
    """
    document = copy.deepcopy(document)
    written: dict[str, str] = {}
    for path in changes:
        if (other := written.setdefault(in_full(path, bodies), path)) != path:
            raise SceneError(f"'{path}': the same as '{other}', which is given too: give one")
    changes = {in_full(path, bodies): value for path, value in changes.items()}
    given = {path for path, value in changes.items() if value is not None}
    for path, value in changes.items():
        first, *rest = path.split(".")
        if len(rest) > MOST_LEVELS:
            raise SceneError(f"'{path[:57]}...': unknown; no path has {len(rest) + 1} parts")
        if first not in tables:
            within = [
                f"{name}.{path}" for name, table in tables.items() if path in fields_of(table)
            ]
            near = f" (did you mean {' or '.join(within)}?)" if within else ""
            known = [*tables, *bodies]
            near = near or _by_name(path, balancers) or did_you_mean(first, ["speed", *known])
            raise SceneError(f"{path!r}: unknown{near}; begins with one of: {', '.join(known)}")
        if first in balancers:
            holder = document["balancer"][balancers[first]]
        else:
            holder = document.setdefault(first, {})
        _set_value(holder, tables[first], path, rest, plain(value))
        for other in _superseded(path, value):
            if f"{first}.{other}" not in given:
                holder.pop(other, None)
    return document


def _by_name(path: str, balancers: Mapping[str, int]) -> str:
    """' (did you mean ...?)' for a path that names a balancer by its place, as messages do."""
    found = re.match(r"balancer\[(\d+)\]\.", path)
    names = [name for name, place in balancers.items() if found and place == int(found[1]) - 1]
    return f" (did you mean {names[0]}.{path[found.end() :]}?)" if found and names else ""


def _superseded(path: str, value: Any) -> tuple[str, ...]:
    """Keys of the same table that mean nothing beside this value."""
    if path == "coupling.scheme" and value in UNCORRECTED:
        return ("corrections",)
    return _ALTERNATIVES.get(path, ()) if value is not None else ()


def _set_value(holder: Document, table: TableType, path: str, rest: list[str], value: Any) -> None:
    """Follow `rest` down from a table of the document and set the value there."""
    parts = [re.match(_PART, part) for part in rest]
    if not parts:
        raise SceneError(f"{path!r}: name a key of it: {', '.join(fields_of(table))}")
    inner: TableType | None = table
    for depth, part in enumerate(parts):
        fields = fields_of(inner) if inner else {}
        if part is None or (inner is not None and part["key"] not in fields):
            known = list(fields)
            raise SceneError(
                f"{path!r}: unknown{did_you_mean(rest[depth], known)}; "
                f"{'.'.join(path.split('.')[: depth + 1])} has: {', '.join(known) or 'no keys'}"
            )
        if depth == len(parts) - 1:
            _assign(holder, part["key"], part["indices"], value, path)
            return
        below = holder.setdefault(part["key"], {})
        for number in map(int, re.findall(r"\d+", part["indices"])):
            count = len(below) if isinstance(below, list) else 0
            if not 1 <= number <= count:
                raise SceneError(f"{path!r}: {part['key']} has {count} entries, counted from 1")
            below = below[number - 1]
        if not isinstance(below, dict):
            raise SceneError(f"{path!r}: {part[0]} has no keys of its own")
        field = fields.get(part["key"])
        inner = choose_table(tables_in(field.annotation), below) if field else None
        holder = below


def plain(value: Any) -> Any:
    """A copy as `tomllib` gives it: of table objects, tuples, and NumPy's scalars and arrays."""
    if isinstance(value, BaseModel):
        given = value.model_fields_set | {"kind"}
        fields = fields_of(type(value)).items()
        names = zip(type(value).model_fields, fields, strict=True)
        value = {key: getattr(value, name) for name, (key, _) in names if name in given}
    if isinstance(value, Mapping):
        return {key: plain(inner) for key, inner in value.items()}
    if hasattr(value, "tolist"):
        return value.tolist()
    return [plain(inner) for inner in value] if isinstance(value, (list, tuple)) else value


def _assign(target: Document, key: str, indices: str, value: Any, path: str) -> None:
    """Set a key, or an element of the list there; None takes a key out."""
    if not indices and value is None:
        target.pop(key, None)
        return
    holder: Any = target
    last: Any = key
    for number in map(int, re.findall(r"\d+", indices)):
        values = holder.get(last) if isinstance(holder, dict) else holder[last]
        if isinstance(values, (int, float, str)):
            length = target.get("count", 2)  # of weights; else one number is for both axes
            values = holder[last] = [values] * (length if isinstance(length, int) else 2)
        count = len(values) if isinstance(values, list) else 0
        if not 1 <= number <= count:
            if not count:
                whole = path.rpartition("[")[0]
                raise SceneError(f"{path!r}: no list is there; give it whole, as {whole}=[...]")
            raise SceneError(f"{path!r}: the scene gives {count} values there, counted from 1")
        holder, last = values, number - 1
    holder[last] = value
