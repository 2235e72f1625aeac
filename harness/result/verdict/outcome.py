"""What can come of a run: every outcome, what it means for balancing, and what to do about it."""

from __future__ import annotations

from enum import Enum


class Outcome(str, Enum):
    """What a run comes to at one speed."""

    BALANCED = "balanced"
    LOWERED = "vibration lowered"
    OVER_CAPACITY = "over capacity"
    TOO_HEAVY = "too heavy"
    OUT_OF_REACH = "out of reach"
    OFF_CENTRE = "track off centre"
    NOT_ROUND = "race not round"
    BELOW_CRITICAL = "below critical"
    UNSTABLE = "unstable"
    NEUTRAL = "neutral"
    UNDECIDED = "undecided"
    ANOTHER_MOTION = "another steady motion"
    GRAVITY_SWING = "gravity swing"
    STUCK = "stuck"
    TOGETHER = "weights together"
    RAISED = "vibration raised"
    NOT_SETTLED = "not settled yet"
    SPEED_CHANGES = "speed changes"
    CANNOT_TELL = "cannot tell"
    STANDSTILL = "standstill"
    NO_RESPONSE = "no response"
    NO_UNBALANCE = "no unbalance"
    NO_BALANCER = "no balancer"
    NOT_RECORDED = "not recorded"

    @property
    def balanced(self) -> bool | None:
        """Whether balancers balance the rotor; None where this outcome does not say."""
        if self is Outcome.BALANCED:
            return True
        return None if self in _SILENT else False

    @property
    def remedy(self) -> str:
        """What to do; empty where nothing is to be done, or the reason says it."""
        return _REMEDIES.get(self, "")


_SILENT = {
    Outcome.LOWERED,
    Outcome.UNDECIDED,
    Outcome.CANNOT_TELL,
    Outcome.STANDSTILL,
    Outcome.NO_RESPONSE,
    Outcome.NO_UNBALANCE,
    Outcome.NO_BALANCER,
    Outcome.NOT_RECORDED,
}
_REMEDIES = {
    Outcome.OVER_CAPACITY: "use more or heavier weights, or a larger track",
    Outcome.TOO_HEAVY: "use lighter weights, or one more",
    Outcome.OUT_OF_REACH: "use a balancer in a second plane",
    Outcome.OFF_CENTRE: "centre the tracks of the weights",
    Outcome.NOT_ROUND: "take a rounder race",
    Outcome.BELOW_CRITICAL: "run above the critical speed",
    Outcome.UNSTABLE: "see `autobalancer speeds` for the speeds that balance",
    Outcome.NEUTRAL: "give the rotor and its balancers damping",
    Outcome.UNDECIDED: "check the unbalance, the drag and the mass of the weights",
    Outcome.ANOTHER_MOTION: "use more drag, or another start",
    Outcome.GRAVITY_SWING: "use a vertical axis, a higher speed or more drag",
    Outcome.STUCK: "use a harder or cleaner track",
    Outcome.RAISED: "run faster, or use less liquid",
    Outcome.SPEED_CHANGES: "keep one speed for 10 revolutions or more",
    Outcome.CANNOT_TELL: "run longer, or look at the motion with --weights",
}
