"""Rows of a check: what is expected, what was measured, how far they may part, the time it took."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from ..errors import SimulationError
from .report import Row


@dataclass
class Rows:
    """Makes the rows of one check; the clock starts anew with every row."""

    scene: str
    check: str
    begun: float = 0.0

    def __post_init__(self) -> None:
        self.begun = time.perf_counter()

    def _row(self, **facts: object) -> Row:
        now = time.perf_counter()
        seconds, self.begun = now - self.begun, now
        return Row(scene=self.scene, check=self.check, seconds=seconds, **facts)  # type: ignore[arg-type]

    def number(
        self,
        quantity: str,
        expected: float,
        measured: float,
        tolerance: float,
        source: str,
        scale: float | None = None,
    ) -> Row:
        """Holds if |measured - expected| <= tolerance * scale; the default scale is |expected|."""
        size = abs(expected) if scale is None else scale
        error = abs(measured - expected) / size
        return self._row(
            quantity=quantity,
            expected=expected,
            measured=measured,
            error=error,
            tolerance=tolerance,
            holds=bool(error <= tolerance),
            source=source,
        )

    def worst(
        self,
        quantity: str,
        expected: np.ndarray,
        measured: np.ndarray,
        tolerance: float,
        source: str,
        scale: np.ndarray | float | None = None,
    ) -> Row:
        """The point of a curve where measured and expected differ most."""
        errors = np.abs(measured - expected) / (np.abs(expected) if scale is None else scale)
        worst = int(np.argmax(np.where(np.isfinite(errors), errors, np.inf)))
        return self._row(
            quantity=quantity,
            expected=float(expected[worst]),
            measured=float(measured[worst]),
            error=float(errors[worst]),
            tolerance=tolerance,
            holds=bool(errors[worst] <= tolerance),
            source=source,
        )

    def statement(
        self, quantity: str, expected: str, measured: str, holds: bool, source: str
    ) -> Row:
        """A finding in words."""
        return self._row(
            quantity=quantity,
            expected=expected,
            measured=measured,
            error=None,
            tolerance=None,
            holds=bool(holds),
            source=source,
        )


def crossing(
    function: Callable[[float], float],
    guess: float,
    what: str,
    low: float = 0.0,
    relative: float = 1e-10,
) -> float:
    """Where a measured function changes sign, searched outward from a guess.

    Raises:
        SimulationError: no change of sign from a quarter of the guess (or `low`) to four times it.
    """
    for width in (0.02, 0.1, 0.3, 1.0, 3.0):
        left, right = max(low, guess / (1.0 + width)), guess * (1.0 + width)
        if function(left) * function(right) <= 0.0:
            return float(brentq(function, left, right, xtol=relative * guess, rtol=1e-12))
    raise SimulationError(
        f"{what} was not found between {max(low, guess / 4.0):g} and {4.0 * guess:g} rad/s"
    )
