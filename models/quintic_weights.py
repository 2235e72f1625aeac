"""Point weights under a quintic signal: one derivative beyond `weights`.

With theta'' + d theta' = g(t, theta) and g = -Im(a e^{-i theta})/(kappa R) - s w' as there, drag is
integrated exactly and g as a quintic with the exact values, slopes and second derivatives of both
ends (a three-derivative exponential collocation of order 6).
"""

from __future__ import annotations

import math
from cmath import rect
from collections.abc import Sequence
from functools import lru_cache

from .quintic import at, hermite
from .spin import STEADY, Rates, spin_at
from .weights import (
    FAR,
    MAX_ITERATIONS,
    MAX_SUBSTEPS,
    Weights,
    converged,
    phi_functions,
    substeps,
    unsolved,
)

Motion = tuple[complex, complex, complex]  # acceleration of the track's centre, derivatives 1 and 2


@lru_cache(maxsize=256)  # steps and substeps of a run: few lengths, which return each turn
def quadrature(damping_rate: float, step: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Exact response of rate and angle over `step` to the rate and to g's derivatives 0 to 5."""
    phi = phi_functions(-damping_rate * step, 7)
    speed = tuple(step**k * phi[k] for k in range(7))
    angle = tuple(step ** (k + 1) * phi[k + 1] for k in range(7))
    return speed, angle


def along_track(
    motion: Motion,
    lag: Rates,
    angle: float,
    angle_rate: float,
    lever: float,
    damping_rate: float,
) -> tuple[float, float, float]:
    """Drive g = Im(a e^{-i theta}) times `lever` - lag, and its time derivatives along the motion.

    Args:
        lag: s w', by which a free weight falls behind [rad/s^2], and its derivatives 1 and 2.
        angle, angle_rate: of the weight [rad, rad/s].
        lever: -1/(kappa R) [1/m].
        damping_rate: d [1/s].
    """
    acceleration, slope, second = motion
    direction = rect(lever, -angle)
    along = acceleration * direction
    along_slope = slope * direction
    drive = along.imag - lag[0]
    return (
        drive,
        along_slope.imag - along.real * angle_rate - lag[1],
        (second * direction).imag
        - 2.0 * along_slope.real * angle_rate
        - along.real * (drive - damping_rate * angle_rate)
        - along.imag * angle_rate * angle_rate
        - lag[2],
    )


def substep(
    angle: float,
    angle_rate: float,
    ends: tuple[Motion, Motion],
    lags: tuple[Rates, Rates],
    lever: float,
    damping_rate: float,
    step: float,
) -> tuple[float, float]:
    """Angle and rate of one weight after `step`; order 6.

    Args:
        angle, angle_rate: at the start [rad, rad/s].
        ends, lags: motion of the track's centre, and lag, at the start and at the end.
        lever, damping_rate: as of `along_track`.

    Raises:
        ArithmeticError: the implicit equations did not converge.
    """
    (e, s0, s1, s2, s3, s4, s5), (t, t0, t1, t2, t3, t4, t5) = quadrature(damping_rate, step)
    begin = along_track(ends[0], lags[0], angle, angle_rate, lever, damping_rate)
    g0, g1, g2 = begin
    free_rate = e * angle_rate + s0 * g0 + s1 * g1 + s2 * g2
    free_angle = angle + t * angle_rate + t0 * g0 + t1 * g1 + t2 * g2
    new_angle, new_rate, change = free_angle, free_rate, 1.0  # it contracts fast, as in `weights`
    for _ in range(MAX_ITERATIONS):
        end = along_track(ends[1], lags[1], new_angle, new_rate, lever, damping_rate)
        g3, g4, g5 = hermite(begin, end, step)
        last_angle, last_rate, last_change = new_angle, new_rate, change
        new_rate = free_rate + s3 * g3 + s4 * g4 + s5 * g5
        new_angle = free_angle + t3 * g3 + t4 * g4 + t5 * g5
        change = abs(new_angle - last_angle) + abs(new_rate - last_rate) * step
        if converged(change, last_change, new_angle):
            return new_angle, new_rate
    raise unsolved(step, angle, angle_rate, ends[0][0])


def advance(
    weights: Weights,
    angles: Sequence[float],
    speeds: Sequence[float],
    signal: Sequence[complex],
    angular_acceleration: float,
    step: float,
    rates: Rates = STEADY,
) -> tuple[list[float], list[float]]:
    """Move every weight over one communication step; as `weights.advance`.

    Args:
        signal: acceleration of the track's centre in the rotor frame at the start of the step and
            its derivatives of order 1 to 5 [m/s^2, m/s^3, ...].

    Raises:
        ArithmeticError: the input is not finite, or asks for more than a million substeps.
    """
    if not math.isfinite(sum(angles)):
        raise ArithmeticError(f"the weights' angles {list(angles)} are not finite")
    # the iteration's end is judged by the angle: turns behind a weight must not loosen it
    behind = [
        2.0 * math.pi * round(angle / (2.0 * math.pi)) if abs(angle) > FAR else 0.0
        for angle in angles
    ]
    count = substeps(weights, speeds, signal, angular_acceleration, step, step, MAX_SUBSTEPS)
    h = step / count
    new_angles = [angle - turned for angle, turned in zip(angles, behind, strict=True)]
    new_speeds = list(speeds)
    start: Motion = (signal[0], signal[1], signal[2])
    lag = _lag(weights, angular_acceleration, rates, 0.0)
    for j in range(1, count + 1):
        end, end_lag = at(signal, j * h), _lag(weights, angular_acceleration, rates, j * h)
        for k, (angle, speed) in enumerate(zip(new_angles, new_speeds, strict=True)):
            new_angles[k], new_speeds[k] = substep(
                angle, speed, (start, end), (lag, end_lag), weights.lever, weights.damping_rate, h
            )
        start, lag = end, end_lag
    return [angle + turned for angle, turned in zip(new_angles, behind, strict=True)], new_speeds


def _lag(weights: Weights, angular_acceleration: float, rates: Rates, time: float) -> Rates:
    a, b, c = spin_at(angular_acceleration, rates, time)
    return weights.spin_share * a, weights.spin_share * b, weights.spin_share * c


def reaction_second(
    weights: Weights,
    angles: Sequence[float],
    speeds: Sequence[float],
    motion: Motion,
    rotor_speed: float,
    spin_up: Rates = STEADY,
) -> complex:
    """Second derivative of `weights.reaction` [N/s^2].

    Args:
        angles, speeds: (N,) [rad, rad/s].
        motion: of the track's centre in the rotor frame [m/s^2, m/s^3, m/s^4].
        rotor_speed: w [rad/s].
        spin_up: derivatives of w of order 1 to 3 [rad/s^2, rad/s^3, rad/s^4].
    """
    lever, damping_rate, w = weights.lever, weights.damping_rate, rotor_speed
    lag = _lag(weights, spin_up[0], (spin_up[1], spin_up[2], 0.0), 0.0)
    # of (u'' + 2i w u' + (i w' - w^2) u)'' with u = e^{i theta}
    w1, w2, w3 = spin_up
    of_second, of_first = complex(-w * w, 5.0 * w1), complex(-4.0 * w * w1, 4.0 * w2)
    of_value = complex(-2.0 * (w1 * w1 + w * w2), w3)
    total = 0j
    for angle, nu in zip(angles, speeds, strict=True):
        g0, g1, g2 = along_track(motion, lag, angle, nu, lever, damping_rate)
        nu_1 = g0 - damping_rate * nu
        nu_2 = g1 - damping_rate * nu_1
        nu_3 = g2 - damping_rate * nu_2
        # derivatives of e^{i theta} of order 1 to 4, over e^{i theta}
        first = complex(0.0, nu)
        second = complex(-nu * nu, nu_1)
        third = complex(-3.0 * nu * nu_1, nu_2 - nu**3)
        fourth = complex(nu**4 - 3.0 * nu_1 * nu_1 - 4.0 * nu * nu_2, nu_3 - 6.0 * nu * nu * nu_1)
        changing = of_second * second + of_first * first + of_value
        total += (fourth + 2j * w * third + changing) * rect(1.0, angle)
    return -weights.moment * total
