"""The [[check]] tables of a scene.  A new kind is one class here and one member of `AnyCheck`."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, model_validator

from .quantities import SI, Angle, Positive, Table, Text, Whole, refusal
from .run import FEWEST_STEPS


def _rising(value: tuple[float, float]) -> tuple[float, float]:
    if value[0] >= value[1]:
        raise ValueError("must be [low, high] with low less than high")
    return value


class LiquidWindowCheck(Table):
    """Window of a liquid balancer against Dubovik 2006 (6), (10), (11): a planar rotor, alike in x
    and y, with one liquid."""

    kind: Literal["liquid_window"]
    speeds: Annotated[Whole, Field(ge=2, le=10_000)] = 20
    """How many speeds across the window compare bending and phase."""
    up_to: Annotated[Positive | None, SI("rad/s")] = None
    """End of the comparison when the window has no upper limit; default: five times the lower."""


class CriticalSpeedsCheck(Table):
    """Every boundary of stable balancing within a range, co-simulated against Floquet: any scene
    whose weights can balance it."""

    kind: Literal["critical_speeds"]
    case: Text = ""
    """What the rows call it."""
    set: dict[str, Any] = Field(default_factory=dict)
    """Values replaced in the scene, as by `Scene.replace`: `{"weights.drag" = 0.1}`."""
    range: Annotated[tuple[Positive, Positive], AfterValidator(_rising), SI("rad/s")]
    """Lowest and highest speed at which boundaries are looked for."""
    growth_runs: Annotated[tuple[Positive, ...], SI("rad/s")] = ()
    """Speeds at which the growth rate is also fitted to a run in time."""
    runs_from_rest: Annotated[tuple[Positive, ...], SI("rad/s")] = ()
    """Speeds at which a run from rest must end as predicted."""
    published: Annotated[tuple[Positive, ...], SI("rad/s")] = ()
    """Boundaries that the scene's source gives; the nearest co-simulated one is compared."""
    published_within: Positive = 1e-3
    """Of a published one: to what it could be read, or what its theory leaves out."""


class TableCheck(Table):
    """Every row of a table of Filimonikhina 2017, with the scene's mass, frequency and radius."""

    kind: Literal["filimonikhina_table"]
    table: Literal[1, 2]
    """Which of them."""


class CapacityCheck(Table):
    """What weights of finite size leave of an unbalance, Goncharov 2017 (5): 0, then U - S."""

    kind: Literal["capacity"]
    points: Annotated[Whole, Field(ge=2, le=1000)] = 13
    """Unbalances from 0 on."""
    up_to: Positive = 1.2
    """The largest of them, in capacities S."""


class SizesCheck(Table):
    """Best sizes of 1 to 8 balls or rollers: Goncharov 2017, Table 1."""

    kind: Literal["goncharov_table"]


class NumbersCheck(Table):
    """Several numbers of weights in one space."""

    most: Annotated[Whole, Field(ge=2, le=64)] = 8
    """Numbers of weights from 2 to this one."""
    width: Annotated[Positive | None, SI("m")] = None
    """Space along the axis: height of rollers, largest diameter of balls; default: the weights'
    diameter."""


class RankingCheck(NumbersCheck):
    """Which number of balls or rollers settles first: Goncharov 2017, Fig. 7, co-simulated."""

    kind: Literal["goncharov_ranking"]
    starts: Annotated[Whole, Field(ge=6, le=100_000)] = 200
    """Random starts for every number of weights."""
    halved: Annotated[Whole, Field(ge=1, le=1000)] = 4
    """Starts of every number that are repeated with steps of half the length."""


class SlowRootCheck(NumbersCheck):
    """Decay of runs against the slow root, Goncharov 2017 (1), and the exact spectrum."""

    kind: Literal["slow_root"]
    starts: Annotated[Whole, Field(ge=1, le=100_000)] = 20
    """Random starts for every number of weights, two groups that face each other."""
    unbalance: Annotated[Positive | None, SI("kg m")] = None
    """Instead of the rotor's; default: the scene's."""
    revolutions: Positive | None = None
    """Length of a run; default: the scene's."""


class LargestSpreadCheck(NumbersCheck):
    """Settling from the positions of largest p, Goncharov 2017 (10), (13), where weights touch."""

    kind: Literal["largest_spread"]
    step: Annotated[Positive, Field(le=0.1)] = 0.001
    """Change of the unbalance, either way, in capacities S."""
    revolutions: Positive | None = None
    """Length of a run; default: the scene's."""


class ContactOrderCheck(Table):
    """Order of convergence in the communication step of a scene with weights that touch."""

    kind: Literal["contact_order"]
    case: Text
    """What the rows call it."""
    set: dict[str, Any] = Field(default_factory=dict)
    """Values replaced in the scene, as by `Scene.replace`."""
    order: Positive
    """Expected order of convergence."""
    within: Positive = 0.3
    """How near to it."""
    steps: Annotated[tuple[Annotated[Whole, Field(ge=FEWEST_STEPS)], ...], Field(min_length=2)] = (
        20,
        40,
        80,
        160,
    )
    """Communication steps a revolution of the runs, all different."""
    reference: Whole = 1280
    """Steps a revolution of the run that they are compared with: more than any of them."""
    runs: Annotated[Whole, Field(ge=1, le=1000)] = 1
    """Runs for every number of steps, from different starts."""
    shift: Annotated[tuple[Angle, ...], SI("rad")] = ()
    """How far each weight starts further on over all runs."""

    @model_validator(mode="after")
    def _reference_is_finest(self) -> ContactOrderCheck:
        if len(set(self.steps)) < len(self.steps):
            raise refusal("steps", "must all differ")
        if self.reference <= max(self.steps):
            raise refusal("reference", f"must be above the finest of the steps, {max(self.steps)}")
        return self


class RigCheck(Table):
    """The rig that Rodrigues, Champneys, Friswell and Wilson 2010 measured: a rigid rotor on two
    supports with two balls named `balls`; its first unbalance is the washers'."""

    kind: Literal["rig"]
    flexible: Text
    """Scene of the same rig with a shaft that bends: a file, or a bundled one."""


class RigFittedCheck(Table):
    """The same rig with all that was fitted to 1 and 3 washers, held against 0 to 4."""

    kind: Literal["rig_fitted"]


class RuntimesCheck(Table):
    """Native units against the units in Python, to rounding."""

    kind: Literal["runtimes"]
    revolutions: Positive = 20.0
    """Length of the two runs."""


class MeasuredErrorCheck(Table):
    """Errors of the scene's own run, measured by a finer one; every scene's with `--verify`."""

    kind: Literal["measured_error"]
    at_most: Positive = 0.01
    """Of a signal's range."""


class SommerfeldCheck(Table):
    """A motor before the rotor's resonance: caught below the limit torque, passing above it."""

    kind: Literal["sommerfeld"]
    within: Annotated[Positive, Field(lt=1.0)] = 0.01
    """How far below and above the limit the motors are, as a share of it."""


AnyCheck = Annotated[
    LiquidWindowCheck
    | CriticalSpeedsCheck
    | TableCheck
    | CapacityCheck
    | SizesCheck
    | RankingCheck
    | SlowRootCheck
    | LargestSpreadCheck
    | ContactOrderCheck
    | RigCheck
    | RigFittedCheck
    | RuntimesCheck
    | MeasuredErrorCheck
    | SommerfeldCheck,
    Field(discriminator="kind"),
]
