"""The reference of a scene's keys, made from the scene's own types."""

from __future__ import annotations

import ast
import inspect
from collections.abc import Iterator
from functools import cache
from itertools import groupby, pairwise
from typing import Any

from pydantic import BaseModel

from .messages import kinds_of, quoted, show, tables_in
from .quantities import LARGEST, LARGEST_ANGLE, Table, fields_of, unit_of
from .scene import Scene
from .system import System

SYSTEM = (
    "A file without `[rotor]` is a system: FMUs of any origin and their connections alone, see "
    "[my own FMU](../how-to/own_fmu.md). `autobalancer run FILE` runs it."
)
HEAD = ("| key | unit | default | allowed | meaning |", "|---|---|---|---|---|")


@cache
def reference() -> str:
    """Every table of a scene with its keys, as Markdown."""
    lines = ["## At the top of the file", "", *_tables(Scene, "")]
    lines += ["## A system of units", "", SYSTEM, "", *_tables(System, " of a system")]
    return "\n".join(lines).rstrip() + "\n"


def _tables(root: type[Table], of: str) -> Iterator[str]:
    """Keys at the top of a file, then every table."""
    nested = {key: tables_in(f.annotation) for key, f in fields_of(root).items()}
    yield from (*HEAD, *_rows(root, [name for name, tables in nested.items() if not tables]), "")
    for key, tables in nested.items():
        if tables:
            is_list = "array" in root.model_json_schema()["properties"][key].values()
            yield from (f"## `[[{key}]]`{of}" if is_list else f"## `[{key}]`{of}", "")
            yield from _section(tables)


def _section(tables: list[type[BaseModel]]) -> Iterator[str]:
    """One table of a scene; of several kinds what all of them have comes first."""
    if len(tables) == 1:
        yield from (_summary(tables[0]), "", *HEAD, *_rows(tables[0], tables[0].model_fields), "")
        return
    shared = set.intersection(*(set(table.model_fields) for table in tables))
    common = [name for name in tables[0].model_fields if name in shared - {"kind"}]
    if common:
        yield from ("Of every kind:", "", *HEAD, *_rows(tables[0], common), "")

    def own_keys(table: type[BaseModel]) -> list[str]:
        return [name for name in table.model_fields if name not in shared]

    for own, alike in groupby(tables, own_keys):
        table, *others = alike
        kinds = quoted([kind for each in (table, *others) for kind in kinds_of(each)])
        yield from (f"**`kind = {kinds}`** {_summary(table.__mro__[1] if others else table)}", "")
        if own:
            yield from (*HEAD, *_rows(table, own), "")


def _rows(table: type[BaseModel], names: Any, before: str = "") -> Iterator[str]:
    """A line for every key, keys of inner tables after the key that holds them."""
    schema, said = table.model_json_schema(), meanings(table)
    for name in names:
        field = table.model_fields[name]
        key = field.alias or name
        if name not in said:
            raise ValueError(f"{table.__name__}.{name}: has no docstring that says what it means")
        meaning, _, default = said[name].partition("; default: ")
        if not default:
            value = field.get_default(call_default_factory=True)
            default = "required" if field.is_required() else _default(value)
        allowed = _allowed(schema["properties"][key], schema.get("$defs", {}))
        cells = (f"`{before}{key}`", unit_of(field), default.rstrip("."), allowed)
        yield f"| {' | '.join(cells)} | {meaning.rstrip('.')} |".replace("|  |", "| |")
        for inner in tables_in(field.annotation) if table not in (Scene, System) else ():
            many = "[n]" if allowed.startswith("list") else ""
            yield from _rows(inner, inner.model_fields, f"{before}{key}{many}.")


def meanings(table: type[BaseModel]) -> dict[str, str]:
    """What the docstring below each field of a table says, inherited ones included."""
    found = {}
    for owner in reversed(table.__mro__):
        if issubclass(owner, Table) and owner is not Table:
            (definition,) = ast.parse(inspect.getsource(owner)).body
            assert isinstance(definition, ast.ClassDef)
            for field, text in pairwise(definition.body):
                if isinstance(field, ast.AnnAssign) and isinstance(text, ast.Expr):
                    assert isinstance(field.target, ast.Name)
                    found[field.target.id] = " ".join(ast.literal_eval(text.value).split())
    return found


def _summary(table: type[BaseModel]) -> str:
    return " ".join((table.__doc__ or "").split("\n\n")[0].split())


def _default(value: Any) -> str:
    if value is None or value in ((), "", {}):
        return "none"
    if isinstance(value, tuple) and len(set(value)) == 1:
        return _default(value[0])  # one number for both axes, or both supports
    if isinstance(value, BaseModel):
        return "as below"
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    return f"{value:g}" if is_number else f"`{show(value)}`"


def _allowed(schema: dict[str, Any], definitions: dict[str, Any]) -> str:
    """What a value may be, from its JSON schema."""
    if "anyOf" in schema:
        parts = [_allowed(s, definitions) for s in schema["anyOf"] if s.get("type") != "null"]
        return " or ".join(parts)
    if "$ref" in schema or schema.get("type") == "object":
        return "table"
    choices = schema.get("enum", [schema["const"]] if "const" in schema else [])
    if choices:
        return ", ".join(f"`{show(choice)}`" for choice in choices)
    if schema["type"] == "array":
        inner = schema.get("items") or schema["prefixItems"][0]
        each, count = _allowed(inner, definitions), schema.get("minItems", 0)
        if schema.get("title") == "[x, y]":
            return "`[x, y]`"
        if count and count == schema.get("maxItems"):
            return f"{count} of: {each}"
        return f"list of {count} or more: {each}" if count else f"list: {each}"
    word = {"boolean": "true or false", "string": "text", "integer": "whole"}.get(schema["type"])
    return ", ".join(filter(None, (word, _bounds(schema)))) or "number"


def _bounds(schema: dict[str, Any]) -> str:
    limits_of_all = {each for limit in (LARGEST, LARGEST_ANGLE) for each in (limit, -limit)}
    found = [
        schema.get("exclusiveMinimum"),
        schema.get("ge", schema.get("minimum")),  # as pydantic names a limit of a field's own
        schema.get("le", schema.get("maximum")),
    ]
    above, least, most = (None if limit in limits_of_all else limit for limit in found)
    if least is not None and most is not None:
        return f"{least:g} to {most:,.10g}".replace(",", " ")
    limits = ((">", above), ("≥", least), ("≤", most))
    return ", ".join(f"{sign} {limit:g}" for sign, limit in limits if limit is not None)
