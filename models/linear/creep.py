"""Weights that creep along their race in a rotor that turns, as under a heavy drag."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..arrays import Array
from ..assembly import weights_of

if TYPE_CHECKING:
    from .on_race import OnRace

LONGEST_TURN = 0.3  # rad of an iteration of Newton's method
_RANK = 1e-9  # turns that change moments by a smaller share of the most do not
_MOST_EVALUATIONS = 3_000  # of where weights creep freely
_MOST_CREEPS = 200  # steps of weights that creep; those that come to rest do in about 50
# rad of one; where weights creep without end, longer ones still find a rest that would hold them
_LONGEST_CREEPS = 0.1, 0.3
_STILL = 1e-9  # rad of Newton's method, and of the largest slope: rates of weights at rest
_CREEP_TIMES, _LEAST_SLOPE = 60.0, 1e-7  # time constants, of the largest lobe over the radius


class NoRest(ArithmeticError):
    """No motion was found in which weights rest on their races and the rotor turns."""


def creep_freely(machine: OnRace, angles: Array) -> Array:
    """Where weights creep to freely, as under a heavy drag (K,) [rad].

    Raises:
        NoRest: they creep without end.
    """
    devices = [weights_of(m) for m in machine.assembly.weights]
    size = machine.sizes
    steep = [o.order**2 * o.amplitude / d.track_radius for d in devices for o in d.race]
    length = _CREEP_TIMES / max([_LEAST_SLOPE, *(s for s in steep if s > 0.0)])

    from scipy.integrate import solve_ivp  # a run that shows nothing but words does without

    left = iter(range(_MOST_EVALUATIONS))

    def rate(_t: float, theta: Array) -> Array:
        if next(left, None) is None:
            raise NoRest(f"weights creep without end on their race at {machine.speed:g} rad/s")
        pulled: Array = machine.missing(theta) / size**2
        return pulled

    solved = solve_ivp(rate, (0.0, length), angles, "LSODA", rtol=1e-6, atol=1e-9)
    found: Array = solved.y[:, -1]
    return found if np.isfinite(found).all() else angles.copy()


def creep_balanced(machine: OnRace, angles: Array) -> Array:
    """Where weights creep to by turns that leave the rotor nearly at rest (K,) [rad].

    Turns that change moments follow Newton's method, x = -S^-1 (s + B y); the others creep at
    the rate g of what is missing.  Implicit steps of Euler's method solve both: short ones as
    long as weights go far, long ones near the rest, where they become Newton's; never so long
    that one could pass from a rest that is left to its neighbour.

    Raises:
        NoRest: they do not come to rest.
    """
    plane, mass, *_ = machine.columns
    pulls = (mass[:, None] * machine.assembly.loaded_rotor.planes[plane]).T
    for longest in _LONGEST_CREEPS:
        found = _in_steps(machine, angles, pulls, longest)
        if found is not None:
            return found
    raise NoRest(f"weights creep without end on their race at {machine.speed:g} rad/s")


def _in_steps(machine: OnRace, angles: Array, pulls: Array, longest: float) -> Array | None:
    """Where steps of at most so many rad lead; None where they do not come to rest.

    Args:
        pulls: (n, K) of each weight on the moments of the stations [kg].
    """
    theta, least = angles.copy(), 1.0
    try:
        for _ in range(_MOST_CREEPS):
            moments = pulls * machine.places(theta).along
            _, values, rows = np.linalg.svd(np.vstack([moments.real, moments.imag]))
            rank = int((values > _RANK * values[0]).sum())
            seen, unseen = rows[:rank], rows[rank:]
            left = machine.missing(theta) / machine.sizes**2
            slopes = machine.slopes(theta) / machine.sizes[:, None] ** 2
            own, across = seen @ slopes @ seen.T, seen @ slopes @ unseen.T
            newton, answer = np.hsplit(
                -np.linalg.solve(own, np.column_stack([seen @ left, across])), [1]
            )
            pull = unseen @ (left + slopes @ seen.T @ newton[:, 0])
            slope = unseen @ slopes @ (unseen.T + seen.T @ answer)
            growth = float(np.linalg.eigvals(slope).real.max(initial=-np.inf))
            least_pull = _STILL * np.abs(slope).max(initial=0.0)
            still = np.abs(newton[:, 0]).max(initial=0.0) <= _STILL
            if still and growth < 0.0 and np.abs(pull).max(initial=0.0) <= least_pull:
                return theta
            rate = max(least, 2.0 * growth)
            while True:
                crept = np.linalg.solve(rate * np.eye(len(pull)) - slope, pull)
                if not np.abs(crept).max(initial=0.0) > longest:
                    break
                rate *= 2.0
            turn = unseen.T @ crept + seen.T @ (newton[:, 0] + answer @ crept)
            theta = theta + turn * min(1.0, LONGEST_TURN / max(np.abs(turn).max(), 1e-300))
            least = 0.5 * rate
    except np.linalg.LinAlgError:
        return None
    return None
