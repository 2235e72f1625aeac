"""What values are allowed: one wording for all that are not."""

from __future__ import annotations

import math
from typing import Any


def demand(name: str, value: float, unit: str = "", least: float | None = None) -> float:
    """A value that is finite and positive, or with `least` not below it.

    Raises:
        ValueError: it is not; the text names it and says what is allowed.
    """
    if math.isfinite(value) and (value > 0.0 if least is None else value >= least):
        return value
    if least is None:
        allowed = "a positive finite number"
    else:
        allowed = "a finite number" + (f", {least:g} or more" if math.isfinite(least) else "")
    raise ValueError(f"{name} = {value!r}{unit and f' {unit}'}: must be {allowed}")


def demand_all(owner: Any, names: str, unit: str = "", least: float | None = None) -> None:
    """As `demand`, for attributes that are named with spaces between them."""
    for name in names.split():
        demand(name, getattr(owner, name), unit, least)
