"""Dubovik's window of a liquid balancer in ball arithmetic, for exact values and for intervals.

By Routh and Hurwitz m s^2 + (p + chi) s + c - i p w has no root with Re s >= 0 where p + chi > 0
and (p + chi)^2 c > m p^2 w^2, which is (10); (11) compares the bending with and without liquid.
Every parameter stands once in these forms: of intervals they give the exact range.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

from flint import arb

from .arrays import Unproved

_DIGITS = 35


@dataclass(frozen=True, eq=False)
class WindowBalls:
    """Limits of a set of machines.

    Attributes:
        lower: w_* (11): less bending than without liquid above it [rad/s].
        upper: w^* (10): stable below it, unstable above; None: no limit, stable at every speed.
        margin: (1 + chi/p)^2 - 2 mu/(1 + mu): positive where the window is open; the stiffness does
            not count.
    """

    lower: arb
    upper: arb | None
    margin: arb

    @classmethod
    def of(
        cls, rotor_mass: arb, added: arb, stiffness: arb, external: arb, internal: arb
    ) -> WindowBalls:
        """The limits.

        Raises:
            Unproved: damping is not proved to be there, or internal damping may be 0 or not.
        """
        lower = (2 * stiffness / (2 * rotor_mass + added)).sqrt()
        if not external + internal > 0:
            raise Unproved("rotor.damping: without damping nothing decays")
        if internal.is_zero():
            return cls(lower, None, arb(1))
        if not internal > 0:
            raise Unproved("rotor.internal_damping: its interval must not contain 0")
        ratio = 1 + external / internal
        upper = ratio * (stiffness / (rotor_mass + added)).sqrt()
        return cls(lower, upper, ratio * ratio - 2 + 2 / (2 + added / rotor_mass))

    @property
    def state(self) -> Literal["unbounded", "open", "empty", "undecided"]:
        """What is proved of the window w_* < w < w^*, for all machines."""
        if self.upper is None:
            return "unbounded"
        if self.margin > 0:
            return "open"
        return "empty" if self.margin <= 0 else "undecided"

    def as_json(self) -> dict[str, Any]:
        """Both limits as intervals and as balls in decimal digits."""
        return {
            "state": self.state,
            "less_bending_above": shown(self.lower),
            "stable_below": None if self.upper is None else shown(self.upper),
        }


def ends(ball: arb) -> tuple[float, float]:
    """Doubles below and above."""
    low, high = float(ball.lower()), float(ball.upper())
    return math.nextafter(low, -math.inf), math.nextafter(high, math.inf)


def shown(ball: arb) -> dict[str, Any]:
    """An enclosure as two doubles and in decimal digits."""
    low, high = ends(ball)
    return {"from": low, "to": high, "ball": ball.str(_DIGITS)}
