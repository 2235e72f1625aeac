"""What a ruling looks at, and what it says."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from .known import Known
from .outcome import Outcome
from .record import Record
from .seen import Vibration, Weights
from .steady import BALANCED
from .words import seconds

MARGIN = 3.0  # of a deviation: what small motions may exceed their rule by
SAFE = 1.3  # of a time: the same
FEWEST_TIME_CONSTANTS = 5.0  # of a run that shows a steady motion
MANY_TIME_CONSTANTS = 20.0  # of a run that would have settled by then
STEADY_SIZE = 0.1  # of a vibration: what it may change by between two windows
DOUBT = "; how long the weights need is not known"  # a longer run may tell
OFFSETS_TELL = 1.3  # of the limit: the motion that an offset leaves is known so well
SWING = 0.02  # rad: smaller swings by gravity are no reason


@dataclass(frozen=True)
class Ruling:
    """An outcome with its reason.

    Attributes:
        outcome: what it is.
        reason: why, without full stop.
        seconds: further time at this speed after which the rotor is balanced [s]; None: not known.
        left_behind: speed in space of the weights that are [rad/s], and the nearest natural
            frequency [rad/s].
    """

    outcome: Outcome
    reason: str = ""
    seconds: float | None = None
    left_behind: tuple[float, float] | None = None


@dataclass(frozen=True, eq=False)
class Case:
    """All that a ruling looks at.

    Attributes:
        known: facts at this speed.
        record: since the last change of speed or unbalance.
        called: what the balancers are called.
        together: whether identical weights share one angle, which the run cannot part.
        now, before: vibration in the last window and in the one before; None: too short.
        weights: what they do in both windows together; None: not recorded, or too short.
        alone: vibration without balancers [m]; of a rotor without unbalance that by the weights
            alone, all on one side.
        measured_by_weights: whether it is the latter.
    """

    known: Known
    record: Record
    called: str
    together: bool
    now: Vibration | None
    before: Vibration | None
    weights: Weights | None
    alone: float
    measured_by_weights: bool = False

    @property
    def limit(self) -> float:
        """Vibration up to which the rotor is balanced [m]."""
        return BALANCED * self.alone

    @property
    def gravity(self) -> float:
        """Across the axis [m/s^2]."""
        return self.known.scene.operation.gravity

    @cached_property
    def falls(self) -> tuple[float, float]:
        """Largest swing of a weight by gravity [rad], and rate at which it drags one back [rad/s].

        A weight swings by g/(kappa R w sqrt(w^2 + d^2)) and falls behind at the rate
        g^2/(2 w (kappa R)^2 (w^2 + d^2)), see equations.md.
        """
        table, w = self.known.table, self.known.speed
        fall, square = self.gravity / table.kappa_radius, w * w + table.damping_rate**2
        swing, drift = fall / (w * np.sqrt(square)), fall**2 / (2.0 * w * square)
        return float(swing.max()), float(drift.max())

    @property
    def shift(self) -> float:
        """About how far gravity drags weights out of balance [rad]; 0 without gravity."""
        drift = self.falls[1]
        return drift * min(self.known.time_constant, 1e300) if drift else 0.0

    @property
    def is_moved_by_gravity(self) -> bool:
        """Whether gravity swings or shifts weights by more than `SWING`."""
        return max(self.falls[0], self.shift) > SWING


def unsettled(case: Case) -> str:
    """How a reason of a run that has not settled begins."""
    begin, constant = float(case.record.time[0]), case.known.time_constant
    since = f" since the change at {seconds(begin, 4)}" if begin > 0.0 else ""
    rule = f", time constant {seconds(constant)}" if math.isfinite(constant) else ""
    if case.known.is_unstable:
        rule = ", the weights leave a position of balance that is unstable for a stable one"
    return f"not settled yet{since}{rule}"
