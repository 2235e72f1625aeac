"""Where a measured function of the speed changes its sign."""

from __future__ import annotations

from collections.abc import Callable

from scipy.optimize import brentq

from ..errors import SimulationError

WIDTHS = (0.02, 0.1, 0.3, 1.0, 3.0)  # of the guess: narrow first, for another change may be near
POSITION = 1e-10  # of the guess: far below any tolerance of a row


def sign_change(function: Callable[[float], float], guess: float, what: str) -> float:
    """Speed at which a measured function changes sign, searched outward from a guess [rad/s].

    A function that is zero, or not a number, at an end of the range searched has no sign there.

    Raises:
        SimulationError: no change of sign from a quarter of the guess to four times it.
    """
    for width in WIDTHS:
        left, right = guess / (1.0 + width), guess * (1.0 + width)
        below, above = sorted((function(left), function(right)))
        if below < 0.0 < above:
            return float(brentq(function, left, right, xtol=POSITION * guess, rtol=1e-12))
    raise SimulationError(f"{what} was not found between {guess / 4.0:g} and {4.0 * guess:g} rad/s")
