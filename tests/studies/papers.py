"""Closed forms of the papers that serve tests alone: what the code's results are held against."""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from autobalancer.models.constants import TRACK_SLACK as SLACK
from autobalancer.models.criteria import Criterion
from autobalancer.models.papers.capacity import demand_fit, packed_sine
from autobalancer.models.papers.influence import Complex, unbalance_from_response
from autobalancer.models.spacing import closest, half_angle
from autobalancer.models.weights import Weights

# -- Goncharov 2017 -------------------------------------------------------------------------------


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
    return [heavy + math.pi + beta * (2 * k - count + 1) for k in range(count)]


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
    nearest = closest(angles)[0]
    apart = 2.0 * half_angle(radius, weights.track_radius)
    if nearest < apart * (1.0 - SLACK):
        raise ValueError(f"free: weights overlap, {nearest:.6g} rad apart instead of {apart:.6g}")
    return angles


def slow_roots(weights: Weights, alignment: float, response: complex) -> NDArray[np.complex128]:
    """All four quasi-static roots, slowest (largest real part) first [1/s].

    Args:
        weights: n, m, kappa and the drag.
        alignment: p of the main motion.
        response: Y, `plane_response`; its imaginary part is the rotor's damping.
    """
    turn = cmath.sqrt((alignment * abs(response)) ** 2 - response.imag**2)
    share = weights.count * weights.mass / (2.0 * weights.kappa)
    found: list[complex] = []
    for mu in (response.real + turn, response.real - turn):
        found.extend(np.roots([1.0, weights.damping_rate, -share * mu]))
    return np.array(sorted(found, key=lambda root: -root.real), np.complex128)


# -- Polushkin 2016 -------------------------------------------------------------------------------


def inverse_dynamic_stiffness(
    mass: float,
    inertia: float,
    span: float,
    stiffness: Sequence[float],
    damping: Sequence[float],
    speed: float,
) -> Complex:
    """[L]^-1 (2, 2) [m/N] of the symmetric rigid rotor in one axis, Polushkin 2016 (13), (14).

    Args:
        mass, inertia, span: m [kg], I [kg m^2], l [m]; the centre of mass is in the middle.
        stiffness, damping: (k1, k2) [N/m] and (c1, c2) [N s/m].
        speed: w [rad/s].
    """
    own = speed**2 * (mass / 4.0 + inertia / span**2)
    cross = speed**2 * (mass / 4.0 - inertia / span**2)
    first = stiffness[0] - own + 1j * speed * damping[0]
    second = stiffness[1] - own + 1j * speed * damping[1]
    determinant = first * second - cross**2
    return np.array([[second, cross], [cross, first]]) / determinant


def left_plane(inverse: Complex, span: float, speed: float, distance: float) -> Complex:
    """(15): {K_11, K_21} of a plane at `distance` A from the left support, (2,) [1/kg]."""
    return speed**2 / span * (inverse @ np.array([span - distance, distance]))


def right_plane(inverse: Complex, span: float, speed: float, distance: float) -> Complex:
    """(17): {K_12, K_22} of a plane at `distance` C from the right support, (2,) [1/kg]."""
    return speed**2 / span * (inverse @ np.array([distance, span - distance]))


def balancing_cycles(
    true: NDArray, used: NDArray, unbalance: NDArray, allowed: float, most: int = 50
) -> list[Complex]:
    """Unbalances (p,) found at each run, the last one the control run within `allowed` [kg m].

    The number of entries is the paper's number of balancing cycles.  When `most` runs do not
    suffice the last entry is still above `allowed`.

    Args:
        true, used: (s, p) coefficients of the machine, and those its operator works with [1/kg].
        unbalance: (p,) complex unbalances at the start [kg m].
        allowed: largest modulus that may remain in any plane [kg m].
    """
    runs = [np.asarray(unbalance, complex)]
    while np.abs(runs[-1]).max() > allowed and len(runs) < most:
        runs.append(runs[-1] - unbalance_from_response(used, np.asarray(true) @ runs[-1]))
    return runs


# -- Filimonikhina 2017 ---------------------------------------------------------------------------


def coefficients(of: Criterion) -> tuple[float, float, float, float]:
    """(c0, c1, c2, c3) of P = c0 W^3 + c1 W^2 + c2 W + c3, W = w^2 (30), (31)."""
    x, y, b_x, b_y = of.w_x**2, of.w_y**2, of.b_x**2, of.b_y**2
    return (
        -2.0,
        3.0 * (x + y) - b_x - b_y,
        -((x + y) ** 2 + 2.0 * x * y - (x * b_y + y * b_x)),
        x * y * (x + y),
    )


def discriminant(of: Criterion) -> float:
    """Of the cubic, over (w_x w_y)^6 (32): positive when it has three different real roots."""
    scale = of.w_x * of.w_y
    c0, c1, c2, c3 = (c / scale**k for k, c in enumerate(coefficients(of)))
    return (
        -4.0 * c1**3 * c3
        + c1**2 * c2**2
        - 4.0 * c0 * c2**3
        + 18.0 * c0 * c1 * c2 * c3
        - 27.0 * c0**2 * c3**2
    )


def positive_roots(of: Criterion) -> int:
    """Number of critical speeds by (32), (33): three or one.

    With equal stiffness it is one (22).  (33) beyond (32) reads: coefficients of alternating
    signs; three real roots are then all positive.
    """
    _, c1, c2, _ = coefficients(of)
    three = of.w_x != of.w_y and discriminant(of) > 0.0 and c1 > 0.0 and c2 < 0.0
    return 3 if three else 1
