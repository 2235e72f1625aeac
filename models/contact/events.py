"""Weights that collide, pack and stick, moved from event to event within a communication step.

An event is a gap that closes, a contact whose pressure would turn into tension, a sliding group
that comes to rest, or a resting one that breaks away.  The earliest one of a substep is located by
stepping again from the same point, to 1e-12 of the substep, so that smooth parts keep order 4.
"""

from __future__ import annotations

import cmath
from collections.abc import Sequence

from ..weights import TURN_PER_SUBSTEP, fastest_rate
from .event_functions import End, Suspect, Watch
from .impacts import approaching, settle
from .ring import Group, Instant, Ring
from .roots import crossing

_LOCATED = 1e-12  # of the substep
_MOST_PARTS = 100_000  # substeps and events within a communication step


class Mover:
    """Moves a ring of weights over one communication step.

    Attributes:
        impulse: of all collisions on the rotor, in the rotor frame at the step's start [N s].
        events: their number, that of contacts opened and of weights stuck or broken away.
    """

    def __init__(self, ring: Ring, signal: Sequence[complex], speed: float, spin_up: float) -> None:
        self.ring, self.speed, self.spin_up = ring, speed, spin_up
        self.signal = signal
        self.time = 0.0
        self.impulse, self.events = 0j, 0

    def instant(self, t: float) -> Instant:
        """Acceleration of the track's centre, its slope and the rotor's speed at a time."""
        a0, a1, a2, a3 = self.signal
        return (
            a0 + t * (a1 + t * (a2 / 2.0 + t * a3 / 6.0)),
            a1 + t * (a2 + t * a3 / 2.0),
            self.speed + self.spin_up * t,
        )

    def run(self, step: float) -> None:
        """Move to the end of the step.

        Raises:
            ArithmeticError: the input is not finite, or events do not come to an end.
        """
        if approaching(self.ring):
            self._settle()
        for _ in range(_MOST_PARTS):
            left = step - self.time
            count = self._substeps(left, step)
            self._part(step if count == 1 else self.time + left / count)
            if self.time >= step:
                return
        raise ArithmeticError(
            f"more than {_MOST_PARTS} substeps and events of the weights in {step:g} s, "
            f"{self.time:g} s reached: use smaller communication steps"
        )

    def _substeps(self, left: float, step: float) -> int:
        # as `weights.advance`, so that weights that meet nothing move in its substeps
        ring = self.ring
        fastest, strongest = fastest_rate(
            ring.v, self.signal, ring.gain, self.spin_up, ring.drag, step
        )
        turns = left * fastest / TURN_PER_SUBSTEP
        if not turns < _MOST_PARTS:
            raise ArithmeticError(
                f"the weights would need {turns:.3g} substeps in {left:g} s: acceleration "
                f"{strongest:g} m/s^2, rate {max(map(abs, ring.v)):g} rad/s"
            )
        return 1 + int(turns)

    def _part(self, until: float) -> None:
        """Move to the first event before `until`, or there."""
        ring, length, begin = self.ring, until - self.time, self.time
        now, later = self.instant(begin), self.instant(until)
        groups = ring.groups(now, self.spin_up)
        watch = Watch(ring, groups, lambda t: self.instant(begin + t), self.spin_up)

        def ends(later: Instant, t: float) -> list[End]:
            return [ring.moved(group, now, later, self.spin_up, t) for group in groups]

        final, width = ends(later, length), _LOCATED * length
        first, event = _earliest(watch, final, later, length, width)
        while event is not None:
            later = self.instant(begin + first)
            final = ends(later, first)
            # what came and went within the longer stretch may show only in the shorter one
            earlier, other = _earliest(watch, final, later, first, width)
            if other is None or earlier >= first - width:
                break
            first, event = earlier, other
        for group, (middle, rate) in zip(groups, final, strict=True):
            if not group.resting:  # rounding must not make resting weights creep
                ring.place(group.first, group.count, middle, rate)
        self.time = until if event is None else begin + first
        if event is not None:
            self.events += 1
            self._happen(event, groups)

    def _settle(self, closed: int = -1) -> None:
        turned = self.time * (self.speed + 0.5 * self.spin_up * self.time)
        blow = settle(self.ring, self.instant(self.time), self.spin_up, closed)
        self.impulse += blow * cmath.rect(1.0, turned)

    def _happen(self, event: Suspect, groups: Sequence[Group]) -> None:
        """Change what an event changes; breaking away changes nothing but the groups."""
        ring = self.ring
        if event.kind == "gap":
            self._settle(event.where)
        elif event.kind == "pull":
            ring.joined[event.where] = False
        elif event.kind == "rest":
            group = groups[event.where]
            for j in range(group.count):
                ring.v[(group.first + j) % ring.count] = 0.0


def _earliest(
    watch: Watch, ends: list[End], later: Instant, length: float, width: float
) -> tuple[float, Suspect | None]:
    """Time of the first event of those that show at the ends of a stretch, to `width`."""
    first, event = length, None
    for suspect in watch.all(ends, later, length):
        if event is not None and suspect.upper >= first and suspect.value(first) >= 0.0:
            continue
        first = crossing(suspect.value, suspect.begin, min(suspect.upper, first), width)
        event = suspect
    return first, event
