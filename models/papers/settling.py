"""How fast weights settle on a rotor: Goncharov's slow root (1) from the rotor's own matrices.

Light weights move slowly, so the rotor follows their moment s (rotor frame, Filimonikhin 2011
(12)) as at standstill in that frame, D = d/dt + i w -> i w: its plane accelerates by a = -Y s,

    Y = w^4 e^T (K_c - w^2 M + i w C_c)^{-1} e,     e the plane's row of S, M with added masses.

What is left of the reduced system, turned by half the phase of sum e^{2 i psi}, is

    s'' + d s' = (n m/(2 kappa)) (Y s - p conj(Y s)),     d = b/(kappa m),

a real 2 x 2 matrix with eigenvalues mu = Re Y +- sqrt(p^2 |Y|^2 - (Im Y)^2).  Without damping of
the rotor Im Y = 0, and the slower of lambda^2 + d lambda = (n m/(2 kappa)) mu is the paper's

    lambda = -(d - sqrt(d^2 - (1 - p) m n b_cr^2))/2,     b_cr^2 = -2 Re Y/kappa,

for a disc b_cr^2 = 2 w^4/(kappa (M w^2 - k)), which tends to 2 w^2/(kappa M) at high speed.  With
damping (1) is an approximation.
"""

from __future__ import annotations

import cmath
import math

from ..rotor import LinearRotor
from ..weights import Weights
from .influence import influence


def plane_response(rotor: LinearRotor, speed: float) -> complex:
    """Y = -a/s: acceleration of plane 1 by a constant moment on it, rotor frame [1/(kg s^2)].

    Args:
        rotor: isotropic, with the balancers' added masses.
        speed: w [rad/s].

    Raises:
        ValueError: the rotor is anisotropic: a constant moment then shakes it at 2 w too.
    """
    if not rotor.isotropic:
        raise ValueError("the slow root (1) needs equal stiffness and damping in x and y")
    row = rotor.planes[:1]
    return complex(speed**2 * (row @ influence(rotor, speed, row)[0]).item())


def critical_drag_factor(rotor: LinearRotor, speed: float, kappa: float = 1.0) -> float:
    """b_cr of (1), sqrt(-2 Re Y/kappa) [1/(s sqrt(kg))].

    Raises:
        ValueError: the rotor is anisotropic, or the weights are driven to the heavy side
            (Re Y >= 0, as below the critical speed of a disc): the main motion is unstable.
    """
    response = plane_response(rotor, speed)
    if not response.real < 0.0:
        raise ValueError(
            f"speed = {speed!r} rad/s: weights on plane 1 move to the heavy side there, "
            "so that the main motion is unstable and has no b_cr"
        )
    return math.sqrt(-2.0 * response.real / kappa)


def slow_root(
    weights: Weights, alignment: float, critical_factor: float, count: float | None = None
) -> complex:
    """Root lambda (1) [1/s]; complex where the drag is below critical.

    Args:
        weights: n, m and the drag.
        alignment: p of the main motion.
        critical_factor: b_cr, `critical_drag_factor`.
        count: n_g of weights that touch (`touching.joint_alignment`, with its p), instead of n.
    """
    weights.refuse_unequal("the slow root")
    d = weights.damping_rate
    number = weights.count if count is None else count
    stiffness = (1.0 - alignment) * weights.mass * number * critical_factor**2
    root = cmath.sqrt(d * d - stiffness)
    if root.real == 0.0:
        return -0.5 * (d - root)
    return -0.5 * stiffness / (d + root)  # -(d - root)/2 without its cancellation


def settling_time(root: complex, fall: float = 0.01) -> float:
    """Time in which a motion falls to `fall` of its size [s]; infinite if it does not."""
    return math.log(fall) / root.real if root.real < 0.0 else math.inf
