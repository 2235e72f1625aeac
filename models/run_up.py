"""A disc whose speed rises at a constant rate from rest, on equal supports: its closed form.

M z'' + c z' + k z = -U (d/dt)^2 e^{i al t^2/2} is solved by the Faddeeva function W (SciPy's wofz),
with the roots l of M l^2 + c l + k = 0, g = e^{i al t^2/2} and r = sqrt(al/2) e^{-i pi/4}:

    z = (U/M) (T_1 - T_2)/(l_1 - l_2),
    T_j = -i al t g - l_j g + l_j e^{l_j t} - l_j^2 (J_j(t) - e^{l_j t} J_j(0)),
    J_j(t) = g sqrt(pi)/(2 r) W(i (i al t - l_j)/(2 r))
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import minimize_scalar
from scipy.special import wofz

from .arrays import Complex

_SCAN = 4000  # times at which the largest motion is looked for
_BEYOND = 3.0  # times the natural frequency, the highest speed that is looked at


def run_up_motion(
    mass: float,
    stiffness: float,
    damping: float,
    unbalance: float,
    acceleration: float,
    times: ArrayLike,
) -> Complex:
    """z = x + i y of the disc at times from rest [s], in fixed axes [m].

    Args:
        mass, stiffness, damping: [kg, N/m, N s/m]; less than critical damping.
        unbalance: static moment, along x at time 0 [kg m].
        acceleration: of the speed, above 0 [rad/s^2].

    Raises:
        ValueError: the damping is critical or more, or the speed does not rise.
    """
    square = stiffness / mass - (damping / (2.0 * mass)) ** 2
    if not (square > 0.0 and acceleration > 0.0):
        raise ValueError("run-up: needs less than critical damping, and a speed that rises")
    t = np.asarray(times, float)
    root = complex(-damping / (2.0 * mass), math.sqrt(square))
    parts = [_part(each, acceleration, t) for each in (root, root.conjugate())]
    found: Complex = unbalance / mass * (parts[0] - parts[1]) / (root - root.conjugate())
    return found


def _part(root: complex, acceleration: float, t: np.ndarray) -> Complex:
    """T_j."""
    turned = np.exp(0.5j * acceleration * t * t)
    free = np.exp(root * t)
    r = math.sqrt(acceleration / 2.0) * np.exp(-0.25j * math.pi)

    def term(time: np.ndarray, g: Complex) -> Complex:
        argument = 1j * (1j * acceleration * time - root) / (2.0 * r)
        found: Complex = g * math.sqrt(math.pi) / (2.0 * r) * wofz(argument)
        return found

    start = term(np.zeros(1), np.ones(1, complex))[0]
    forced = -1j * acceleration * t * turned - root * turned + root * free
    found: Complex = forced - root**2 * (term(t, turned) - free * start)
    return found


def run_up_peak(
    mass: float, stiffness: float, damping: float, unbalance: float, acceleration: float
) -> tuple[float, float]:
    """Largest distance from the middle [m], and the speed at which it is reached [rad/s].

    Args:
        mass, stiffness, damping, unbalance, acceleration: as of `run_up_motion`, which says what is
            raised.
    """
    natural = math.sqrt(stiffness / mass)
    times = np.linspace(0.0, _BEYOND * natural / acceleration, _SCAN)

    def size(time: float) -> float:
        given = mass, stiffness, damping, unbalance, acceleration
        return float(np.abs(run_up_motion(*given, [time]))[0])

    sizes = np.abs(run_up_motion(mass, stiffness, damping, unbalance, acceleration, times))
    top = int(sizes.argmax())
    near = times[max(0, top - 1)], times[min(_SCAN - 1, top + 1)]
    found = minimize_scalar(
        lambda t: -size(t), bounds=near, method="bounded", options={"xatol": 1e-10 * near[1]}
    )
    return -float(found.fun), acceleration * float(found.x)
