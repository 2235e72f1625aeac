"""Impulses of collisions, given to the rotor as pulses of a signal known only at points.

A signal is a cubic Hermite between communication points; `pulse` added to its value at one point is
a hat over the two steps beside it.  An impulse from within a step is owed at that step's end and
given by the hat about the next point: late by one to two steps (order 1), but what is given in one
step does not depend on what happens in it, so that corrector passes see the same pulse.  What a hat
of unequal steps gives too much or too little stays owed: linear momentum is kept exactly.
"""

from __future__ import annotations

import cmath

# Gauss-Legendre on 0..1, exact to degree 9
_NODES = (0.046910077030668, 0.230765344947158, 0.5, 0.769234655052842, 0.953089922969332)
_SHARES = (0.118463442528095, 0.239314335249683, 0.284444444444444, 0.239314335249683,
           0.118463442528095)  # fmt: skip


def hat_half(turn: float) -> complex:
    """Integral of a hat's rising half over one step of length 1, in axes of the step's end.

    Args:
        turn: angle by which the rotor turns in the step [rad]; the pulse turns with it.
    """
    return sum(
        share * s * s * (3.0 - 2.0 * s) * cmath.rect(1.0, turn * (s - 1.0))
        for s, share in zip(_NODES, _SHARES, strict=True)
    )


def discharge(
    owed: complex, pulse: complex, impulse: complex, turn: float, step: float
) -> tuple[complex, complex]:
    """What is owed after a step, and the pulse at its end.

    Args:
        owed: impulse not yet given at the start of the step, rotor frame [N s].
        pulse: force added to the signal at the start of the step [N].
        impulse: of the collisions in the step, in the rotor frame at its end [N s].
        turn, step: of the rotor in the step, and its length [rad, s].

    Returns:
        (owed, pulse) for the end of the step, in the rotor frame there.
    """
    if not (owed or pulse):
        return impulse, 0j
    half = hat_half(turn)
    left = (owed - pulse * step * half.conjugate()) * cmath.rect(1.0, -turn)
    given = left / (2.0 * step * half.real)
    if abs(left) < 1e-14 * abs(owed):
        left = given = 0j  # equal steps leave rounding only
    return left - given * step * half + impulse, given
