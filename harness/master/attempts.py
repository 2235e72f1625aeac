"""What a run in finer steps shows of its error against the one before: by which order it shrinks.

See `global_error`, which runs a scene until an attempt keeps the tolerance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from .compared import ASYMPTOTIC
from .expectation import ORDER_OF_EVENTS, ORDER_OF_JUMPS, Expectation

ORDER_HELD = 1  # of steps with held signals, and of all that follows
# of the tolerance: what further parts are to leave, and two runs may say, for they do not tell by
# which order errors shrink; if by 1.3 already, the tolerance is still kept within a factor of 3
AIM = 0.3
# rad by which a step of the finer run may turn the rotor's fastest vibration: longer ones do not
# follow it.  Under a motor, whose speed vibrates too, 6 of 400 runs erred by 3 to 12 times what
# they stated; on supports of 10^5 times the stiffness a run-up by 4.6 times
FOLLOWED = 1.5
MOST_TIMES = 4  # as many parts as in the run before, which is to be confirmed


@dataclass(frozen=True)
class Attempt:
    """What a run in finer steps shows against the one before.

    Attributes:
        parts: of each step of the first run; `times` as many as in the run before.
        apart: largest difference of the two, before steps at rest hold their signals.
        at_rest: the same from then on.
        order: by which errors will shrink further, as it is known by now.
        error_by_order: by the order that is expected.
        error: as it is stated.
        allowed: the error by order that keeps the tolerance.
    """

    parts: int
    times: float
    apart: float
    at_rest: float
    order: float
    error_by_order: float
    error: float
    allowed: float

    def order_to(self, apart: float) -> float:
        """Order that three runs show, the last two of which are `apart`, which is not 0."""
        return math.log1p(self.apart / apart) / math.log(self.times)

    @property
    def is_far(self) -> bool:
        """Whether the two runs differ by so much that their motions may part."""
        return max(self.apart, self.at_rest) >= ASYMPTOTIC


class Attempts:
    """Judges each attempt by the one before, and says how fine the next should be.

    Args:
        expected: of the errors.
        tolerance: to be kept, relative to the motion.
        longest_step: of the first run [s].
    """

    def __init__(self, expected: Expectation, tolerance: float, longest_step: float) -> None:
        self._expected, self._tolerance = expected, tolerance
        self._longest_step = longest_step

    def attempt(self, before: Attempt | None, apart: float, at_rest: float, parts: int) -> Attempt:
        """What a run shows so far `apart` from the one before, and `at_rest`."""
        times = parts / (before.parts if before else 1)
        order, stated, allowed = self._orders(before, apart, parts)
        # where a corner lies in its step, two runs can agree by chance
        least = before.error_by_order / times**self._expected.steepest_order if before else 0.0
        by_order = error = max(apart, at_rest)
        if error < ASYMPTOTIC:
            rested = at_rest / (times**ORDER_HELD - 1.0)
            by_order = max(apart / (times**order - 1.0), rested, least)
            error = max(apart / (times**stated - 1.0), rested, least)
        shown = self._shown_order(before, apart, parts)
        return Attempt(parts, times, apart, at_rest, shown, by_order, error, allowed)

    def _shown_order(self, before: Attempt | None, apart: float, parts: int) -> float:
        """By which errors will shrink further: as three runs have shown, or as is expected."""
        if before and before.apart and apart and self._is_followed(parts):
            return min(self._expected.order, max(before.order_to(apart), ORDER_OF_JUMPS))
        return before.order if before else self._expected.order

    def _is_followed(self, parts: int) -> bool:
        """Whether steps follow the rotor's fastest vibration."""
        return self._expected.fastest * self._longest_step <= FOLLOWED * parts

    def _orders(
        self, before: Attempt | None, apart: float, parts: int
    ) -> tuple[float, float, float]:
        """Order of the errors, the order by which they are stated, and what may be left of them."""
        highest, aim = self._expected.order, AIM * self._tolerance
        if highest == ORDER_OF_JUMPS:
            cautious = highest
        else:
            cautious = max(ORDER_OF_EVENTS, highest - self._expected.caution)
        if not self._is_followed(parts):
            return ORDER_OF_JUMPS, ORDER_OF_JUMPS, self._tolerance
        if before and before.apart and apart:  # three runs show by which order errors shrink
            shown = before.order_to(apart)
            order = min(highest, max(shown, ORDER_OF_JUMPS))
            # the first runs may show the errors of steps, and the last one those of events
            order = min(order, ORDER_OF_EVENTS) if self._expected.ends_at_events else order
            # a higher order than there is: the errors of the first run did not shrink by order yet
            return order, min(order, cautious) if shown > highest else order, self._tolerance
        if highest == ORDER_OF_JUMPS:
            return highest, cautious, self._tolerance
        if self._expected.ends_at_events:
            return ORDER_OF_EVENTS, ORDER_OF_EVENTS, aim
        return highest, cautious, aim

    def next_parts(self, last: Attempt | None) -> int:
        """Parts of each step of the first run that should keep the tolerance."""
        if last is None:
            return 2
        share = (last.error_by_order / (AIM * self._tolerance)) ** (1.0 / last.order)
        return math.ceil(min(MOST_TIMES * last.parts, last.parts * share))
