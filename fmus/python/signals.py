"""Vector signals between Python units: a value with its slopes, in fixed axes or the rotor's."""

from __future__ import annotations

import cmath
from collections.abc import Sequence

Signal = tuple[complex, complex]  # a vector and its slope


def cubic_of(signal: Sequence[float]) -> tuple[complex, complex, complex, complex]:
    """Value and derivatives from the eight inputs of one vector signal."""
    x0, y0, x1, y1, x2, y2, x3, y3 = signal
    return complex(x0, y0), complex(x1, y1), complex(x2, y2), complex(x3, y3)


def rotating(vector: Signal, angle: float, speed: float) -> Signal:
    """A vector and its slope in axes that turn: those of the rotor.

    With the negative angle and speed the vector is taken back to fixed axes.
    """
    value, slope = vector
    turn = cmath.rect(1.0, -angle)
    return value * turn, (slope - 1j * speed * value) * turn
