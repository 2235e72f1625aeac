"""Rolling resistance with true sticking, and a track whose centre is off the rotor's.

The two causes of residual unbalance named by Goncharov 2017 (section 2, after Nesterenko 1985 and
Yang 2005).  A weight at e + R e^{i theta} in the rotor (e: offset of the track's centre) moves by

    theta'' + d theta' = g - sign(theta') c |n|,        theta' = 0 while |g| <= c |n|,
    g = -Im(a_c e^{-i theta})/(kappa R) - s w',         n = R (w + theta')^2 - Re(a_c e^{-i theta}),
    a_c = a + (i w' - w^2) e,                           c = mu/(kappa R),

with a_c the acceleration of the track's centre, m |n| the force between weight and race (either
wall of the race may carry it), and mu the coefficient of rolling resistance: lever arm of the
resistance over the weight's radius for balls and rollers (5e-6 m to 5e-5 m for hardened steel),
friction times journal radius over R for pendulums.  The load is that in the plane.

Balance.  a_c = 0 balances the weights, so an offset leaves the track's centre on the axis of
rotation and the rotor's displacement is -e, whatever the unbalance.  With resistance any position
with |Im(a_c e^{-i theta})| <= mu |R w^2 - Re(a_c e^{-i theta})| is an equilibrium: the dead zone.
"""

from __future__ import annotations

import cmath
from typing import NamedTuple

from ..cubic import hermite
from ..weights import MAX_ITERATIONS, converged, quadrature
from .centre import Instant
from .contact import group_factor


class SlidingGroup(NamedTuple):
    """A packed group that slides one way.

    Attributes:
        radius: R [m].
        lever: -1/(kappa R) [1/m].
        grip: sign(theta') mu/(kappa R) [1/m].
        damping_rate: d [1/s].
        size, alpha: weights of the group, half the angle between neighbours [rad].
        spin_share: s of `Weights`.
    """

    radius: float
    lever: float
    grip: float
    damping_rate: float
    size: int
    alpha: float
    spin_share: float


def find_sides(
    group: SlidingGroup, now: Instant, angle: float, angle_rate: float, sides: list[float]
) -> int:
    """Which wall of the race carries each weight: 1.0 outer, -1.0 inner.

    Args:
        angle, angle_rate: of the group's middle [rad, rad/s].
        sides: (size,) is set.

    Returns:
        Number of sides set; 0: all are the outer one.
    """
    centrifugal = group.radius * (now.rotor_speed + angle_rate) ** 2
    if abs(now.acceleration) < centrifugal:
        return 0
    for k in range(group.size):
        load = (now.acceleration * cmath.rect(1.0, -angle - _turn(group, k))).real
        sides[k] = 1.0 if centrifugal >= load else -1.0
    return group.size


def _turn(group: SlidingGroup, k: int) -> float:
    """Angle of weight k from the middle."""
    return (2 * k - group.size + 1) * group.alpha


def sliding_drive(
    group: SlidingGroup,
    now: Instant,
    angle: float,
    angle_rate: float,
    sides: list[float],
    side_count: int,
) -> tuple[float, float]:
    """Mean of g - grip |n| over the group, and its time derivative along the motion.

    Args:
        angle, angle_rate: of the group's middle [rad, rad/s].
        sides, side_count: as `find_sides` sets and returns them.
    """
    acceleration, slope, rotor_speed, angular_acceleration = now
    turning = rotor_speed + angle_rate
    centrifugal = group.radius * turning * turning
    middle = cmath.rect(1.0, -angle)
    terms = side_count or 1
    g = dg = load = 0.0
    for k in range(terms):
        if side_count:
            unit, pull = middle * cmath.rect(1.0, -_turn(group, k)), group.grip * sides[k]
        else:  # the sum over the group is known
            unit, pull = group_factor(group.size, group.alpha) * middle, group.grip
        z, dz = acceleration * unit, slope * unit
        load += pull
        g += group.lever * z.imag + pull * z.real
        turned, loaded = dz.imag - angle_rate * z.real, dz.real + angle_rate * z.imag
        dg += group.lever * turned + pull * loaded
    share = 1.0 / terms
    g = share * (g - load * centrifugal) - group.spin_share * angular_acceleration
    angle_acceleration = g - group.damping_rate * angle_rate
    dg -= 2.0 * load * group.radius * turning * (angular_acceleration + angle_acceleration)
    return g, share * dg


def sliding_substep(
    group: SlidingGroup,
    angle: float,
    angle_rate: float,
    now: Instant,
    later: Instant,
    step: float,
    sides: list[float],
) -> tuple[float, float]:
    """Angle and rate after `step`; order 4 as `weights.substep`, of which it is the twin.

    Args:
        now, later: start and end of the step.
        sides: (size,) scratch.

    Raises:
        ArithmeticError: the implicit equations did not converge.
    """
    e, s0, s1, s2, s3, t, t0, t1, t2, t3 = quadrature(group.damping_rate, step)
    side_count = find_sides(group, now, angle, angle_rate, sides)
    g0, g1 = sliding_drive(group, now, angle, angle_rate, sides, side_count)
    free_rate = e * angle_rate + s0 * g0 + s1 * g1
    free_angle = angle + t * angle_rate + t0 * g0 + t1 * g1
    new_angle, new_rate = free_angle, free_rate
    end_speed = now.rotor_speed + now.angular_acceleration * step
    later = later._replace(rotor_speed=end_speed)
    # kept during the iteration, which a load that changes sides in it would not let converge
    side_count = find_sides(group, later, free_angle, free_rate, sides)
    change = 0.0
    for _ in range(MAX_ITERATIONS):
        end, slope = sliding_drive(group, later, new_angle, new_rate, sides, side_count)
        g2, g3 = hermite(g0, g1, end, slope, step)
        last_angle, last_rate, last_change = new_angle, new_rate, change
        new_rate = free_rate + s2 * g2 + s3 * g3
        new_angle = free_angle + t2 * g2 + t3 * g3
        change = abs(new_angle - last_angle) + abs(new_rate - last_rate) * step
        if converged(change, last_change, new_angle):
            return new_angle, new_rate
    raise ArithmeticError(
        f"the sliding weights' step of {step:g} s did not converge (angle {angle:g} rad, "
        f"rate {angle_rate:g} rad/s, acceleration {abs(now.acceleration):g} m/s^2): "
        "use smaller steps"
    )
