"""Runs of one scene that lose each other: where neighbouring motions part exponentially.

No method knows the end of such a motion, and each run is one sample of it: the rate is stated.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...models.arrays import Array

FEWEST_POINTS = 8  # to fit a rate to
POWER_LAW = 3.0  # errors that gather grow with time to this power at most: 2 for a phase's drift


@dataclass(frozen=True)
class Parting:
    """Two runs that lose each other exponentially.

    Attributes:
        rate: of their difference, per revolution, e-folds.
        revolution: from which they differ by a tenth of a signal's range.
    """

    rate: float
    revolution: float


def parted(revolutions: Array, apart: Array, size: Array, lost: int) -> Parting | None:
    """Whether runs have lost each other exponentially: faster than errors gather.

    Motion that grows takes its error along: what counts is their ratio.

    Args:
        revolutions: (T,) done at each point.
        apart, size: (T,) difference of a signal, and its size.
        lost: index of the point where they differ by `PARTED`.
    """
    begin, half = np.searchsorted(revolutions, np.array([0.1, 0.5]) * revolutions[lost])
    if lost - half < FEWEST_POINTS:
        return None
    grown, most = np.maximum.accumulate(apart), np.maximum.accumulate(size)
    if not most[begin] > 0.0:
        return None
    ratio = grown[begin : lost + 1] / most[begin : lost + 1]
    turned = revolutions[begin : lost + 1]
    if not ratio[0] > 0.0 or ratio[-1] < 2.0**POWER_LAW * ratio[half - begin]:
        return None
    slope = np.polynomial.Polynomial.fit(turned, np.log(ratio), 1).convert().coef[1]
    return Parting(float(slope), float(revolutions[lost]))
