"""What may happen to the weights of a track within a stretch of time.

A gap may close, the pressure in a group turn into tension, a sliding group come to rest, a resting
one break away: each is a function of time, not negative at the start, whose fall below 0 is the
event.
"""

from __future__ import annotations

import cmath
import math
from itertools import accumulate
from typing import NamedTuple

from .centre import CentreMotion, Instant, instant
from .contact import pressure_factors
from .groups import PULL, fill_drives, group_acceleration, moved
from .ring import WeightsInOrder, gap
from .roots import lowest

_ROUNDING = 1e-14  # rad: a gap closes when it is less than 0 by more than this
_DIP = 1e-12  # rad: more than rounding


# kinds of events
GAP_CLOSES, PULLED_OPEN, COMES_TO_REST, BREAKS_AWAY = KINDS = range(4)


class EventFunctions(NamedTuple):
    """The functions of all groups from an instant on.

    Attributes:
        weights: with groups as they are at that instant.
        motion: of the track's centre.
        begin: time of the instant [s].
        now: the instant.
    """

    weights: WeightsInOrder
    motion: CentreMotion
    begin: float
    now: Instant


class EventFunction(NamedTuple):
    """One that is `start` >= 0 now and negative `upper` later.

    Attributes:
        functions: where it belongs.
        kind, group: what it is of which group.
        where: weight before the gap or the contact.
        start: value now.
        upper: [s].
    """

    functions: EventFunctions
    kind: int
    group: int
    where: int
    start: float
    upper: float


def event_value(event: EventFunction, time: float) -> float:
    """Value of an event function `time` after its instant."""
    functions, i = event.functions, event.group
    weights = functions.weights
    groups, later = weights.groups, instant(functions.motion, functions.begin + time)
    if event.kind == BREAKS_AWAY:
        return _hold(weights, i, later)
    middle, rate = moved(weights, i, functions.now, later, time)
    if event.kind == COMES_TO_REST:
        return groups.sign[i] * rate
    if event.kind == PULLED_OPEN:
        return _pressure(functions, i, middle, rate, later)[0]
    j = (i + 1) % groups.count
    following, _ = moved(weights, j, functions.now, later, time)
    return event.start + (following - middle - (groups.middle[j] - groups.middle[i]))


def may_happen(functions: EventFunctions, kind: int) -> bool:
    """Whether a kind of event is possible at all."""
    weights = functions.weights
    if kind == GAP_CLOSES:
        return weights.track.solid and weights.groups.count > 1
    if kind == PULLED_OPEN:
        return weights.groups.count < weights.count and not weights.track.full
    return weights.track.grip > 0.0


def find_event_function(
    functions: EventFunctions, kind: int, i: int, later: Instant, length: float
) -> EventFunction | None:
    """That of group i, if it has changed sign, or may have done so twice, within `length`.

    The groups' `end_middle` and `end_rate` are those at the instant `later`.
    """
    groups = functions.weights.groups
    if kind == GAP_CLOSES:
        return _gap_closes(functions, i, length)
    if kind == PULLED_OPEN:
        return _pulled_open(functions, i, later, length) if groups.size[i] > 1 else None
    if kind == COMES_TO_REST:
        return _comes_to_rest(functions, i, later, length) if groups.sign[i] else None
    return _breaks_away(functions, i, later, length) if groups.resting[i] else None


def _gap_closes(functions: EventFunctions, i: int, length: float) -> EventFunction | None:
    weights, groups = functions.weights, functions.weights.groups
    j = (i + 1) % groups.count
    last = (groups.first[i] + groups.size[i] - 1) % weights.count
    start = max(0.0, gap(weights, last)) + _ROUNDING
    base = groups.middle[j] - groups.middle[i]
    final = start + (groups.end_middle[j] - groups.end_middle[i] - base)
    opening = groups.angle_rate[j] - groups.angle_rate[i]
    final_opening = groups.end_rate[j] - groups.end_rate[i]
    event = EventFunction(functions, GAP_CLOSES, i, last, start, length)
    # rounding must not close a gap that opens; one that dips and opens again has to
    if final < (0.0 if min(opening, final_opening) < 0.0 else -_DIP):
        return event
    if opening < 0.0 < final_opening:
        return _dips(event, lowest(start, opening, final, final_opening, length))
    return None


def _dips(event: EventFunction, time: float) -> EventFunction | None:
    """The event if it has happened at the time of a least value."""
    if time and event_value(event, time) < 0.0:
        return event._replace(upper=time)
    return None


def _pulled_open(
    functions: EventFunctions, i: int, later: Instant, length: float
) -> EventFunction | None:
    weights, groups = functions.weights, functions.weights.groups
    least, after = _pressure(functions, i, groups.end_middle[i], groups.end_rate[i], later)
    if least >= 0.0:
        return None
    where = (groups.first[i] + after) % weights.count
    start, _ = _pressure(functions, i, groups.middle[i], groups.angle_rate[i], functions.now)
    return EventFunction(functions, PULLED_OPEN, i, where, start, length)


def _comes_to_rest(
    functions: EventFunctions, i: int, later: Instant, length: float
) -> EventFunction | None:
    weights, groups = functions.weights, functions.weights.groups
    sign = groups.sign[i]
    middle, rate = groups.middle[i], groups.angle_rate[i]
    end_middle, end_rate = groups.end_middle[i], groups.end_rate[i]
    event = EventFunction(functions, COMES_TO_REST, i, -1, sign * rate, length)
    if sign * end_rate < 0.0:
        return event
    start, _ = group_acceleration(weights, i, middle, rate, functions.now)
    final, _ = group_acceleration(weights, i, end_middle, end_rate, later)
    if sign * start < 0.0 < sign * final:
        least = lowest(sign * rate, sign * start, sign * end_rate, sign * final, length)
        return _dips(event, least)
    return None


def _breaks_away(
    functions: EventFunctions, i: int, later: Instant, length: float
) -> EventFunction | None:
    if _hold(functions.weights, i, later) >= 0.0:
        return None
    start = _hold(functions.weights, i, functions.now)
    return EventFunction(functions, BREAKS_AWAY, i, -1, start, length)


def _slack(weights: WeightsInOrder, i: int, now: Instant) -> float:
    """Rounding of drives; never less than what `find_groups` leaves together."""
    lever = weights.track.weights.lever
    drive = abs(lever * now.acceleration) + abs(now.angular_acceleration)
    return PULL * weights.groups.size[i] * drive


def _pressure(
    functions: EventFunctions, i: int, middle: float, angle_rate: float, now: Instant
) -> tuple[float, int]:
    """Least pressure in a group, as an acceleration and above rounding, and after whom."""
    weights, groups = functions.weights, functions.weights.groups
    track, size = weights.track, groups.size[i]
    if groups.resting[i]:
        return 1.0, 0
    a = now.acceleration
    centrifugal = track.weights.track_radius * (now.rotor_speed + angle_rate) ** 2
    if not groups.sign[i] or abs(a) < centrifugal:
        lever = complex(track.weights.lever, groups.sign[i] * track.grip)
        pull = lever * a * cmath.rect(1.0, -middle)
        pressures = [(pull * factor).imag for factor in pressure_factors(size, track.alpha)]
    else:
        _fill_sliding_drives(weights, i, middle, centrifugal, a)
        mean = sum(weights.drives[:size]) / size
        pressures = list(accumulate(drive - mean for drive in weights.drives[: size - 1]))
    least = min(pressures)
    return least + _slack(weights, i, now), pressures.index(least)


def _fill_sliding_drives(
    weights: WeightsInOrder, i: int, middle: float, centrifugal: float, acceleration: complex
) -> None:
    """Set `drives` to those of a sliding group's weights without contact, but for common parts."""
    track, groups = weights.track, weights.groups
    size, grip = groups.size[i], groups.sign[i] * track.grip
    for k in range(size):
        z = acceleration * cmath.rect(1.0, -middle - (2 * k - size + 1) * track.alpha)
        weights.drives[k] = track.weights.lever * z.imag - grip * abs(centrifugal - z.real)


def _hold(weights: WeightsInOrder, i: int, now: Instant) -> float:
    """What resistance has left to hold a resting group or a part of it; negative: it moves.

    A part moves when it can push all that is before it, so the ends of the group decide.
    """
    groups, drives, limits = weights.groups, weights.drives, weights.limits
    size = groups.size[i]
    fill_drives(weights, groups.first[i], size, now)
    slack = _slack(weights, i, now)
    if weights.track.full:
        return sum(limits) - abs(sum(drives)) + slack
    least = math.inf
    forward = backward = 0.0
    for k in range(size):
        forward += limits[k] + drives[k]
        backward += limits[size - 1 - k] - drives[size - 1 - k]
        least = min(least, forward, backward)
    return least + slack
