"""The [operation], [coupling] and [run] tables of a scene."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator

from ...models.assembly import SpeedProfile
from .quantities import NotNegative, Positive, Real, Table, Text, Unit, Whole

DEFAULT_STEPS = 40  # a revolution: 1e-6 on the two-ball scene with cubic signals
FEWEST_STEPS = 4  # fewer do not resolve one revolution
LOOSEST_TOLERANCE = 0.1


class RunUp(Table):
    """Speed that rises linearly and then stays."""

    start: Annotated[NotNegative, Field(alias="from"), Unit("rad/s")]
    to: Annotated[Positive, Unit("rad/s")]
    seconds: Annotated[Positive, Unit("s")]


class Operation(Table):
    """How the rotor is driven: at a constant speed, or run up."""

    speed: Annotated[Positive | None, Unit("rad/s")] = None
    run_up: Annotated[RunUp | None, Field(validate_default=True)] = None

    @field_validator("run_up")
    @classmethod
    def _one_of_both(cls, value: RunUp | None, info: ValidationInfo) -> RunUp | None:
        if "speed" in info.data and (value is None) == (info.data["speed"] is None):
            both = "not both" if value else "neither is there"
            raise ValueError(f"give either speed (rad/s) or run_up: {both}")
        return value

    def profile(self) -> SpeedProfile:
        """Speed against time."""
        if self.run_up is not None:
            return SpeedProfile(self.run_up.start, self.run_up.to, self.run_up.seconds)
        assert self.speed is not None
        return SpeedProfile.constant(self.speed)


def _whole_choice(value: object) -> object:
    """Keep true and 1.0 from passing as 1."""
    if type(value) is not int:
        raise ValueError("must be one of 0 (held), 1 (linear), 3 (cubic Hermite)")
    return value


class Coupling(Table):
    """How the units exchange signals.

    Attributes:
        scheme: `auto` iterates, as often as the scene's loop gain asks for.
        tolerance: relative; the master picks and varies the step.
        steps_per_rev: communication steps a revolution; None with a tolerance.
        order: of the signals, 0 held, 1 linear, 3 cubic Hermite.
        corrections: corrector passes of `iterated`; None: until the loop has converged.
    """

    scheme: Literal["auto", "jacobi", "gauss-seidel", "compensated", "iterated"] = "auto"
    tolerance: Annotated[Positive | None, Field(le=LOOSEST_TOLERANCE)] = None
    steps_per_rev: Annotated[
        Whole | None, Field(ge=FEWEST_STEPS, le=1_000_000, validate_default=True)
    ] = None
    order: Annotated[Literal[0, 1, 3], BeforeValidator(_whole_choice)] = 3
    corrections: Annotated[Whole | None, Field(ge=0, le=100)] = None

    @field_validator("steps_per_rev")
    @classmethod
    def _one_of_both(cls, value: int | None, info: ValidationInfo) -> int | None:
        tolerance = info.data.get("tolerance")
        if value is not None and tolerance is not None:
            raise ValueError(f"give either steps_per_rev or tolerance = {tolerance:g}, not both")
        if value is None and tolerance is None:
            return DEFAULT_STEPS
        return value

    @field_validator("order")
    @classmethod
    def _compensated_is_cubic(cls, value: int, info: ValidationInfo) -> int:
        if value != 3 and info.data.get("scheme") == "compensated":
            raise ValueError('must be 3 with scheme = "compensated", which exchanges slopes')
        return value


class Initial(Table):
    """The rotor at the start: every station alike.  Default: at rest in the middle."""

    x: Annotated[Real, Unit("m")] = 0.0
    y: Annotated[Real, Unit("m")] = 0.0
    vx: Annotated[Real, Unit("m/s")] = 0.0
    vy: Annotated[Real, Unit("m/s")] = 0.0
    angle: Annotated[Real, Unit("rad")] = 0.0

    def items(self) -> list[tuple[str, float]]:
        """Names and values."""
        return list(self.model_dump().items())


class Run(Table):
    """How long, from where, and what is recorded (None: what the scene's units have to tell)."""

    revolutions: Positive = 20.0
    record: tuple[Text, ...] | None = None
    initial: Initial = Initial()
