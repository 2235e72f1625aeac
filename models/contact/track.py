"""One track with its weights: the options contact, rolling resistance and offset in one place.

`advance` and `reaction` are what a unit calls; without options they are those of `weights`, and
none of the modules for events is imported.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from .. import weights as points
from ..weights import Weights


class Moved(NamedTuple):
    """State at the end of a communication step, all of it lists of N numbers for JSON.

    Attributes:
        angles, speeds: in the rotor [rad, rad/s].
        contacts: 1.0 where a weight lastingly touches the next one along increasing angle.
        impulse: of the collisions in this step on the rotor, in the rotor frame at the step's end
            [N s]; what is not in the force of `reaction`.
        events: collisions, contacts that opened, weights that stuck or broke away.
    """

    angles: list[float]
    speeds: list[float]
    contacts: list[float]
    impulse: complex = 0j
    events: int = 0


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
        for name in ("weight_radius", "rolling_resistance"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                raise ValueError(f"{name} = {value!r}: must be a finite number, 0 or more")
        if not 0.0 <= self.restitution <= 1.0:
            raise ValueError(f"restitution = {self.restitution!r}: must be within 0 to 1")
        if not cmath.isfinite(self.offset):
            raise ValueError(f"offset = {self.offset!r}: must be finite")
        count, track = self.weights.count, self.weights.track_radius
        room = track * math.sin(math.pi / count) if count > 1 else track
        if self.weight_radius > room * (1.0 + 1e-12):
            raise ValueError(
                f"weight_radius = {self.weight_radius!r} m: {count} weights do not fit on a track "
                f"of radius {track!r} m, the largest that fit have {room:.6g} m"
            )

    @cached_property
    def alpha(self) -> float:
        """Half the angle between weights that touch [rad]."""
        return math.asin(min(1.0, self.weight_radius / self.weights.track_radius))

    @cached_property
    def eventful(self) -> bool:
        """True when weights can collide or stick."""
        touching = self.weight_radius > 0.0 and self.weights.count > 1
        return touching or self.rolling_resistance > 0.0


def static_moment(track: Track, angles: Sequence[float]) -> complex:
    """Static moment about the plane's centre, sum m (e + R e^{i theta}), rotor frame [kg m]."""
    return points.static_moment(track.weights, angles) + track.weights.added_mass * track.offset


def first_contacts(track: Track, angles: Sequence[float], speeds: Sequence[float]) -> list[float]:
    """`contacts` of a fresh start: weights that touch and move alike, whatever drives them.

    Without them the first force would be that of weights that do not press on each other.

    Raises:
        ValueError: weights overlap.
    """
    none = [0.0] * track.weights.count
    if not track.alpha or track.weights.count < 2:
        return none
    from .ring import TOUCH, Ring

    ring = Ring(track, angles, speeds, none)
    following = [*ring.v[1:], ring.v[0]]
    for k, (rate, after) in enumerate(zip(ring.v, following, strict=True)):
        ring.joined[k] = rate == after and ring.gap(k) <= TOUCH
    return ring.state()[2]


def advance(
    track: Track,
    angles: Sequence[float],
    speeds: Sequence[float],
    contacts: Sequence[float],
    signal: Sequence[complex],
    speed: float,
    spin_up: float,
    step: float,
) -> Moved:
    """Move every weight over one communication step.

    Args:
        angles, speeds, contacts: state, see `Moved`; `contacts` all 0.0 for a fresh start.
        signal: acceleration of the plane's centre in the rotor frame at the start of the step and
            its derivatives of order 1 to 3 [m/s^2, m/s^3, ...].
        speed, spin_up: of the rotor at the start of the step, and w' [rad/s, rad/s^2].
        step: length of the step [s].

    Raises:
        ArithmeticError: the input is not finite, or events do not come to an end.
        ValueError: weights overlap.
    """
    if track.offset:
        from .resistance import shifted

        signal = shifted(signal, track.offset, speed, spin_up)
    if track.eventful:
        from .events import Mover
        from .ring import Ring

        ring = Ring(track, angles, speeds, contacts)
        mover = Mover(ring, signal, speed, spin_up)
        mover.run(step)
        turned = step * (speed + 0.5 * spin_up * step)
        impulse = mover.impulse * cmath.rect(1.0, -turned)
        return Moved(*ring.state(), impulse, mover.events)
    moved = points.advance(track.weights, angles, speeds, signal, spin_up, step)
    return Moved(*moved, list(contacts))


def reaction(
    track: Track,
    angles: Sequence[float],
    speeds: Sequence[float],
    contacts: Sequence[float],
    acceleration: complex,
    slope: complex,
    speed: float,
    spin_up: float,
) -> tuple[complex, complex]:
    """Residual force on the rotor in the rotor frame and its slope, without impulses.

    As `weights.reaction`, with the accelerations that contacts and sticking leave, and with the
    force -N m (i w' - w^2) e of the weights' mass off the centre.

    Returns:
        F [N] and dF/dt [N/s], xi + i eta.
    """
    offset = track.offset
    if offset:
        whirl = 1j * spin_up - speed * speed
        acceleration += whirl * offset
        slope -= 2.0 * speed * spin_up * offset
    if track.eventful:
        from .ring import Ring

        ring = Ring(track, angles, speeds, contacts)
        force, force_slope = ring.reaction(acceleration, slope, speed, spin_up)
    else:
        force, force_slope = points.reaction(
            track.weights, angles, speeds, acceleration, slope, speed, spin_up
        )
    if offset:
        carried = track.weights.added_mass * offset
        force -= carried * whirl
        force_slope += 2.0 * speed * spin_up * carried
    return force, force_slope
