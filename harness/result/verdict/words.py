"""Numbers of a verdict as people read them."""

from __future__ import annotations

from ...units import brief

_MOST = 1e6  # per cent, mm, or mm/s: more says only that the motion has no bound


def percent(share: float) -> str:
    """A share as people read it."""
    value = 100.0 * share
    if 0.0 <= value < 0.01:
        return "below 0.01 %"
    return "over a million %" if value > _MOST else f"{brief(value)} %"


def millimetres(size: float) -> str:
    """A vibration [m] as people read it."""
    value = 1e3 * size
    if is_nothing(size):
        return "below 0.0001 mm"
    return "over 1 km" if value > _MOST else f"{brief(value)} mm"


def is_nothing(size: float) -> bool:
    """Whether a vibration [m] is as good as none."""
    return size < 1e-7


def velocity(size: float) -> str:
    """A vibration velocity, rms [m/s], as people read it."""
    value = 1e3 * size
    if value < 1e-4:
        return "below 0.0001 mm/s rms"
    return "over 1 km/s rms" if value > _MOST else f"{brief(value)} mm/s rms"
