"""Tables and kinds of keys that rotors of several kinds have in a scene."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import AfterValidator, Field, ValidationInfo, model_validator
from pydantic_core import PydanticKnownError

from .bearing import Bearing
from .feeds import Feeds
from .nested import Nested
from .quantities import (
    SI,
    Angle,
    NotNegative,
    NotNegativePair,
    PositivePair,
    Real,
    Table,
    Text,
    Whole,
    refusal,
)


class Unbalance(Table):
    """Static moment at an axial position, at an angle in the rotor."""

    position: Annotated[Real, SI("m"), Feeds()]
    """Place along the axis, from support 1."""
    amount: Annotated[NotNegative, SI("kg m"), Feeds()]
    """Static moment, mass times eccentricity."""
    angle: Annotated[Angle, Feeds()] = 0.0
    """Direction in the rotor."""


Unbalances = tuple[Nested[Unbalance], ...]


class Slider(Table):
    """Dry friction in a support, in parallel with its spring, each axis for itself."""

    support: Annotated[Whole | Text, Feeds()] = 1
    """Number of the support, a planar rotor has one; or the name of a body's foot, such as
    "tub.foot[1]"."""
    limit: Annotated[NotNegativePair, SI("N"), Feeds("limit_{axis}")]
    """Force at which it slips; a number for both axes, or [x, y]."""
    stiffness: Annotated[PositivePair | None, SI("N/m"), Feeds("stiffness_{axis}")] = None
    """Of a spring in series with it; default: none, it is rigid."""
    free_stroke: Annotated[NotNegativePair | None, SI("m"), Feeds("free_stroke_{axis}")] = None
    """Way without force between both contacts of the damper, centred about rest; requires a
    stiffness, that of the contacts."""

    @model_validator(mode="after")
    def _has_contacts(self) -> Slider:
        if self.free_stroke and any(self.free_stroke) and self.stiffness is None:
            raise refusal("free_stroke", "requires stiffness (N/m), that of the damper's contacts")
        return self


Bearings = tuple[Nested[Bearing], ...]


Friction = Annotated[tuple[Nested[Slider], ...], Feeds("slider[{n}].")]


def _or_bearings(value: Any, info: ValidationInfo) -> Any:
    """A stiffness, which may be left out where bearings take its place."""
    # bearings that are wrong are not in the data: then nothing is missing beside them
    if value is None and not info.data.get("bearings", "wrong"):
        raise PydanticKnownError("missing")
    return value


OrBearings = AfterValidator(_or_bearings)


SupportStiffness = Annotated[
    tuple[PositivePair, PositivePair] | None,
    SI("N/m"),
    Feeds("support[{n}].stiffness_{axis}"),
    Field(validate_default=True),
    OrBearings,
]


DampingRatio = Annotated[NotNegativePair | None, SI("")]


SupportDamping = Annotated[
    tuple[NotNegativePair, NotNegativePair], SI("N s/m"), Feeds("support[{n}].damping_{axis}")
]
