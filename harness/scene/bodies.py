"""Bodies that carry a rotor or hang on it, in a scene."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, model_validator

from ...models.bodies import GROUND, Body, Foot
from .nested import Nested
from .patterns import BODY
from .quantities import (
    SI,
    NotNegative,
    NotNegativePair,
    Positive,
    PositivePair,
    Real,
    Table,
    Text,
    refusal,
)


class FootTable(Table):
    """A spring and a damper between a body and what it stands on."""

    position: Annotated[Real, SI("m")] = 0.0
    """Along the axis, from support 1; of a planar rotor none."""
    stiffness: Annotated[PositivePair, SI("N/m")]
    """[x, y]."""
    damping: Annotated[NotNegativePair, SI("N s/m")] = (0.0, 0.0)
    """[x, y]."""
    loss_factor: Annotated[PositivePair | None, SI("")] = None
    """Of rubber, [x, y]; `stiffness` is then the dynamic one at `loss_frequency`."""
    loss_frequency: Annotated[Positive | None, SI("rad/s")] = None
    """Frequency at which stiffness and loss factor were measured, such as "50 Hz"."""

    @model_validator(mode="after")
    def _is_rubber(self) -> FootTable:
        refuse_half_of_rubber(self.loss_factor, self.loss_frequency, "loss_factor")
        return self


def refuse_half_of_rubber(factor: object, frequency: object, key: str) -> None:
    """Raise for a loss factor without its frequency, or the other way round."""
    needed = f"{key.removesuffix('loss_factor').replace('support_', '')}loss_frequency"
    if factor is None and frequency is not None:
        raise refusal(needed, f"belongs to {key}: give both, or none")
    if frequency is None and factor is not None:
        words = f'requires {needed}, at which it was measured, such as "50 Hz"'
        raise refusal(key, words)


class Handle(Table):
    """Where a hand holds a body: vibration there is an answer."""

    name: Text
    """What the answer calls it."""
    position: Annotated[Real, SI("m")] = 0.0
    """Along the axis, from support 1."""


class BodyTable(Table):
    """A body that does not turn: a tub, a casing, a base, an absorber, the rest of a hand tool."""

    name: Annotated[Text, Field(pattern=BODY)]
    """What outputs call it: a letter first, then letters, digits, _ and -, at most 32; unique."""
    mass: Annotated[Positive, SI("kg")]
    """Without the rotor."""
    transverse_inertia: Annotated[NotNegative, SI("kg m^2")] = 0.0
    """About a transverse axis through its centre of mass; above 0 unless the rotor is planar."""
    center: Annotated[Real, SI("m")] = 0.0
    """Centre of mass along the axis, from support 1."""
    feet: tuple[Nested[FootTable], ...] = ()
    """What it stands on; none: the body that carries the rotor is free, as in hands."""
    on: Text = GROUND
    """What it stands on: "ground", "rotor" (an absorber), or the name of another body."""
    free: Literal["xy", "x", "y"] = "xy"
    """Axes along which it moves; along the other one its feet are rigid."""
    handles: tuple[Nested[Handle], ...] = ()
    """Where hands hold it."""

    @model_validator(mode="after")
    def _is_held(self) -> BodyTable:
        if self.free != "xy" and not self.feet:
            raise refusal("free", f"requires feet that hold the body along {self.free}")
        return self

    def build(self) -> Body:
        """For the models."""
        feet = tuple(Foot(foot.position, foot.stiffness, foot.damping) for foot in self.feet)
        mass, inertia = self.mass, self.transverse_inertia
        return Body(self.name, mass, inertia, self.center, feet, self.on, self.free)


def bodies_inside(document: dict[str, Any]) -> dict[str, Any]:
    """A document whose [[body]] tables stand in its rotor's table, as `bodies`."""
    rotor = document.get("rotor")
    if "body" not in document or not isinstance(rotor, dict) or "bodies" in rotor:
        return document
    kept = {key: value for key, value in document.items() if key != "body"}
    return {**kept, "rotor": {**rotor, "bodies": document["body"]}}
