"""Signals as complex numbers."""

from __future__ import annotations

from collections.abc import Sequence

from ...models import cubic, quintic


def orders(signal: Sequence[float]) -> tuple[complex, ...]:
    """Value and derivatives from the inputs of one vector signal: eight of a cubic."""
    if len(signal) == 8:
        x0, y0, x1, y1, x2, y2, x3, y3 = signal
        return complex(x0, y0), complex(x1, y1), complex(x2, y2), complex(x3, y3)
    return tuple(map(complex, signal[::2], signal[1::2]))


def derivatives_at(signal: Sequence[complex], time: float) -> tuple[complex, ...]:
    """Value and slope of a cubic `time` after its start, of a quintic the second derivative too."""
    return cubic.at(signal, time) if len(signal) == 4 else quintic.at(signal, time)
