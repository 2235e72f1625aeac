"""The weights of a track as they stand on it: who touches whom, who moves together, what force.

Weights that touch and move alike form groups; a group moves by the order-4 substep of `weights`, or
its twin with resistance, and acts on the rotor as its factor times one weight at its middle.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..weights import along_track, substep
from .contact import group_factor, pools
from .resistance import Slide

if TYPE_CHECKING:
    from .track import Track

TOUCH = 1e-11  # rad: neighbours this close collide together
PULL = 1e-12  # of the largest drive: tension that is rounding
_OVERLAP = 1e-7  # rad: of a start; rounding of angles after a million turns stays below
_ALIGNED = 1e-12  # rad: contacts this exact are left alone, so that resting weights never creep

Instant = tuple[complex, complex, float]  # acceleration, its slope, speed of the rotor


@dataclass
class Group:
    """Weights first..first + count - 1 of the ring (cyclic) that move as one.

    Attributes:
        middle, rate: [rad, rad/s].
        slide: its drive when it slides against resistance.
        sign: direction in which it slides; 0 without resistance or at rest.
        resting: held by resistance.
    """

    first: int
    count: int
    middle: float
    rate: float
    slide: Slide | None = None
    sign: float = 0.0
    resting: bool = False


class Ring:
    """The weights of a track in the order in which they stand on it.

    Attributes:
        x, v: (N,) angles, ascending and within a turn, and rates [rad, rad/s].
        joined: (N,) True where a weight lastingly touches the next.
    """

    def __init__(
        self,
        track: Track,
        angles: Sequence[float],
        speeds: Sequence[float],
        contacts: Sequence[float],
    ) -> None:
        weights = track.weights
        self.track, self.count = track, weights.count
        self.alpha = track.alpha if weights.count > 1 else 0.0
        self.solid = self.alpha > 0.0
        self.full = self.solid and self.count * self.alpha >= math.pi - self.count * TOUCH
        self.gain = -1.0 / (weights.kappa * weights.track_radius)
        self.grip = -track.rolling_resistance * self.gain
        self.drag = weights.damping_rate
        self.moment = weights.mass * weights.track_radius
        self.given = list(angles)
        order = range(self.count)
        turned = [angle % math.tau for angle in angles]
        if self.solid:
            order = sorted(order, key=turned.__getitem__)  # type: ignore[assignment]
        self.order = order
        self.begin = [turned[k] for k in order]
        self.x = self.begin[:]
        self.v = [speeds[k] for k in order]
        self.joined = [self.full or (self.solid and bool(contacts[k])) for k in order]
        if self.solid:
            self.align()

    def state(self) -> tuple[list[float], list[float], list[float]]:
        """Angles, rates and contacts in the order in which they were given.

        Turns are kept, and a weight that has not moved keeps its angle to the last digit.
        """
        angles, speeds, contacts = self.given[:], [0.0] * self.count, [0.0] * self.count
        for j, k in enumerate(self.order):
            angles[k] += self.x[j] - self.begin[j]
            speeds[k] = self.v[j]
            contacts[k] = 1.0 if self.joined[j] else 0.0
        return angles, speeds, contacts

    # -- where and how the weights stand ----------------------------------------------------------

    def gap(self, k: int) -> float:
        """Free angle between weight k and the next."""
        after = k + 1
        ahead = self.x[after] if after < self.count else self.x[0] + math.tau
        return ahead - self.x[k] - 2.0 * self.alpha

    def chains(self, linked: Sequence[bool]) -> list[list[int]]:
        """Weights connected by links, each chain along increasing angle."""
        n = self.count
        if not self.solid:
            return [[k] for k in range(n)]
        if True not in linked:  # the usual case, and the hot one
            return [[k % n] for k in range(1, n + 1)]
        start = next((k + 1 for k in range(n) if not linked[k]), 0)
        found: list[list[int]] = [[]]
        for k in range(start, start + n):
            found[-1].append(k % n)
            if not linked[k % n] and k < start + n - 1:
                found.append([])
        return found

    def align(self) -> None:
        """Exact distances and one rate in every chain of lasting contacts; refuse overlaps."""
        apart, following = 2.0 * self.alpha, [*self.x[1:], self.x[0] + math.tau]
        for k, (x, after) in enumerate(zip(self.x, following, strict=True)):
            gap = after - x - apart
            if gap < -_OVERLAP:
                raise ValueError(
                    f"weights overlap by {-gap:.3g} rad: neighbours need {2 * self.alpha:.6g} rad"
                )
            if self.joined[k] and gap > _OVERLAP:
                self.joined[k] = False
        if True not in self.joined:
            return
        for chain in self.chains(self.joined):
            if len(chain) > 1 and not self._aligned(chain):
                lifted = [self._lifted(k, chain[0]) for k in chain]
                mean = sum(lifted) / len(chain)
                rate = sum(self.v[k] for k in chain) / len(chain)
                self.place(chain[0], len(chain), mean, rate)

    def _aligned(self, chain: Sequence[int]) -> bool:
        rate = self.v[chain[0]]
        exact = all(abs(self.gap(k)) <= _ALIGNED for k in chain[:-1])
        return exact and all(self.v[k] == rate for k in chain)

    def _lifted(self, k: int, first: int) -> float:
        return self.x[k] + math.tau if k < first else self.x[k]

    def place(self, first: int, count: int, middle: float, rate: float) -> None:
        for j in range(count):
            k = first + j
            angle = middle + (2 * j - count + 1) * self.alpha
            if k >= self.count:
                k, angle = k - self.count, angle - math.tau
            self.x[k], self.v[k] = angle, rate

    # -- groups and their accelerations -----------------------------------------------------------

    def drives(self, chain: Sequence[int], now: Instant, spin_up: float) -> tuple[list, list]:
        """Accelerations g of a chain's weights, and limits f of those at rest."""
        a, _, speed = now
        drives, limits = [], []
        radius = self.track.weights.track_radius
        for k in chain:
            z = a * cmath.rect(1.0, -self.x[k])
            rate = self.v[k]
            g, f = self.gain * z.imag - spin_up - self.drag * rate, 0.0
            if self.grip:
                f = self.grip * abs(radius * (speed + rate) ** 2 - z.real)
                if rate:
                    g, f = g - math.copysign(f, rate), 0.0
            drives.append(g)
            limits.append(f)
        return drives, limits

    def groups(self, now: Instant, spin_up: float) -> list[Group]:
        """Who moves together at this instant; contacts that are pulled open are dropped."""
        found = []
        slack = PULL * (abs(self.gain * now[0]) + abs(spin_up))
        for chain in self.chains(self.joined):
            first = chain[0]
            if len(chain) == 1 and not self.grip:
                found.append(Group(first, 1, self.x[first], self.v[first]))
                continue
            drives, limits = self.drives(chain, now, spin_up)
            if self.full:  # a closed ring cannot open
                drives, limits = [sum(drives)], [sum(limits)]
            for part in pools(drives, limits, slack):
                if part.first:
                    self.joined[chain[part.first - 1]] = False
                count = self.count if self.full else part.size
                found.append(self._group(chain[part.first], count, part.value))
        return found

    def _group(self, first: int, count: int, bend: float) -> Group:
        """A group from its first weight on; `bend` tells a resting one where to."""
        rate = self.v[first]
        group = Group(first, count, self.x[first] + (count - 1) * self.alpha, rate)
        if self.grip:
            way = rate or bend
            group.resting = way == 0.0
            if way:
                group.sign = math.copysign(1.0, way)
                radius, grip = self.track.weights.track_radius, group.sign * self.grip
                group.slide = Slide(radius, self.gain, grip, self.drag, count, self.alpha)
        return group

    def moved(
        self, group: Group, now: Instant, later: Instant, spin_up: float, step: float
    ) -> tuple[float, float]:
        """Middle and rate of a group after `step`."""
        if group.resting:
            return group.middle, 0.0
        ends = (now[0], now[1], later[0], later[1])
        if group.slide is not None:
            return group.slide.substep(group.middle, group.rate, ends, now[2], spin_up, step)
        gain = self.gain * group_factor(group.count, self.alpha)
        return substep(group.middle, group.rate, ends, gain, spin_up, self.drag, step)

    def bend(self, group: Group, now: Instant, spin_up: float) -> tuple[float, float]:
        """Angular acceleration of a group and its time derivative."""
        if group.resting:
            return 0.0, 0.0
        if group.slide is not None:
            end = (now[0], now[1])
            drive, slope = group.slide.drive(end, group.middle, group.rate, now[2], spin_up)
        else:
            gain = self.gain * group_factor(group.count, self.alpha)
            drive, slope = along_track(now[0], now[1], group.middle, group.rate, gain)
            drive -= spin_up
        bend = drive - self.drag * group.rate
        return bend, slope - self.drag * bend

    def reaction(
        self, acceleration: complex, slope: complex, speed: float, spin_up: float
    ) -> tuple[complex, complex]:
        """As `weights.reaction`: a group counts as its factor times one weight at its middle."""
        now = (acceleration, slope, speed)
        moment = first = second = third = 0j
        for group in self.groups(now, spin_up):
            nu = group.rate
            bend, jerk = self.bend(group, now, spin_up)
            factor = group.count * group_factor(group.count, self.alpha)
            unit = cmath.rect(factor, group.middle)
            moment += unit
            first += 1j * nu * unit
            second += (1j * bend - nu * nu) * unit
            third += (1j * (jerk - nu**3) - 3.0 * nu * bend) * unit
        turn = 2j * speed
        pull = 1j * spin_up - speed * speed
        force = second + turn * first + pull * moment
        force_slope = (
            third + turn * second + (2j * spin_up + pull) * first - 2.0 * speed * spin_up * moment
        )
        scale = -self.moment
        return scale * force, scale * force_slope
