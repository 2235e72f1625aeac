"""The [[check]] tables of a scene.  A new kind is one class here and one member of `AnyCheck`."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field

from .quantities import SI, Positive, Table, Text, Whole


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


class CapacityCheck(Table):
    """What weights of finite size leave of an unbalance, Goncharov 2017 (5): 0, then U - S."""

    kind: Literal["capacity"]
    points: Annotated[Whole, Field(ge=2, le=1000)] = 13
    """Unbalances from 0 on."""
    up_to: Positive = 1.2
    """The largest of them, in capacities S."""


class PaperCheck(Table):
    """What one bundled scene compares with its source, in the numbers of the source:
    Tables 1 and 2 of Filimonikhina 2017; of Goncharov 2017 Table 1 (`goncharov_table`), Fig. 7
    (`goncharov_ranking`), (1) (`slow_root`), (10) and (13) (`largest_spread`); the order of
    convergence of two balls that touch; the rig of Rodrigues et al. 2010."""

    kind: Literal[
        "filimonikhina_table",
        "goncharov_table",
        "goncharov_ranking",
        "slow_root",
        "largest_spread",
        "contact_order",
        "rig",
    ]


class RuntimesCheck(Table):
    """Native units against the units in Python, to rounding."""

    kind: Literal["runtimes"]
    revolutions: Positive = 20.0
    """Length of the two runs."""


class SommerfeldCheck(Table):
    """A motor before the rotor's resonance: caught below the limit torque, passing above it."""

    kind: Literal["sommerfeld"]
    within: Annotated[Positive, Field(lt=1.0)] = 0.01
    """How far below and above the limit the motors are, as a share of it."""


AnyCheck = Annotated[
    LiquidWindowCheck
    | CriticalSpeedsCheck
    | CapacityCheck
    | PaperCheck
    | RuntimesCheck
    | SommerfeldCheck,
    Field(discriminator="kind"),
]
