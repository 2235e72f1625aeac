"""Numbers of a verdict as people read them."""

from __future__ import annotations

from ....models.readable import brief, rounded

_COUNTED = 10  # times: so often or more is counted exactly by no run
_SHORTEST, _LONGEST = 1e-4, 1e9  # s: nothing beside a run; some 30 years
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


def seconds(time: float, digits: int = 2) -> str:
    """A time [s] as people read it."""
    if 0.0 < time < _SHORTEST:
        return f"below {_SHORTEST:g} s"
    return "over a billion s" if time >= _LONGEST else f"{brief(time, digits)} s"


def show_too_little(revolutions: float) -> str:
    """That so few revolutions do."""
    turned = rounded(revolutions, 2)
    return f"{turned} revolution{' shows' if turned == '1' else 's show'} too little"


def times(count: int, before: int | None = None) -> str:
    """How often something that steps decide has happened, as exactly as it is known.

    The last touches of a bounce are so weak that the steps' tolerance decides whether they happen.

    Args:
        before: how often in a run of larger errors; None: not known.
    """
    low, high = sorted((count, count if before is None else before))
    if 2 * low >= high >= _COUNTED:
        return f"about {_whole((low + high) // 2)} times"
    often = "once" if high == 1 else f"{_whole(high)} times"
    if low == 0:
        often = f"at most {often}"
    elif low != high:
        often = f"{low} to {often}"
    return often if high < _COUNTED else f"about {often}"


def _whole(count: int) -> int:
    """A number of times with the digits that it is known by: tens, or two digits."""
    return count if count < _COUNTED else round(count, -max(1, len(str(count)) - 2))
