"""How many balls or rollers, and how large: the closed forms of Goncharov 2017.

Goncharov's R is the radius of the race, on which the weights roll; their centres move on R - r.
Here `race` is that R, `ratio` is rho = r/R, and `track` is the radius of the centres' circle, the
`track_radius` of `Weights`: track = race - radius.  Neighbours that touch stand 2 alpha apart,

    sin alpha = radius/track = rho/(1 - rho).                                                  (4)

Errata, each confirmed by a test: after the packed spread of 5.4.1 the text has alpha = pi/n for a
half-filled race where (11) is right, alpha = pi/(2n); the brace of (16) closes before the root,
which divides the second term only; two s of Table 1 are not rounded, that of 3 balls, .0518, cut
off to .051, and that of 5 rollers, .13948, rounded twice to .140 by way of .1395; and its sectors
of 5, 7 and 8 rollers (195, 205, 208 degrees) should read 195.8, 204.5 and 207.5.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterable, Sequence

from ..constants import TRACK_SLACK
from ..spacing import half_angle, touching
from ..weights import Weights

_KINDS = ("balls", "rollers")


def packed_sine(count: int, alpha: float) -> float:
    """sin(n alpha)/sin(alpha), the moment of n weights in contact in units of one's (5)."""
    if alpha == 0.0:
        return float(count)
    return math.sin(count * alpha) / math.sin(alpha)


def weight_mass(kind: str, radius: float, density: float, height: float | None = None) -> float:
    """Mass of a ball, or of a roller of given height (6) [kg].

    Raises:
        ValueError: another kind, or a roller without height.
    """
    _known(kind)
    if kind == "balls":
        return 4.0 / 3.0 * math.pi * radius**3 * density
    if height is None:
        raise ValueError("height: a roller needs one [m]")
    return math.pi * radius**2 * height * density


def capacity(mass: float, track: float, radius: float, count: int) -> float:
    """Largest unbalance S = m (R - r) sin(n alpha)/sin(alpha) that weights balance (5) [kg m].

    One weight has m (R - r) at any radius; point weights (radius 0) have n m (R - r).

    Raises:
        ValueError: the weights do not fit on the track.
    """
    if count == 1:
        return mass * track
    alpha = half_angle(radius, track)
    demand_fit(count, alpha)
    return mass * track * packed_sine(count, alpha)


def moment_range(moments: Sequence[float], sines: Sequence[float]) -> tuple[float, float]:
    """Least and largest static moment that weights on one track can have together [kg m].

    The largest is that of all in contact.  The polygon of the moments closes unless one of them is
    larger than the others in contact.

    Args:
        moments: m R of each, in the order in which they stand [kg m].
        sines: radius over track radius of each; 0: points.
    """
    largest = max(moments)
    k = list(moments).index(largest)
    others = [*moments[k + 1 :], *moments[:k]], [*sines[k + 1 :], *sines[:k]]
    least = largest - largest_static_moment(*others) if others[0] else largest
    return max(0.0, least), largest_static_moment(moments, sines)


def largest_static_moment(moments: Sequence[float], sines: Sequence[float]) -> float:
    """Largest static moment of weights in contact, whichever is the first [kg m]."""
    if not any(sines):
        return math.fsum(moments)
    found, n = [], len(moments)
    for first in range(n):
        position, total = 0.0, 0j  # angle on the track
        for j in range(n):
            k, after = (first + j) % n, (first + j + 1) % n
            total += cmath.rect(moments[k], position)
            position += touching(sines[k], sines[after], 1.0)
        found.append(abs(total))
    return max(found)


def capacity_shape(kind: str, ratio: float, count: int) -> float:
    """s(rho) (9): capacity over 4 pi/3 density R^4 (balls), pi density height R^3 (rollers).

    n = 1 is continued by sin alpha = rho/(1 - rho) beyond rho = 1/2, where alpha ends.
    """
    _known(kind)
    rollers = ratio * (1.0 - ratio) ** 2 * _filled_sine(ratio, count)
    return ratio * rollers if kind == "balls" else rollers


def best_ratio(kind: str, count: int) -> float:
    """rho of the largest capacity for n weights, Table 1.

    The maximum of log s: (2 or 1)/rho - 2/(1 - rho) + n alpha' cot(n alpha) = 0; n = 1 exactly.
    """
    _known(kind)
    power = 2.0 if kind == "balls" else 1.0
    if count == 1:
        return (power + 1.0) / (power + 2.0)
    if count == 2:  # s_r = 2 rho^2 sqrt(1 - 2 rho), and its bracket would end in that root's zero
        return (power + 1.0) / (2.0 * power + 3.0)

    def slope(ratio: float) -> float:
        alpha = math.asin(ratio / (1.0 - ratio))
        slope_of_alpha = 1.0 / ((1.0 - ratio) * math.sqrt(1.0 - 2.0 * ratio))  # d alpha / d rho
        return (
            power / ratio - 2.0 / (1.0 - ratio) + count * slope_of_alpha / math.tan(count * alpha)
        )

    full = full_ratio(count)  # the slope falls from +infinity at 0 to -infinity there
    from scipy.optimize import brentq  # `run` does without

    return float(brentq(slope, 1e-6 * full, full * (1.0 - 1e-9), xtol=1e-15))


def full_ratio(count: int) -> float:
    """rho at which n >= 2 weights fill the whole race, 1/(1 + csc(pi/n))."""
    if count < 2:
        raise ValueError(f"count = {count!r}: one weight never fills a race, must be 2 or more")
    return 1.0 / (1.0 + 1.0 / math.sin(math.pi / count))


def filled_sector(ratio: float, count: int) -> float:
    """Angle 2 n alpha of the race that n weights occupy [rad]."""
    return 2.0 * count * math.asin(ratio / (1.0 - ratio))


def packed_alignment(count: int, alpha: float) -> float:
    """p of n weights in one packed group, |sin 2 n alpha|/(n sin 2 alpha)."""
    if math.sin(2.0 * alpha) == 0.0:
        return 1.0
    return abs(math.sin(2 * count * alpha) / (count * math.sin(2.0 * alpha)))


def largest_alignment(count: int, alpha: float) -> float:
    """Largest p: two packed groups face to face, (10) for even n and (13) for odd n."""
    if alpha == 0.0:
        return 1.0
    if count % 2:
        return packed_sine(count, alpha) / count
    # n = 2 gives 1 at every alpha, also at alpha = pi/2 where (10) is 0/0
    return 1.0 if count == 2 else 2.0 * math.sin(count * alpha) / (count * math.sin(2.0 * alpha))


def settling_shape(kind: str, ratio: float, count: int) -> float:
    """Dimensionless a at the largest p, (15) for odd n and (16) for even n.

    rho^2 n (1 - p) for rollers, rho^3 n (1 - p) for balls.
    """
    _known(kind)
    sine = _filled_sine(ratio, count)
    if count % 2:
        taken = (1.0 - ratio) * sine
    elif count == 2:
        taken = 2.0 * ratio
    else:
        taken = (1.0 - ratio) ** 2 * sine / math.sqrt(1.0 - 2.0 * ratio)
    rollers = ratio * (count * ratio - taken)
    return ratio * rollers if kind == "balls" else rollers


def fastest_count(kind: str, counts: Iterable[int] = range(2, 9)) -> int:
    """Number of weights that settles fastest at the radii of Table 1: 3 balls, 5 rollers."""
    return max(counts, key=lambda count: settling_shape(kind, best_ratio(kind, count), count))


def residual_unbalance(weights: Weights, radius: float, unbalance: float) -> float:
    """Least static moment that weights of a radius can leave of an unbalance U [kg m].

    U - S beyond the capacity S, 0 up to it; a single weight can only balance U = S.
    """
    weights.refuse_unequal("the residual unbalance")
    limit = capacity(weights.mass, weights.track_radius, radius, weights.count)
    excess = unbalance - limit
    return abs(excess) if weights.count == 1 else max(0.0, excess)


def packed_angles(weights: Weights, radius: float, heavy: float = 0.0) -> list[float]:
    """Angles of the packed group opposite to an unbalance at angle `heavy` [rad].

    Where the weights stand when the unbalance is at least their capacity.
    """
    count = weights.count
    alpha = half_angle(radius, weights.track_radius) if count > 1 else 0.0
    return [heavy + math.pi + alpha * (2 * k - count + 1) for k in range(count)]


def _filled_sine(ratio: float, count: int) -> float:
    """sin(n alpha) of a race of ratio rho."""
    sine = ratio / (1.0 - ratio)
    if count == 1:
        return sine
    if not 0.0 <= ratio <= full_ratio(count) * (1.0 + TRACK_SLACK):
        raise ValueError(
            f"ratio = {ratio!r}: {count} weights fit up to rho = {full_ratio(count):.6g}"
        )
    return math.sin(count * math.asin(min(1.0, sine)))


def demand_fit(count: int, alpha: float) -> None:
    if count * alpha > math.pi * (1.0 + TRACK_SLACK):
        raise ValueError(
            f"count = {count!r}: weights {2.0 * alpha:.6g} rad apart fill the track at "
            f"{int(math.pi / alpha)}"
        )


def _known(kind: str) -> None:
    if kind not in _KINDS:
        raise ValueError(f"kind = {kind!r}: must be one of {', '.join(_KINDS)}")
