"""Which weights move together, how, and with what force.

Weights that touch and move alike form groups; a group moves by the order-4 substep of `weights`, or
its twin with resistance, and acts on the rotor as its factor times one weight at its middle.
"""

from __future__ import annotations

import cmath
import math

from ..weights import along_track, substep
from .centre import Instant
from .contact import group_factor, pool
from .resistance import SlidingGroup, find_sides, sliding_drive, sliding_substep
from .ring import WeightsInOrder, find_chains

PULL = 1e-12  # of the largest drive: tension that is rounding
_INSTANT = 1e-90  # s: nothing moves, and cubes of shorter times are not told from 0


def fill_drives(weights: WeightsInOrder, first: int, size: int, now: Instant) -> None:
    """Set `drives` and `limits`: accelerations g of a run of weights, limits f of those at rest."""
    track, drives, limits = weights.track, weights.drives, weights.limits
    lever, grip, radius = track.weights.lever, track.grip, track.weights.track_radius
    damping_rate = track.weights.damping_rate
    lag = track.weights.spin_share * now.angular_acceleration
    for j in range(size):
        k = (first + j) % weights.count
        z = now.acceleration * cmath.rect(1.0, -weights.angle[k])
        rate = weights.angle_rate[k]
        g, f = lever * z.imag - lag - damping_rate * rate, 0.0
        if grip:
            f = grip * abs(radius * (now.rotor_speed + rate) ** 2 - z.real)
            if rate:
                g, f = g - math.copysign(f, rate), 0.0
        drives[j], limits[j] = g, f


def find_groups(weights: WeightsInOrder, now: Instant) -> None:
    """Set `groups`: who moves together now; contacts that are pulled open are dropped."""
    track, chains, pools = weights.track, weights.chains, weights.pools
    lever, grip = track.weights.lever, track.grip
    slack = PULL * (abs(lever * now.acceleration) + abs(now.angular_acceleration))
    weights.groups.count = 0
    find_chains(weights, weights.joined)
    for i in range(chains.count):
        first, size = chains.first[i], chains.size[i]
        if size == 1 and not grip:
            _append_group(weights, first, 1, 0.0)
            continue
        fill_drives(weights, first, size, now)
        length = size
        if track.full:  # a closed ring cannot open
            weights.drives[0], weights.limits[0] = sum(weights.drives), sum(weights.limits)
            length = 1
        pool(pools, weights.drives, weights.limits, length, slack)
        for j in range(pools.count):
            begin = pools.first[j]
            if begin:
                weights.joined[(first + begin - 1) % weights.count] = False
            members = size if track.full else pools.size[j]
            _append_group(weights, (first + begin) % weights.count, members, pools.value[j])


def _append_group(
    weights: WeightsInOrder, first: int, size: int, angle_acceleration: float
) -> None:
    """One group more; `angle_acceleration` tells one that does not move yet where to."""
    groups, i = weights.groups, weights.groups.count
    rate = weights.angle_rate[first]
    groups.first[i], groups.size[i] = first, size
    groups.middle[i] = weights.angle[first] + (size - 1) * weights.track.alpha
    groups.angle_rate[i] = rate
    groups.sign[i], groups.resting[i] = 0.0, False
    if weights.track.grip:
        way = rate or angle_acceleration
        groups.resting[i] = way == 0.0
        if way:
            groups.sign[i] = math.copysign(1.0, way)
    groups.count = i + 1


def _sliding(weights: WeightsInOrder, i: int) -> SlidingGroup:
    track, groups = weights.track, weights.groups
    return SlidingGroup(
        track.weights.track_radius,
        track.weights.lever,
        groups.sign[i] * track.grip,
        track.weights.damping_rate,
        groups.size[i],
        track.alpha,
        track.weights.spin_share,
    )


def group_lever(weights: WeightsInOrder, i: int) -> float:
    """-1/(kappa R) times the factor of group i [1/m]."""
    lever = weights.track.weights.lever
    return lever * group_factor(weights.groups.size[i], weights.track.alpha)


def moved(
    weights: WeightsInOrder, i: int, now: Instant, later: Instant, step: float
) -> tuple[float, float]:
    """Middle and rate of group i after `step` [rad, rad/s]."""
    groups = weights.groups
    middle, rate = groups.middle[i], groups.angle_rate[i]
    if groups.resting[i]:
        return middle, 0.0
    if step < _INSTANT:
        return middle, rate
    if groups.sign[i]:
        return sliding_substep(_sliding(weights, i), middle, rate, now, later, step, weights.sides)
    ends = (now.acceleration, now.slope, later.acceleration, later.slope)
    body = weights.track.weights
    lag = body.spin_share * now.angular_acceleration
    return substep(middle, rate, ends, group_lever(weights, i), lag, body.damping_rate, step)


def group_acceleration(
    weights: WeightsInOrder, i: int, middle: float, angle_rate: float, now: Instant
) -> tuple[float, float]:
    """Angle acceleration of group i at `middle` and its time derivative [rad/s^2, rad/s^3]."""
    groups, damping_rate = weights.groups, weights.track.weights.damping_rate
    if groups.resting[i]:
        return 0.0, 0.0
    if groups.sign[i]:
        group, sides = _sliding(weights, i), weights.sides
        side_count = find_sides(group, now, middle, angle_rate, sides)
        drive, drive_slope = sliding_drive(group, now, middle, angle_rate, sides, side_count)
    else:
        lever = group_lever(weights, i)
        drive, drive_slope = along_track(now.acceleration, now.slope, middle, angle_rate, lever)
        drive -= weights.track.weights.spin_share * now.angular_acceleration
    acceleration = drive - damping_rate * angle_rate
    return acceleration, drive_slope - damping_rate * acceleration


def ring_turning(weights: WeightsInOrder, now: Instant) -> tuple[float, float]:
    """Sum of theta'' of all weights and its slope [rad/s^2, rad/s^3]."""
    groups, turned, slope = weights.groups, 0.0, 0.0
    find_groups(weights, now)
    for i in range(groups.count):
        both = group_acceleration(weights, i, groups.middle[i], groups.angle_rate[i], now)
        turned += groups.size[i] * both[0]
        slope += groups.size[i] * both[1]
    return turned, slope


def ring_reaction(weights: WeightsInOrder, now: Instant) -> tuple[complex, complex]:
    """As `weights.reaction`: a group counts as its factor times one weight at its middle."""
    speed, angular_acceleration = now.rotor_speed, now.angular_acceleration
    groups, alpha = weights.groups, weights.track.alpha
    find_groups(weights, now)
    moment = first = second = third = 0j
    for i in range(groups.count):
        nu, middle = groups.angle_rate[i], groups.middle[i]
        theta_2, theta_3 = group_acceleration(weights, i, middle, nu, now)
        size = groups.size[i]
        unit = cmath.rect(size * group_factor(size, alpha), middle)
        moment += unit
        first += 1j * nu * unit
        second += (1j * theta_2 - nu * nu) * unit
        third += (1j * (theta_3 - nu**3) - 3.0 * nu * theta_2) * unit
    turn = 2j * speed
    pull = 1j * angular_acceleration - speed * speed
    force = second + turn * first + pull * moment
    force_slope = third + turn * second + (2j * angular_acceleration + pull) * first
    force_slope -= 2.0 * speed * angular_acceleration * moment
    scale = -weights.track.weights.moment
    return scale * force, scale * force_slope
