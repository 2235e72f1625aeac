"""The rotor's angle as whole turns and a remainder, so that sums over any time add no error."""

from __future__ import annotations

import math

from ...models.constants import TURN_ROUNDING

TURN = 2.0 * math.pi


def turned(angle: list[float], by: float) -> list[float]:
    """The angle (turns, remainder, carry) turned by `by` [rad]; Kahan's summation."""
    turns, rest, carry = angle
    if abs(by) > math.pi:
        part = math.remainder(by, TURN)
        whole = float(round((by - part) / TURN))
        by, turns, carry = part, turns + whole, carry + whole * TURN_ROUNDING
    by -= carry
    end = rest + by
    carry = (end - rest) - by
    if end > math.pi:
        end, turns, carry = end - TURN, turns + 1.0, carry + TURN_ROUNDING
    elif end < -math.pi:
        end, turns, carry = end + TURN, turns - 1.0, carry - TURN_ROUNDING
    return [turns, end, carry]


def total(angle: list[float]) -> float:
    """The angle as one number [rad], with the digits of its size."""
    turns, rest, carry = angle
    return turns * TURN + (rest + (turns * TURN_ROUNDING - carry))
