"""What a unit calls: motion of a track's weights over a step, and their force on the rotor.

Without contact, resistance and offset these are the functions of `weights`.
"""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from typing import NamedTuple

from .. import quintic_weights
from .. import weights as points
from ..spin import STEADY, Rates
from .centre import CentreMotion, Instant, shifted, turned
from .events import EventStepper, run
from .groups import ring_reaction
from .ring import as_given, gap, put_in_order
from .track import TOUCH, Track


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
    if not track.solid:
        return none
    weights = put_in_order(track, angles, speeds, none)
    rate, n = weights.angle_rate, weights.count
    for k in range(n):
        weights.joined[k] = rate[k] == rate[(k + 1) % n] and gap(weights, k) <= TOUCH
    return as_given(weights)[2]


def advance(
    track: Track,
    angles: Sequence[float],
    speeds: Sequence[float],
    contacts: Sequence[float],
    signal: Sequence[complex],
    rotor_speed: float,
    angular_acceleration: float,
    step: float,
    rates: Rates = STEADY,
) -> Moved:
    """Move every weight over one communication step.

    Args:
        angles, speeds, contacts: state, see `Moved`; `contacts` all 0.0 for a fresh start.
        signal: as of `weights.advance`, of the plane's centre.
        rotor_speed: at the start of the step [rad/s].
        angular_acceleration, step: w' [rad/s^2], and the length of the step [s].
        rates: derivatives of w' of order 1 to 3 at the start of the step [rad/s^3, ...].

    Raises:
        ArithmeticError: the input is not finite, or events do not come to an end.
        ValueError: weights overlap, or they can touch or stick and w' is not constant.
    """
    if track.offset:
        signal = shifted(signal, track.offset, rotor_speed, angular_acceleration, rates)
    if not track.eventful:
        moved = points.advance(
            track.weights, angles, speeds, signal, angular_acceleration, step, rates
        )
        return Moved(*moved, list(contacts))
    if rates != STEADY:
        raise ValueError(
            f"der(acceleration) = {rates[0]!r} rad/s3: must be 0 for weights that touch or stick, "
            "as all its derivatives"
        )
    motion = CentreMotion(signal, rotor_speed, angular_acceleration)
    stepper = EventStepper(put_in_order(track, angles, speeds, contacts), motion)
    run(stepper, step)
    impulse = stepper.impulse * cmath.rect(1.0, -turned(motion, step))
    return Moved(*as_given(stepper.weights), impulse, stepper.events)


def reaction(
    track: Track,
    angles: Sequence[float],
    speeds: Sequence[float],
    contacts: Sequence[float],
    acceleration: complex,
    slope: complex,
    rotor_speed: float,
    angular_acceleration: float,
    change: float = 0.0,
) -> tuple[complex, complex]:
    """Residual force on the rotor in the rotor frame and its slope, without impulses.

    As `weights.reaction`, with the accelerations that contacts and sticking leave, and with the
    force -N m (i w' - w^2) e of the weights' mass off the centre.

    Returns:
        F [N] and dF/dt [N/s], xi + i eta.
    """
    offset = track.offset
    if offset:
        whirl = 1j * angular_acceleration - rotor_speed * rotor_speed
        acceleration += whirl * offset
        slope -= 2.0 * rotor_speed * angular_acceleration * offset
        slope += 1j * change * offset
    if track.eventful:
        weights = put_in_order(track, angles, speeds, contacts)
        now = Instant(acceleration, slope, rotor_speed, angular_acceleration)
        force, force_slope = ring_reaction(weights, now)
    else:
        force, force_slope = points.reaction(
            track.weights, angles, speeds, acceleration, slope, rotor_speed, angular_acceleration,
            change,
        )  # fmt: skip
    if offset:
        carried = track.weights.added_mass * offset
        force -= carried * whirl
        force_slope += 2.0 * rotor_speed * angular_acceleration * carried
        force_slope -= 1j * change * carried
    return force, force_slope


def reaction_second(
    track: Track,
    angles: Sequence[float],
    speeds: Sequence[float],
    motion: quintic_weights.Motion,
    rotor_speed: float,
    spin_up: Rates,
) -> complex:
    """Second derivative of `reaction` of point weights; arguments as `quintic_weights` has them.

    motion: of the plane's centre.
    """
    w, (w1, w2, w3), offset = rotor_speed, spin_up, track.offset
    bent = complex(-2.0 * (w1 * w1 + w * w2), w3) * offset  # ((i w' - w^2) e)''
    centre = (
        motion[0] + complex(-w * w, w1) * offset,
        motion[1] + complex(-2.0 * w * w1, w2) * offset,
        motion[2] + bent,
    )
    second = quintic_weights.reaction_second(track.weights, angles, speeds, centre, w, spin_up)
    return second - track.weights.added_mass * bent
