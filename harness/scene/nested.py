"""Tables within a table of a scene: each is read by its own class."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, TypeVar

from pydantic import BaseModel, Field
from pydantic_core import PydanticKnownError, core_schema

from .messages import kinds_of, tables_in

Read = TypeVar("Read")

if TYPE_CHECKING:
    Nested = Annotated[Read, ...]
else:

    class Nested:
        """`Nested[Table]`, or `Nested[One | Another]`, of which `kind` chooses.

        pydantic builds what reads a table into every table around it.  A scene has few of the
        tables that there are: what reads these is built once, when the first of them is read.
        """

        def __class_getitem__(cls, table: Any) -> Any:
            return Annotated[table, _ByItsClass(table)]


class _ByItsClass:
    """Metadata of a table's type: the classes that stand in it."""

    def __init__(self, annotation: Any) -> None:
        self.annotation = annotation
        self.tables = tuple(tables_in(annotation))

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        return core_schema.no_info_plain_validator_function(self._read)

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> Any:
        from pydantic import TypeAdapter  # few read a schema

        whole = self.annotation
        if len(self.tables) > 1:
            whole = Annotated[whole, Field(discriminator="kind")]
        return handler(TypeAdapter(whole).core_schema)

    def _read(self, value: Any) -> BaseModel:
        return self._table_of(value).model_validate(value)

    def _table_of(self, value: Any) -> type[BaseModel]:
        """The table that a value's `kind` names; the errors are those of pydantic's own unions."""
        if len(self.tables) == 1:
            return self.tables[0]
        if isinstance(value, self.tables):
            return type(value)
        if not isinstance(value, dict):
            raise PydanticKnownError("model_attributes_type")
        if "kind" not in value:
            raise PydanticKnownError("union_tag_not_found", {"discriminator": "'kind'"})
        kind = value["kind"]
        known = {word: table for table in self.tables for word in kinds_of(table)}
        if isinstance(kind, str) and kind in known:
            return known[kind]
        expected = ", ".join(map(repr, known))
        said = {"discriminator": "'kind'", "tag": str(kind), "expected_tags": expected}
        raise PydanticKnownError("union_tag_invalid", said)
