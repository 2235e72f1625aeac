"""Where weights of finite size stand when they balance a rotor, or try to (Goncharov 2017).

n weights balance an unbalance U from 0 to their capacity in an (n - 2)-parameter family of
positions; beyond the capacity S they stand packed opposite to it and U - S is left.  Angles are in
the rotor; neighbours stand at least 2 alpha apart (4).
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence

from scipy.optimize import brentq

from ..contact.spacing import SLACK, half_angle, least_distance
from ..weights import Weights
from .capacity import demand_fit, packed_sine


def packed_angles(weights: Weights, radius: float, heavy: float = 0.0) -> list[float]:
    """Angles of the packed group opposite to an unbalance at angle `heavy` [rad].

    Where the weights stand when the unbalance is at least their capacity.
    """
    alpha = half_angle(radius, weights.track_radius) if weights.count > 1 else 0.0
    return _fan(weights.count, alpha, heavy)


def fan_angles(
    weights: Weights, radius: float, unbalance: float, heavy: float = 0.0
) -> list[float]:
    """The balancing position with equal distances, for an unbalance at angle `heavy` [rad].

    From the regular polygon at unbalance 0 to the packed group at the capacity; one of the
    (n - 2)-parameter family of `completed_angles`.

    Raises:
        ValueError: the unbalance is beyond the capacity, or there is one weight only.
    """
    count, unit = weights.count, weights.moment
    alpha = half_angle(radius, weights.track_radius)
    demand_fit(count, alpha)
    limit = unit * packed_sine(count, alpha)
    if count == 1 or not 0.0 <= unbalance <= limit * (1.0 + SLACK):
        raise ValueError(
            f"unbalance = {unbalance!r} kg m: {count} weights balance "
            + (f"{limit:.6g} kg m only" if count == 1 else f"0 to {limit:.6g} kg m")
        )

    def moment(beta: float) -> float:
        return packed_sine(count, beta) - unbalance / unit

    low, high = alpha, math.pi / count
    beta = low if moment(low) <= 0.0 else float(brentq(moment, low, high + SLACK, xtol=1e-15))
    return _fan(count, beta, heavy)


def completed_angles(
    weights: Weights, radius: float, unbalance: complex, free: Sequence[float]
) -> list[float]:
    """A balancing position from the angles of n - 2 weights chosen freely.

    The last two carry what is left, V = -U/(m R) - sum e^{i psi}: they stand at
    arg V +- acos(|V|/2).  This is the whole (n - 2)-parameter family of main motions.

    Args:
        unbalance: static moment of the rotor, xi + i eta [kg m].
        free: (n - 2,) angles [rad].

    Raises:
        ValueError: too much is left for two weights, or weights overlap: outside of the family.
    """
    if weights.count < 2 or len(free) != weights.count - 2:
        raise ValueError(f"free: must be {weights.count - 2} angles, got {len(free)}")
    unit = weights.moment
    left = -unbalance / unit - sum(cmath.rect(1.0, angle) for angle in free)
    if abs(left) > 2.0 + SLACK:
        raise ValueError(f"free: two weights cannot carry {abs(left):.6g} times one's moment")
    half = math.acos(min(1.0, abs(left) / 2.0))
    middle = cmath.phase(left)
    angles = [*free, middle - half, middle + half]
    nearest = least_distance(angles)
    apart = 2.0 * half_angle(radius, weights.track_radius)
    if nearest < apart * (1.0 - SLACK):
        raise ValueError(f"free: weights overlap, {nearest:.6g} rad apart instead of {apart:.6g}")
    return angles


def _fan(count: int, beta: float, heavy: float) -> list[float]:
    return [heavy + math.pi + beta * (2 * k - count + 1) for k in range(count)]
