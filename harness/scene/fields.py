"""Fields of a table: their keys as written in the file, and their units of measurement."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic_core import core_schema

from ..units import to_si


@dataclass(frozen=True)
class SI:
    """Unit of measurement of a field, in an `Annotated` type: text with a unit is read as it."""

    symbol: str

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        return core_schema.no_info_before_validator_function(self._read, handler(source))

    def _read(self, value: Any) -> Any:
        if isinstance(value, (list, tuple)):
            return [self._read(inner) for inner in value]
        return to_si(value, self.symbol) if isinstance(value, str) else value


def fields_of(table: type[BaseModel]) -> dict[str, FieldInfo]:
    """A table's fields by their keys as written in the file."""
    return {field.alias or name: field for name, field in table.model_fields.items()}


def unit_of(field: FieldInfo) -> str:
    """Unit symbol of a field, empty for text, counts and ratios."""
    return next((item.symbol for item in field.metadata if isinstance(item, SI)), "")
