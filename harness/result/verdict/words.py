"""Numbers of a verdict as people read them."""

from __future__ import annotations

from ...units import brief


def percent(share: float) -> str:
    """A share as people read it."""
    value = 100.0 * share
    return "below 0.01 %" if 0.0 <= value < 0.01 else f"{brief(value)} %"


def millimetres(size: float) -> str:
    """A vibration [m] as people read it."""
    value = 1e3 * size
    return "below 0.0001 mm" if value < 1e-4 else f"{brief(value)} mm"
