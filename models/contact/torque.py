"""Torque of the weights on the rotor about the plane's centre, by Lagrange's equations.

About the track's centre it is the sum of b R^2 theta' - (kappa - 1) m (R + r) (r w' - R theta''):
drag, and what a body that rolls takes to turn.  Contacts between weights take no part: what one
gains of it the other loses.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..weights import Weights, along_track
from .centre import Instant
from .groups import ring_turning
from .ring import put_in_order
from .track import Track


def torque(
    track: Track,
    angles: Sequence[float],
    speeds: Sequence[float],
    contacts: Sequence[float],
    now: Instant,
    change: float,
    force: tuple[complex, complex],
) -> tuple[float, float]:
    """Torque of the weights on the rotor about the plane's centre and its slope, without impulses.

    Args:
        now: motion of the plane's centre, and of the rotor.
        change: w'' [rad/s^3].
        force: as `motion.reaction` gives it.

    Returns:
        [N m], [N m/s].
    """
    body, offset = track.weights, track.offset
    acceleration, slope, rotor_speed, spin_up = now
    whirl = 1j * spin_up - rotor_speed * rotor_speed
    whirl_slope = 1j * change - 2.0 * rotor_speed * spin_up
    centre = Instant(
        acceleration + whirl * offset, slope + whirl_slope * offset, rotor_speed, spin_up
    )
    drawn, drawn_slope = _of_points(body, angles, speeds, centre, change)
    if track.rolling_resistance:
        # what it takes of kappa m R^2 theta'', less what the body's own turning gives back
        arm = body.track_radius - (body.kappa - 1.0) * body.radius
        free = _unhindered(body, angles, speeds, centre, 0.0)
        left = ring_turning(put_in_order(track, angles, speeds, contacts), centre)
        drawn += body.moment * arm * (free[0] - left[0])
        drawn_slope += body.moment * arm * (free[1] - left[1])
    if offset:  # the whole force goes through the track's centre
        pull, pull_slope = (f - body.added_mass * a for f, a in zip(force, now[:2], strict=True))
        drawn += (offset.conjugate() * pull).imag
        drawn_slope += (offset.conjugate() * pull_slope).imag
    return drawn, drawn_slope


def _of_points(
    weights: Weights, angles: Sequence[float], speeds: Sequence[float], now: Instant, change: float
) -> tuple[float, float]:
    """About the track's centre, and its slope, where nothing but drag hinders the weights."""
    size, body, count = weights.track_radius, weights.radius, weights.count
    turned, jerk = _unhindered(weights, angles, speeds, now, change)
    drag = weights.drag * size**2
    rolling = (weights.kappa - 1.0) * weights.mass * (size + body)
    return (
        drag * sum(speeds) - rolling * (count * body * now.angular_acceleration - size * turned),
        drag * turned - rolling * (count * body * change - size * jerk),
    )


def _unhindered(
    weights: Weights, angles: Sequence[float], speeds: Sequence[float], now: Instant, change: float
) -> tuple[float, float]:
    """Sum of theta'' and its slope, where nothing but drag hinders the weights."""
    turned = jerk = 0.0
    for angle, speed in zip(angles, speeds, strict=True):
        drawn, drawn_slope = along_track(now.acceleration, now.slope, angle, speed, weights.lever)
        turned += drawn
        jerk += drawn_slope
    lag = weights.count * weights.spin_share
    turned -= lag * now.angular_acceleration + weights.damping_rate * sum(speeds)
    return turned, jerk - (lag * change + weights.damping_rate * turned)
