"""Friction dampers with a free stroke: closed forms.

A slider holds with up to its limit Ff behind a contact of stiffness kf, once the body has used up
the free stroke s between both contacts; within the stroke it does nothing.  Washing machines have
such dampers: large motion of a run-up is damped, small motion at spin speed is isolated.
"""

from __future__ import annotations

import math

_LEAST_SWING = 1e-12  # of the first one: a swing that is rounding


def loss_per_cycle(limit: float, stiffness: float, free_stroke: float, amplitude: float) -> float:
    """Energy that a damper takes per cycle of a steady vibration [J]: 4 Ff (X - s/2 - Ff/kf), or 0.

    Args:
        limit, stiffness: Ff and kf [N, N/m].
        free_stroke: s, from one contact to the other [m].
        amplitude: X of the vibration [m].
    """
    return max(0.0, 4.0 * limit * (amplitude - free_stroke / 2.0 - limit / stiffness))


def equivalent_damping(
    limit: float, stiffness: float, free_stroke: float, amplitude: float, frequency: float
) -> float:
    """Viscous damping that takes as much per cycle [N s/m]; `frequency` in rad/s."""
    loss = loss_per_cycle(limit, stiffness, free_stroke, amplitude)
    return loss / (math.pi * frequency * amplitude**2)


def turning_points(
    stiffness: float, limit: float, free_stroke: float, amplitude: float
) -> list[float]:
    """Amplitudes of a body on a spring at which it turns back, with hard contacts [m].

    From A the body swings to B with k (A^2 - B^2)/2 = Ff (A + B - s).  The last swings, of
    A + B <= s, stay: they do not use up the free stroke.

    Args:
        stiffness: of the body's spring [N/m].
        limit, free_stroke: Ff and s [N, m].
        amplitude: of the release from rest [m].
    """
    found = [amplitude]
    while True:
        a = found[-1]
        # k B^2/2 + Ff B - (k A^2/2 - Ff A + Ff s) = 0
        left = stiffness * a * a / 2.0 - limit * (a - free_stroke)
        inside = limit**2 + 2.0 * stiffness * left
        if inside < 0.0:
            return found
        b = (math.sqrt(inside) - limit) / stiffness
        if a + b <= free_stroke or b <= _LEAST_SWING * amplitude:
            # without a free stroke it comes to rest where the friction holds the spring
            return [*found, 0.0] if free_stroke == 0.0 else found
        found.append(b)
