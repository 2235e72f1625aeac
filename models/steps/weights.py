"""Motion of point weights in the frame of the rotor, and their force on it.

Filimonikhina 2017 (4) with theta = phi - beta (angle of a weight in the rotor) reads

    theta'' + d theta' = g(t, theta),   d = b/(kappa m),
    g = -Im(a e^{-i theta})/(kappa R) - s w',   s = (1 - (kappa - 1) r/R)/kappa,

with a the acceleration of the track's centre seen in the rotor frame.  Printed is s = 1, which is
right for pendulums: a body of radius r that rolls is also driven by a track that spins up (errata
in README.md).  Drag is integrated exactly
and g as a cubic with the exact values and slopes of both ends (a two-derivative exponential
collocation of order 4), so the drag may be of any size.
"""

from __future__ import annotations

import math
from cmath import rect
from collections.abc import Sequence
from functools import lru_cache

from ..constants import MAX_SUBSTEPS, TURN_PER_SUBSTEP
from ..cubic import at, hermite
from ..weights import Weights

MAX_ITERATIONS = 12  # the fixed point of a substep gains about two digits an iteration
SUBSTEP_CONVERGED = 1e-14  # relative to the size of the change over the substep
FAR_ANGLE = 1e4  # rad: beyond, whole turns are taken off while a step is computed


def phi_functions(z: float, count: int) -> tuple[float, ...]:
    """phi_0(z)..phi_count(z) for z <= 0, phi_k(z) = sum_j z^j/(j+k)!.

    Upward recursion loses digits for small |z|, where the series of the last one is summed instead
    and the others follow downward.
    """
    if z < -1.0:
        phi = [math.exp(z)]
        for k in range(count):
            phi.append((phi[k] - 1.0 / math.factorial(k)) / z)
        return tuple(phi)
    term = last = 1.0 / math.factorial(count)
    j = count
    while abs(term) > 1e-18 * last:
        j += 1
        term *= z / j
        last += term
    phi = [last]
    for k in range(count - 1, -1, -1):
        phi.append(z * phi[-1] + 1.0 / math.factorial(k))
    return tuple(reversed(phi))


@lru_cache(maxsize=256)  # steps and substeps of a run: few lengths, which return each turn
def quadrature(damping_rate: float, step: float) -> tuple[float, ...]:
    """Exact response of angle and rate over `step` to the rate and to g's value and derivatives."""
    phi = phi_functions(-damping_rate * step, 5)
    powers = [step**k for k in range(6)]
    speed = [powers[k] * phi[k] for k in range(5)]  # rate, g0, g1, g2, g3
    angle = [powers[k + 1] * phi[k + 1] for k in range(5)]
    return (*speed, *angle)


def substep(
    angle: float,
    angle_rate: float,
    ends: tuple[complex, complex, complex, complex],
    lever: float,
    lag: float,
    damping_rate: float,
    step: float,
) -> tuple[float, float]:
    """Angle and rate of one weight after `step`; order 4.

    Args:
        angle, angle_rate: at the start [rad, rad/s].
        ends: acceleration of the track's centre and its slope at the start, and at the end.
        lever: -1/(kappa R) [1/m].
        lag: s w', by which a free weight falls behind [rad/s^2].
        damping_rate: d [1/s].

    Raises:
        ArithmeticError: the implicit equations did not converge.
    """
    a0, da0, a1, da1 = ends
    e, s0, s1, s2, s3, t, t0, t1, t2, t3 = quadrature(damping_rate, step)
    direction = rect(lever, -angle)
    along = a0 * direction
    g0 = along.imag - lag
    g1 = (da0 * direction).imag - along.real * angle_rate
    free_rate = e * angle_rate + s0 * g0 + s1 * g1
    free_angle = angle + t * angle_rate + t0 * g0 + t1 * g1
    new_angle, new_rate = free_angle, free_rate
    g0 += lag
    change = 1.0  # a weight moves less than 0.15 rad in a substep, which makes it contract fast
    for _ in range(MAX_ITERATIONS):
        direction = rect(lever, -new_angle)
        along = a1 * direction
        slope = (da1 * direction).imag - along.real * new_rate
        g2, g3 = hermite(g0, g1, along.imag, slope, step)
        last_angle, last_rate, last_change = new_angle, new_rate, change
        new_rate = free_rate + s2 * g2 + s3 * g3
        new_angle = free_angle + t2 * g2 + t3 * g3
        change = abs(new_angle - last_angle) + abs(new_rate - last_rate) * step
        if converged(change, last_change, new_angle):
            return new_angle, new_rate
    raise ArithmeticError(
        f"the weights' step of {step:g} s did not converge (angle {angle:g} rad, "
        f"rate {angle_rate:g} rad/s, acceleration {abs(a0):g} m/s^2): use smaller "
        "communication steps"
    )


def converged(change: float, last_change: float, angle: float) -> bool:
    """Whether the next iteration of a substep would change no more than rounding.

    A linear iteration changes next by change^2/last_change.

    Args:
        change, last_change: of angle and rate * step by this iteration and the one before [rad];
            1.0 at the first one, which gains so fast that a change of 1e-7 is enough.
    """
    return change * change <= SUBSTEP_CONVERGED * (1.0 + abs(angle)) * min(last_change, 1.0)


def substeps(
    weights: Weights,
    speeds: Sequence[float],
    signal: Sequence[complex],
    angular_acceleration: float,
    step: float,
) -> int:
    """Substeps of a step, so that no weight moves more than `TURN_PER_SUBSTEP` in one.

    Arguments as `advance`.

    Raises:
        ArithmeticError: there would be `MAX_SUBSTEPS` or more.
    """
    # value and slope only: corrector passes change the rest, and must not change the substeps
    strongest = abs(signal[0]) + step * abs(signal[1])
    # a run-up leaves free weights behind: they gain w' * step, or what the drag lets them
    drag = weights.damping_rate
    gained = abs(weights.spin_share * angular_acceleration)
    gained *= step if drag * step < 1.0 else 1.0 / drag
    fastest = max(map(abs, speeds)) + math.sqrt(-strongest * weights.lever) + gained
    turns = step * fastest / TURN_PER_SUBSTEP
    if not turns < MAX_SUBSTEPS:
        raise ArithmeticError(
            f"the weights would need {turns:.3g} substeps in {step:g} s: acceleration "
            f"{strongest:g} m/s^2, rate {max(map(abs, speeds)):g} rad/s: use smaller "
            "communication steps"
        )
    return 1 + int(turns)


def advance(
    weights: Weights,
    angles: Sequence[float],
    speeds: Sequence[float],
    signal: Sequence[complex],
    angular_acceleration: float,
    step: float,
) -> tuple[list[float], list[float]]:
    """Move every weight over one communication step.

    Args:
        angles, speeds: (N,) angles in the rotor [rad] and their rates [rad/s].
        signal: acceleration of the track's centre in the rotor frame at the start of the step and
            its derivatives of order 1 to 3 [m/s^2, m/s^3, ...].
        angular_acceleration: of the rotor, w' [rad/s^2].
        step: length of the step [s].

    Returns:
        Angles and rates at the end of the step.

    Raises:
        ArithmeticError: the input is not finite, or asks for more than a million substeps.
    """
    if not math.isfinite(sum(angles)):
        raise ArithmeticError(f"the weights' angles {list(angles)} are not finite")
    if max(map(abs, angles)) > FAR_ANGLE:
        # the iteration's end is judged by the angle: turns behind a weight must not loosen it
        behind = [2.0 * math.pi * round(angle / (2.0 * math.pi)) for angle in angles]
        near = [angle - turned for angle, turned in zip(angles, behind, strict=True)]
        moved, end_rates = advance(weights, near, speeds, signal, angular_acceleration, step)
        return [angle + turned for angle, turned in zip(moved, behind, strict=True)], end_rates
    count = substeps(weights, speeds, signal, angular_acceleration, step)
    h = step / count
    lever, damping_rate = weights.lever, weights.damping_rate
    lag = weights.spin_share * angular_acceleration
    new_angles, new_speeds = list(angles), list(speeds)
    start = signal[0], signal[1]
    for j in range(1, count + 1):
        end = at(signal, j * h)
        for k in range(len(new_angles)):
            new_angles[k], new_speeds[k] = substep(
                new_angles[k], new_speeds[k], (*start, *end), lever, lag, damping_rate, h
            )
        start = end
    return new_angles, new_speeds


def reaction(
    weights: Weights,
    angles: Sequence[float],
    speeds: Sequence[float],
    acceleration: complex,
    slope: complex,
    rotor_speed: float,
    angular_acceleration: float,
) -> tuple[complex, complex]:
    """Residual force on the rotor in the rotor frame and its exact slope, -(d/dt)^2 of the moment.

    The weights' added mass N m is not in it; Filimonikhina 2017 (4) has both in one.

    Args:
        angles, speeds: (N,) [rad, rad/s].
        acceleration, slope: of the track's centre in the rotor frame [m/s^2, m/s^3].
        rotor_speed, angular_acceleration: w and w' [rad/s, rad/s^2].

    Returns:
        F [N] and dF/dt [N/s], xi + i eta.
    """
    lever, damping_rate = weights.lever, weights.damping_rate
    lag = weights.spin_share * angular_acceleration
    acceleration *= lever
    slope *= lever
    moment = first = second = third = 0j
    for angle, nu in zip(angles, speeds, strict=True):
        unit = rect(1.0, angle)
        back = unit.conjugate()
        along = acceleration * back
        theta_2 = along.imag - lag - damping_rate * nu
        torque_slope = (slope * back).imag - along.real * nu
        squared = nu * nu
        moment += unit
        first += complex(0.0, nu) * unit
        second += complex(-squared, theta_2) * unit
        theta_3 = torque_slope - damping_rate * theta_2
        third += complex(-3.0 * nu * theta_2, theta_3 - nu * squared) * unit
    turn = 2j * rotor_speed
    pull = 1j * angular_acceleration - rotor_speed * rotor_speed
    force = second + turn * first + pull * moment
    force_slope = (
        third
        + turn * second
        + (2j * angular_acceleration + pull) * first
        - 2.0 * rotor_speed * angular_acceleration * moment
    )
    scale = -weights.moment
    return scale * force, scale * force_slope
