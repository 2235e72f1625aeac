"""The [[check]] tables of a scene.  A new kind is a word of `PlainCheck`."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field

from .nested import Nested
from .quantities import SI, Positive, Table, Text


def _rising(value: tuple[float, float]) -> tuple[float, float]:
    if value[0] >= value[1]:
        raise ValueError("must be [low, high] with low less than high")
    return value


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
    runs_from_rest: Annotated[tuple[Positive, ...], SI("rad/s")] = ()
    """Speeds at which a run from rest must end as predicted."""
    published: Annotated[tuple[Positive, ...], SI("rad/s")] = ()
    """Boundaries that the scene's source gives; the nearest co-simulated one is compared."""
    published_within: Positive = 1e-3
    """Of a published one: to what it could be read, or what its theory leaves out."""


class PlainCheck(Table):
    """A theory or a source, in its own numbers: the window of a liquid balancer, Dubovik 2006 (6),
    (10), (11), of a planar rotor, alike in x and y; the unstable band of a ring of liquid on such
    a rotor (`ring_band`); what weights of finite size leave of an unbalance, Goncharov 2017 (5)
    (`capacity`); a motor before the rotor's resonance, caught below the limit torque and passing
    above it (`sommerfeld`). Of one bundled scene: Tables 1 and 2 of Filimonikhina 2017; of
    Goncharov 2017 Table 1 (`goncharov_table`), Fig. 7 (`goncharov_ranking`), (1) (`slow_root`),
    (10) and (13) (`largest_spread`); the rig of Rodrigues et al. 2010."""

    kind: Literal[
        "liquid_window",
        "ring_band",
        "capacity",
        "sommerfeld",
        "filimonikhina_table",
        "goncharov_table",
        "goncharov_ranking",
        "slow_root",
        "largest_spread",
        "rig",
    ]


AnyCheck = Nested[PlainCheck | CriticalSpeedsCheck]
