"""How well a count tells a share: its confidence interval."""

from __future__ import annotations

import math

_NORMAL = 1.959963984540054  # two-sided 95 %


def wilson(count: int, of: int) -> tuple[float, float]:
    """95 % confidence interval of a share (Wilson 1927)."""
    share, z2 = count / of, _NORMAL**2
    middle = (share + z2 / (2.0 * of)) / (1.0 + z2 / of)
    half = _NORMAL * math.sqrt(share * (1.0 - share) / of + z2 / (4.0 * of * of)) / (1.0 + z2 / of)
    return max(0.0, middle - half), min(1.0, middle + half)
