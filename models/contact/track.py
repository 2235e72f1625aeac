"""A track and the weights on it: the parameters, and what follows from them alone."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, replace
from functools import cached_property

from ..ranges import demand_all
from ..weights import Weights
from .spacing import fits, half_angle, largest_radius

TOUCH = 1e-11  # rad: neighbours this close collide together


@dataclass(frozen=True)
class Track:
    """Weights on a track, with the options that a scene may switch on.

    Attributes:
        weights: as point weights.
        weight_radius: r [m]; 0: they pass through each other.
        restitution: of a collision of two weights with the rotor held, 0 to 1.
        rolling_resistance: mu, resistance over load; 0: none.
        offset: of the track's centre from the plane's, rotor frame, xi + i eta [m].

    Raises:
        ValueError: a value is out of its range, or the weights do not fit on the track.
    """

    weights: Weights
    weight_radius: float = 0.0
    restitution: float = 0.0
    rolling_resistance: float = 0.0
    offset: complex = 0j

    def __post_init__(self) -> None:
        demand_all(self, "weight_radius rolling_resistance", least=0.0)
        object.__setattr__(self, "weights", replace(self.weights, radius=self.weight_radius))
        if not 0.0 <= self.restitution <= 1.0:
            raise ValueError(f"restitution = {self.restitution!r}: must be within 0 to 1")
        if not cmath.isfinite(self.offset):
            raise ValueError(f"offset = {self.offset!r}: must be finite")
        count, track = self.weights.count, self.weights.track_radius
        if not fits(count, self.weight_radius, track):
            raise ValueError(
                f"weight_radius = {self.weight_radius!r} m: {count} weights do not fit on a track "
                f"of radius {track!r} m, the largest that fit have "
                f"{largest_radius(count, track):.6g} m"
            )

    @cached_property
    def alpha(self) -> float:
        """Half the angle between weights that touch [rad]."""
        return half_angle(self.weight_radius, self.weights.track_radius)

    @cached_property
    def solid(self) -> bool:
        """True when there are weights that can meet."""
        return self.alpha > 0.0 and self.weights.count > 1

    @cached_property
    def full(self) -> bool:
        """True when the weights fill the track: each touches both neighbours for ever."""
        count = self.weights.count
        return self.solid and count * self.alpha >= math.pi - count * TOUCH

    @cached_property
    def grip(self) -> float:
        """mu/(kappa R): resistance at rolling over load, per angle [1/m]."""
        return -self.rolling_resistance * self.weights.lever

    @cached_property
    def eventful(self) -> bool:
        """True when weights can collide or stick."""
        touching = self.weight_radius > 0.0 and self.weights.count > 1
        return touching or self.rolling_resistance > 0.0
