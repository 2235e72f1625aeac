"""Numbers of a scene file with their units, and the base of its tables."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ValidationError,
    WithJsonSchema,
)
from pydantic_core import PydanticCustomError, PydanticKnownError, core_schema

from ..errors import SceneError
from ..units import LARGEST as LARGEST
from ..units import SMALLEST as SMALLEST
from .fields import SI as SI
from .fields import fields_of as fields_of
from .fields import unit_of as unit_of
from .messages import problems

LARGEST_ANGLE = 1e9  # rad: doubles that large lie 1e-7 rad apart
# what XML cannot hold, and what a terminal obeys; lines and tabs are allowed
_CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")


class Mean(float):
    """The mean of values that are given one by one, which it keeps."""

    each: tuple[float, ...]

    def __new__(cls, each: Sequence[float]) -> Mean:
        """Of the values."""
        mean = super().__new__(cls, math.fsum(each) / len(each))
        mean.each = tuple(each)
        return mean

    def tolist(self) -> list[float]:
        """The values."""
        return list(self.each)

    def __getnewargs__(self) -> Any:
        """For copies: what it was made from."""
        return (self.each,)

    def __eq__(self, other: object) -> bool:
        """Of the same values."""
        return isinstance(other, Mean) and self.each == other.each

    def __hash__(self) -> int:
        """Of the values."""
        return hash(self.each)


def each_of(value: float | None) -> tuple[float, ...]:
    """Values that were given one by one; none where one value stands for all."""
    return value.each if isinstance(value, Mean) else ()


def _one_or_mean(values: tuple[float, ...]) -> float:
    # not by the schema, which counts wrong values as missing
    if not values:
        found = {"field_type": "Tuple", "min_length": 1, "actual_length": 0}
        raise PydanticKnownError("too_short", found)
    return values[0] if len(values) == 1 else Mean(values)


@dataclass(frozen=True)
class Each:
    """Metadata of a number for which a list can stand, a value for each of several."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> Any:
        values = core_schema.no_info_before_validator_function(
            lambda value: value if isinstance(value, (list, tuple)) else [value],
            core_schema.tuple_variable_schema(handler(source)),
        )
        return core_schema.no_info_after_validator_function(
            _one_or_mean,
            values,
            serialization=core_schema.plain_serializer_function_ser_schema(
                lambda value: list(each_of(value)) or value
            ),
        )

    def __get_pydantic_json_schema__(self, schema: Any, handler: Any) -> Any:
        listed = handler(schema)
        return {"anyOf": [listed["items"], listed]}


class Table(BaseModel):
    """One table of a scene file: frozen, and no key that it does not know."""

    # what is never read by itself is not built either: a scene reads its tables
    model_config = ConfigDict(frozen=True, extra="forbid", defer_build=True)

    if not TYPE_CHECKING:  # type checkers derive it from the keys

        def __init__(self, /, **values: Any) -> None:
            """A table by its keys.

            Raises:
                SceneError: one line for every problem there is.
            """
            try:
                super().__init__(**values)
            except ValidationError as error:
                name = type(self).__name__
                lines = problems(error, values, type(self))
                raise SceneError("\n".join(f"{name}: {line}" for line in lines)) from None

        __init__.__pydantic_base_init__ = True  # tables within it report to it

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and dict(self) == dict(other)


def refusal(key: str, words: str) -> PydanticCustomError:
    """What a table raises that compares several of its keys: `words`, said of `key`."""
    return PydanticCustomError("refusal", "{words}", {"key": key, "words": words})


def _pair(value: Any) -> Any:
    """One number for both axes, or [x, y]."""
    if isinstance(value, (list, tuple)):
        if len(value) != 2:
            raise ValueError("must be one number, or two: [x, y]")
        return value
    return (value, value)


def _pair_schema(**bounds: float) -> WithJsonSchema:
    number = {"type": "number", **bounds}
    pair = {"title": "[x, y]", "type": "array", "items": number, "minItems": 2, "maxItems": 2}
    return WithJsonSchema({"anyOf": [number, pair]})


def _not_tiny(value: float) -> float:
    if value < SMALLEST:
        raise PydanticCustomError("tiny", "is too close to 0: must be {least} or more", _LEAST)
    return value


def _without_control(text: str) -> str:
    if found := _CONTROL.search(text):
        where = {"code": f"U+{ord(found[0]):04X}", "place": found.start() + 1}
        words = "has a control character, {code}, at place {place}: remove it"
        raise PydanticCustomError("control", words, where)
    return text


_LEAST = {"least": f"{SMALLEST:g}"}
# strict: text and true/false are not numbers
Real = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=-LARGEST, le=LARGEST)]
Angle = Annotated[Real, Field(ge=-LARGEST_ANGLE, le=LARGEST_ANGLE), SI("rad")]
Positive = Annotated[Real, Field(gt=0), AfterValidator(_not_tiny)]
NotNegative = Annotated[Real, Field(ge=0)]
Whole = Annotated[int, Field(strict=True)]
Flag = Annotated[bool, Field(strict=True)]
Text = Annotated[str, Field(strict=True), AfterValidator(_without_control)]
RealPair = Annotated[tuple[Real, Real], BeforeValidator(_pair), _pair_schema()]
PositivePair = Annotated[
    tuple[Positive, Positive], BeforeValidator(_pair), _pair_schema(exclusiveMinimum=0)
]
NotNegativePair = Annotated[
    tuple[NotNegative, NotNegative], BeforeValidator(_pair), _pair_schema(minimum=0)
]


def refuse_unless_one(table: Table, keys: Sequence[str]) -> str:
    """Refuse a table unless one of these keys is given, and none of the others; that key."""
    given = [key for key in keys if getattr(table, key) not in (None, ())]
    if len(given) != 1:
        found = f"not {' and '.join(given)}" if given else "none is there"
        words = f"give one of {', '.join(keys[:-1])} and {keys[-1]}: {found}"
        raise refusal(given[-1] if given else keys[0], words)
    return given[0]


def refuse_other_length(key: str, values: Sequence[Any], count: int, what: str) -> None:
    """Refuse a key unless it has one value for each of `count` things called `what`."""
    if not values:
        raise refusal(key, f"must not be empty: give {count}, one for each {what}, or leave it out")
    if len(values) != count:
        raise refusal(key, f"has {len(values)} values: must have {count}, one for each {what}")
