"""Signals as complex numbers."""

from __future__ import annotations

from collections.abc import Sequence


def cubic_of(signal: Sequence[float]) -> tuple[complex, complex, complex, complex]:
    """Value and derivatives from the eight inputs of one vector signal."""
    x0, y0, x1, y1, x2, y2, x3, y3 = signal
    return complex(x0, y0), complex(x1, y1), complex(x2, y2), complex(x3, y3)
