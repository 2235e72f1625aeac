"""Problems of a scene file in words: key, value, unit, and what is allowed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal, NamedTuple, get_args, get_origin

from pydantic import BaseModel, ValidationError

from . import patterns
from .fields import fields_of, unit_of

Location = tuple[str | int, ...]

_WORDS = {
    "greater_than": "must be greater than {gt:g}",
    "greater_than_equal": "must be {ge:g} or more",
    "less_than": "must be less than {lt:g}",
    "less_than_equal": "must be {le:g} or less",
    "finite_number": "must be a finite number",
    "float_type": "must be a number",
    "int_type": "must be a whole number",
    "int_from_float": "must be a whole number",
    "bool_type": "must be true or false",
    "string_type": "must be text in quotes",
    "string_too_short": "must not be empty",
    "literal_error": "must be one of {expected}",
    "tuple_type": "must be a list",
    "too_short": "must have at least {min_length} values",
    "too_long": "must have at most {max_length} values",
}
_TABLE_TYPES = {"model_type", "model_attributes_type", "dict_type"}


class Place(NamedTuple):
    """Where a problem is: its key as written in the file, the value there, its unit, its table."""

    key: str
    value: Any
    unit: str
    table: type[BaseModel] | None


def tables_in(annotation: Any) -> list[type[BaseModel]]:
    """Every table class within a type annotation."""
    if get_origin(annotation) is None and isinstance(annotation, type):  # tuple[...] is one in 3.10
        return [annotation] if issubclass(annotation, BaseModel) else []
    return [table for part in get_args(annotation) for table in tables_in(part)]


def kinds_of(table: type[BaseModel]) -> tuple[str, ...]:
    """Values of `kind` that a table class stands for."""
    field = table.model_fields.get("kind")
    if field is None or get_origin(field.annotation) is not Literal:
        return ()
    return get_args(field.annotation)


def choose_table(candidates: Sequence[type[BaseModel]], value: Any) -> type[BaseModel] | None:
    """The class that a table's `kind` asks for, or the only one there is."""
    if len(candidates) == 1:
        return candidates[0]
    kind = value.get("kind") if isinstance(value, dict) else None
    return next((table for table in candidates if kind in kinds_of(table)), None)


def locate(location: Location, document: Any, root: type[BaseModel]) -> Place:
    """Follow pydantic's location through the document as the user wrote it."""
    key, value, unit = "", document, ""
    candidates: list[type[BaseModel]] = [root]
    table: type[BaseModel] | None = root
    for part in location:
        if isinstance(part, int):
            if not isinstance(value, (list, tuple)):
                continue  # one number stands for both axes
            key += f"[{part + 1}]"
            value = value[part] if part < len(value) else None
            continue
        inside = value if isinstance(value, dict) else {}
        if part not in inside and part == inside.get("kind"):
            continue  # pydantic names the member of the union, the file does not
        table = choose_table(candidates, value)
        key += f".{part}" if key else part
        value = inside.get(part)
        if table is not None and part in (fields := fields_of(table)):
            unit = unit_of(fields[part])
            candidates = tables_in(fields[part].annotation)
    return Place(key, value, unit, table)


def show(value: Any) -> str:
    """A value as TOML writes it, shortened."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        text = '"' + value.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n") + '"'
    elif isinstance(value, (list, tuple)):
        text = "[" + ", ".join(show(item) for item in value) + "]"
    elif isinstance(value, dict):
        text = "{" + ", ".join(f"{k} = {show(v)}" for k, v in value.items()) + "}"
    elif isinstance(value, (int, float)):
        text = repr(value) if isinstance(value, float) or abs(value) < 10**20 else "a huge number"
    else:
        text = str(value)
    return text if len(text) <= 60 else text[:57] + "..."


def did_you_mean(word: Any, known: Sequence[str], written: Callable[[str], str] = str) -> str:
    """' (did you mean ...?)' or nothing.

    Args:
        written: how the one of `known` that is most alike is written.
    """
    import difflib  # slow to load

    close = difflib.get_close_matches(str(word), known, n=1)
    return f' (did you mean "{written(close[0])}"?)' if close else ""


def quoted(words: Sequence[str]) -> str:
    """Words in quotes, with commas."""
    return ", ".join(f'"{word}"' for word in words)


def _unknown_key(location: Location, document: Any, root: type[BaseModel]) -> str:
    place = locate(location, document, root)
    known = list(fields_of(place.table)) if place.table else []
    name = str(location[-1])
    return f"{place.key}: unknown key{did_you_mean(name, known)}; allowed: {', '.join(known)}"


def _wrong_kind(location: Location, document: Any, root: type[BaseModel]) -> str:
    place = locate(location, document, root)
    parent = locate(location[:1], document, root).table or root
    field = fields_of(parent)[str(location[0])]
    kinds = [kind for table in tables_in(field.annotation) for kind in kinds_of(table)]
    given = place.value.get("kind") if isinstance(place.value, dict) else None
    allowed = f"must be one of {quoted(kinds)}"
    if given is None:
        return f"{place.key}.kind: missing; {allowed}"
    return f"{place.key}.kind = {show(given)}: {allowed}{did_you_mean(given, kinds)}"


def statement(place: Place, words: str) -> str:
    """'key = value unit: words'."""
    if place.value is None:
        return f"{place.key}: {words}"
    is_list = isinstance(place.value, (list, tuple)) and place.value
    measured = place.value[0] if is_list else place.value
    is_number = isinstance(measured, (int, float)) and not isinstance(measured, bool)
    unit = f" {place.unit}" if place.unit and is_number else ""
    return f"{place.key} = {show(place.value)}{unit}: {words}"


def _one(error: Any, document: Any, root: type[BaseModel]) -> str:
    kind, location = error["type"], error["loc"]
    context = error.get("ctx", {})
    if kind == "extra_forbidden":
        return _unknown_key(location, document, root)
    if kind.startswith("union_tag"):
        return _wrong_kind(location, document, root)
    if kind == "refusal":
        return statement(locate((*location, context["key"]), document, root), context["words"])
    place = locate(location, document, root)
    unit = f" in {place.unit}" if place.unit else ""
    if kind == "missing":
        field = root.model_fields.get(str(location[0])) if len(location) == 1 else None
        if field is not None and tables_in(field.annotation):
            return f"{place.key}: missing; give a table [{place.key}]"
        return f"{place.key}: missing; give a value{unit}"
    if kind == "value_error":
        return statement(place, str(context["error"]))
    if kind in _TABLE_TYPES:
        return statement(place, "must be a table of keys and values")
    if kind == "tuple_type" and isinstance(place.value, dict):
        return f"{place.key}: must be a list of tables; write [[{place.key}]]"
    if kind == "string_pattern_mismatch":
        return statement(place, patterns.WORDS[context["pattern"]])
    if kind == "too_short" and isinstance(place.value, str):
        kind = "string_too_short"
    words = _WORDS[kind].format(**context) if kind in _WORDS else error["msg"]
    words = words.removesuffix("1 values") + "1 value" if words.endswith(" 1 values") else words
    if kind in {"float_type", "int_type", "int_from_float"} and unit:
        words += unit
    return statement(place, words)


def problems(error: ValidationError, document: Any, root: type[BaseModel]) -> list[str]:
    """One line for each problem, each said once."""
    lines = (_one(item, document, root) for item in error.errors(include_url=False))
    return list(dict.fromkeys(lines))
