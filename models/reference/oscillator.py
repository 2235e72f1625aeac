"""Closed form of one axis of a planar rotor under unbalance, at any damping, speed and stiffness.

    m z'' + c z' + k z = P e^{i w t},      z(0), z'(0) given

An axis of an anisotropic rotor is the real part with real c and k; an isotropic one with internal
damping is complex with k - i p w for k (Dubovik 2006 (7)).  Everything is written in divided
differences of e^{s t}, so that resonance (i w is a root) and critical damping (both roots equal)
are no special cases.
"""

from __future__ import annotations

import cmath

import numpy as np
from numpy.typing import ArrayLike, NDArray

Motion = NDArray[np.complex128]

_SERIES = 1e-4  # below it 1 + x^2/6 is sinh(x)/x to x^4/120, less than rounding


def roots(mass: float, damping: float, stiffness: complex) -> tuple[complex, complex]:
    """Roots of m s^2 + c s + k, the slower one without cancellation."""
    half = 0.5 * damping / mass
    offset = cmath.sqrt(half * half - stiffness / mass)
    fast = -half - offset if abs(half + offset) >= abs(half - offset) else -half + offset
    return (stiffness / mass / fast if fast else 0j), fast


def _difference(a: complex, b: complex, t: NDArray[np.float64]) -> Motion:
    """(e^{a t} - e^{b t})/(a - b), also where a and b are close."""
    half = 0.5 * (a - b) * t
    near = np.abs(half) < 1.0
    safe = np.where(near, half, 0.0)
    small = np.abs(safe) < _SERIES
    divisor = np.where(small, 1.0, safe)
    ratio = np.where(small, 1.0 + safe**2 / 6.0, np.sinh(safe) / divisor)
    close = t * np.exp(0.5 * (a + b) * t) * ratio
    if a == b:
        return close
    return np.where(near, close, (np.exp(a * t) - np.exp(b * t)) / (a - b))


def forced_motion(
    mass: float,
    damping: float,
    stiffness: complex,
    pull: complex,
    speed: float,
    times: ArrayLike,
    z0: complex = 0j,
    v0: complex = 0j,
) -> Motion:
    """Displacement at `times`, (T,) [m].

    Args:
        mass, damping, stiffness: m [kg], c [N s/m], k [N/m].
        pull: P, for an unbalance U at angle g in the rotor U w^2 e^{i g} [N].
        speed: w [rad/s].
        times: (T,) [s].
        z0, v0: displacement [m] and velocity [m/s] at time 0.
    """
    t = np.asarray(times, float)
    slow, fast = roots(mass, damping, stiffness)
    impulse = _difference(slow, fast, t)
    free = z0 * (np.exp(slow * t) - slow * impulse) + v0 * impulse
    turning = 1j * speed
    near, far = (slow, fast) if abs(turning - slow) < abs(turning - fast) else (fast, slow)
    forced = (_difference(turning, near, t) - impulse) / (turning - far)
    return free + pull / mass * forced
