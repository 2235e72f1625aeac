"""The [[check]] tables of a scene.  A new kind is one class here and one member of `AnyCheck`."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, field_validator, model_validator

from .quantities import Positive, Real, Table, Text, Unit, Whole, refusal
from .run import FEWEST_STEPS

SpeedRange = Annotated[tuple[Positive, Positive], Unit("rad/s")]


def _rising(value: tuple[float, float] | None) -> tuple[float, float] | None:
    if value is not None and value[0] >= value[1]:
        raise ValueError("must be [low, high] with low less than high")
    return value


class LiquidWindowCheck(Table):
    """Window of a liquid balancer against Dubovik 2006 (6), (10), (11).

    Attributes:
        speeds: how many speeds across the window compare the bending.
        up_to: where the comparison ends when the window has no upper limit [rad/s]; default: five
            times the lower one.
    """

    kind: Literal["liquid_window"]
    speeds: Annotated[Whole, Field(ge=2, le=10_000)] = 20
    up_to: Annotated[Positive | None, Unit("rad/s")] = None


class CriticalSpeedsCheck(Table):
    """Every boundary of stable balancing within a range, co-simulated against Floquet.

    Attributes:
        case: what the rows call it.
        set: values replaced in the scene, as by `Scene.replace`.
        range: speeds [rad/s].
        growth_runs: speeds at which the growth rate is also fitted to a run in time [rad/s].
        runs_from_rest: speeds at which a run from rest must end as predicted [rad/s].
    """

    kind: Literal["critical_speeds"]
    case: Text = ""
    set: dict[str, Any] = Field(default_factory=dict)
    range: SpeedRange
    growth_runs: Annotated[tuple[Positive, ...], Unit("rad/s")] = ()
    runs_from_rest: Annotated[tuple[Positive, ...], Unit("rad/s")] = ()

    _range_rises = field_validator("range")(_rising)


class TableCheck(Table):
    """Every row of a table of Filimonikhina 2017, with the scene's mass, frequency and radius."""

    kind: Literal["filimonikhina_table"]
    table: Literal[1, 2]


class CapacityCheck(Table):
    """What weights of finite size leave of an unbalance, Goncharov 2017 (5): 0, then U - S.

    Attributes:
        points: unbalances from 0 on.
        up_to: the largest one, in capacities S.
    """

    kind: Literal["capacity"]
    points: Annotated[Whole, Field(ge=2, le=1000)] = 13
    up_to: Positive = 1.2


class SizesCheck(Table):
    """Best sizes of 1 to 8 balls or rollers: Goncharov 2017, Table 1."""

    kind: Literal["goncharov_table"]


class RankingCheck(Table):
    """Which number of balls or rollers settles first: Goncharov 2017, Fig. 7, co-simulated.

    Attributes:
        starts: random starts for every number of weights.
        most: numbers from 2 to this one.
        width: of the space along the axis [m]: height of rollers, largest diameter of balls.
        halved: starts of every number repeated with steps of half the length.
    """

    kind: Literal["goncharov_ranking"]
    starts: Annotated[Whole, Field(ge=6, le=100_000)] = 200
    most: Annotated[Whole, Field(ge=2, le=64)] = 8
    width: Annotated[Positive | None, Unit("m")] = None
    halved: Annotated[Whole, Field(ge=1, le=1000)] = 4


class SlowRootCheck(Table):
    """Decay of runs against the slow root, Goncharov 2017 (1), and the exact spectrum.

    Attributes:
        starts: for every number of weights, two groups that face each other.
        most: numbers from 2 to this one.
        width: as `RankingCheck`.
        unbalance, revolutions: instead of the scene's [kg m, 1].
    """

    kind: Literal["slow_root"]
    starts: Annotated[Whole, Field(ge=1, le=100_000)] = 20
    most: Annotated[Whole, Field(ge=2, le=64)] = 8
    width: Annotated[Positive | None, Unit("m")] = None
    unbalance: Annotated[Positive | None, Unit("kg m")] = None
    revolutions: Positive | None = None


class LargestSpreadCheck(Table):
    """Settling from the positions of largest p, Goncharov 2017 (10), (13), where weights touch.

    Attributes:
        most, width: as `RankingCheck`.
        step: by which the unbalance changes, either way [of the capacity].
        revolutions: instead of the scene's.
    """

    kind: Literal["largest_spread"]
    most: Annotated[Whole, Field(ge=2, le=64)] = 8
    width: Annotated[Positive | None, Unit("m")] = None
    step: Annotated[Positive, Field(le=0.1)] = 0.001
    revolutions: Positive | None = None


class ContactOrderCheck(Table):
    """Order of convergence in the communication step of a scene with weights that touch.

    Attributes:
        case: what the rows call it.
        set: values replaced in the scene, as by `Scene.replace`.
        order, within: what is expected, and how near.
        steps, reference: communication steps a revolution of the runs, and of the exact one.
        runs, shift: runs, and how far each weight starts further on over all of them [rad].
    """

    kind: Literal["contact_order"]
    case: Text
    set: dict[str, Any] = Field(default_factory=dict)
    order: Positive
    within: Positive = 0.3
    steps: Annotated[tuple[Annotated[Whole, Field(ge=FEWEST_STEPS)], ...], Field(min_length=2)] = (
        20,
        40,
        80,
        160,
    )
    reference: Whole = 1280
    runs: Annotated[Whole, Field(ge=1, le=1000)] = 1
    shift: Annotated[tuple[Real, ...], Unit("rad")] = ()

    @model_validator(mode="after")
    def _reference_is_finest(self) -> ContactOrderCheck:
        if len(set(self.steps)) < len(self.steps):
            raise refusal("steps", "must all differ")
        if self.reference <= max(self.steps):
            raise refusal("reference", f"must be above the finest of the steps, {max(self.steps)}")
        return self


AnyCheck = Annotated[
    LiquidWindowCheck
    | CriticalSpeedsCheck
    | TableCheck
    | CapacityCheck
    | SizesCheck
    | RankingCheck
    | SlowRootCheck
    | LargestSpreadCheck
    | ContactOrderCheck,
    Field(discriminator="kind"),
]
