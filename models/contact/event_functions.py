"""What may happen to the weights of a ring within a stretch of time.

A gap may close, the pressure in a group turn into tension, a sliding group come to rest, a resting
one break away: each is a function of time, not negative at the start, whose fall below 0 is the
event.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import NamedTuple

from .contact import pressure_levers
from .ring import PULL, Group, Instant, Ring
from .roots import lowest

_ROUNDING = 1e-14  # rad: a gap closes when it is less than 0 by more than this
_DIP = 1e-12  # rad: more than rounding

End = tuple[float, float]  # middle and rate of a group


class Suspect(NamedTuple):
    """Something that is `begin` >= 0 now and negative `upper` later.

    Attributes:
        value: of the time from now.
        kind: "gap", "pull", "rest" or "break".
        where: weight before the gap or contact, or number of the group.
    """

    value: Callable[[float], float]
    begin: float
    upper: float
    kind: str
    where: int


class Watch:
    """Looks for events of groups from an instant on; `instant` is a function of the time since."""

    def __init__(
        self, ring: Ring, groups: list[Group], instant: Callable[[float], Instant], spin_up: float
    ) -> None:
        self.ring, self.groups, self.instant, self.spin_up = ring, groups, instant, spin_up
        self.now = instant(0.0)

    def all(self, ends: list[End], later: Instant, length: float) -> Iterator[Suspect]:
        """Everything that has changed sign, or may have done so twice, within `length`.

        Args:
            ends: middle and rate of every group after `length`.
            later: the instant then.
        """
        groups, ring = self.groups, self.ring
        if ring.solid and len(groups) > 1:
            for k in range(len(groups)):
                yield from self._gap_closes(k, ends, length)
        for k, group in enumerate(groups):
            if group.count > 1 and not ring.full:
                yield from self._pulled_open(group, ends[k], later, length)
            if group.slide is not None:
                yield from self._comes_to_rest(k, ends[k], later, length)
            elif group.resting and self._hold(group, later) < 0.0:
                held = partial(self._hold_after, group)
                yield Suspect(held, self._hold(group, self.now), length, "break", k)

    def _after(self, group: Group, t: float) -> End:
        return self.ring.moved(group, self.now, self.instant(t), self.spin_up, t)

    def _gap_closes(self, k: int, ends: list[End], length: float) -> Iterator[Suspect]:
        j = (k + 1) % len(self.groups)
        group, following, after = self.groups[k], self.groups[j], self._after
        end, end_following = ends[k], ends[j]
        last = (group.first + group.count - 1) % self.ring.count
        begin = max(0.0, self.ring.gap(last)) + _ROUNDING
        base = following.middle - group.middle
        final = begin + (end_following[0] - end[0] - base)
        opening = following.rate - group.rate, end_following[1] - end[1]

        def gap(t: float) -> float:
            return begin + (after(following, t)[0] - after(group, t)[0] - base)

        # rounding must not close a gap that opens; one that dips and opens again has to
        if final < (0.0 if min(opening) < 0.0 else -_DIP):
            yield Suspect(gap, begin, length, "gap", last)
        elif opening[0] < 0.0 < opening[1]:
            dip = lowest(begin, opening[0], final, opening[1], length)
            if dip and gap(dip) < 0.0:
                yield Suspect(gap, begin, dip, "gap", last)

    def _pulled_open(
        self, group: Group, end: End, later: Instant, length: float
    ) -> Iterator[Suspect]:
        least, where = self._pressure(group, end, later)
        if least < 0.0:
            last = (group.first + where) % self.ring.count
            begin, _ = self._pressure(group, (group.middle, group.rate), self.now)

            def pressure(t: float) -> float:
                return self._pressure(group, self._after(group, t), self.instant(t))[0]

            yield Suspect(pressure, begin, length, "pull", last)

    def _comes_to_rest(self, k: int, end: End, later: Instant, length: float) -> Iterator[Suspect]:
        group = self.groups[k]

        def rate(t: float) -> float:
            return group.sign * self._after(group, t)[1]

        if group.sign * end[1] < 0.0:
            yield Suspect(rate, group.sign * group.rate, length, "rest", k)
            return
        begin, _ = self.ring.bend(group, self.now, self.spin_up)
        moved = replace(group, middle=end[0], rate=end[1])
        final, _ = self.ring.bend(moved, later, self.spin_up)
        if group.sign * begin < 0.0 < group.sign * final:
            rates = group.sign * group.rate, group.sign * end[1]
            dip = lowest(rates[0], group.sign * begin, rates[1], group.sign * final, length)
            if dip and rate(dip) < 0.0:
                yield Suspect(rate, rates[0], dip, "rest", k)

    def _pressure(self, group: Group, end: End, now: Instant) -> tuple[float, int]:
        """Least pressure in a group, as an acceleration and above rounding, and after whom."""
        ring = self.ring
        a, _, speed = now
        middle, rate = end
        slack = self._slack(group, now)
        if group.resting:
            return 1.0, 0
        if group.slide is None or abs(a) < ring.track.weights.track_radius * (speed + rate) ** 2:
            pull = complex(ring.gain, group.sign * ring.grip) * a * cmath.rect(1.0, -middle)
            levers = pressure_levers(group.count, ring.alpha)
            least = min((pull * lever).imag for lever in levers)
            where = next(j for j, lever in enumerate(levers) if (pull * lever).imag == least)
            return least + slack, where
        least, where, total = math.inf, 0, 0.0
        drives = self._drives_of(group, end, now)
        mean = sum(drives) / group.count
        for j, drive in enumerate(drives[:-1]):
            total += drive - mean
            if total < least:
                least, where = total, j
        return least + slack, where

    def _slack(self, group: Group, now: Instant) -> float:
        """Rounding of drives; never less than what `Ring.groups` leaves together."""
        return PULL * group.count * (abs(self.ring.gain * now[0]) + abs(self.spin_up))

    def _drives_of(self, group: Group, end: End, now: Instant) -> list[float]:
        """Accelerations of a sliding group's weights without contact, common parts left out."""
        ring = self.ring
        a, _, speed = now
        centrifugal = ring.track.weights.track_radius * (speed + end[1]) ** 2
        drives = []
        for k in range(group.count):
            z = a * cmath.rect(1.0, -end[0] - (2 * k - group.count + 1) * ring.alpha)
            drives.append(ring.gain * z.imag - group.sign * ring.grip * abs(centrifugal - z.real))
        return drives

    def _hold_after(self, group: Group, t: float) -> float:
        return self._hold(group, self.instant(t))

    def _hold(self, group: Group, now: Instant) -> float:
        """What resistance has left to hold a resting group or a part of it; negative: it moves.

        A part moves when it can push all that is before it, so the ends of the group decide.
        """
        ring = self.ring
        members = [(group.first + j) % ring.count for j in range(group.count)]
        drives, limits = ring.drives(members, now, self.spin_up)
        slack = self._slack(group, now)
        if ring.full:
            return sum(limits) - abs(sum(drives)) + slack
        least = math.inf
        for g_sign, order in ((1.0, range(group.count)), (-1.0, range(group.count - 1, -1, -1))):
            left = 0.0
            for k in order:
                left += limits[k] + g_sign * drives[k]
                least = min(least, left)
        return least + slack
