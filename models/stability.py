"""Linear stability of the main motion of any assembly, over speeds and parameters at once.

Eigenvalues where the coefficients are constant (isotropic rotor, in its frame; rotor without
weights, in the fixed frame), Floquet multipliers elsewhere.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .assembly import Assembly
from .linear.balanced import CannotBalance
from .linear.floquet import (
    constant_matrices,
    exponents,
    fast_growth,
    half_turns,
    one_turn_multipliers,
)
from .linear.growth import Growth, eigenvalues_with_errors, largest
from .linear.linearised import Linearised, linearise
from .linear.on_race import has_lobes, systems_at, systems_at_rest

# growth per revolution below which errors are looked at; collocation errs by 4e-7 at most, and
# eigenvalues of matrices with drag rates far above the speed by more
_SLOW, _SLOW_CONSTANT = 1e-5, 1e-3
_FINER = 2  # times as many steps then; the error of the first ones shrinks by 2^11
_SHRINKS = 100.0  # by at least so much, also where the steps do not yet follow their order


def _speeds(speeds: ArrayLike) -> NDArray[np.float64]:
    array = np.atleast_1d(np.asarray(speeds, float))
    if array.ndim != 1:
        raise ValueError(f"speeds has {array.ndim} dimensions: must be a number or a list")
    if not (np.isfinite(array) & (array > 0.0)).all():
        worst = array[~(np.isfinite(array) & (array > 0.0))][0]
        raise ValueError(f"speed = {worst:g} rad/s: must be a positive finite number")
    return array


def active_growth(
    systems: list[Linearised], which: NDArray, speeds: NDArray
) -> NDArray[np.float64]:
    """Largest growth rate (b,) [1/s] of systems of one size and kind, neutral turns apart."""
    if systems[0].constant:
        growth = exponents(systems, which, speeds).real.max(axis=1, initial=-math.inf)
    else:
        sizes = np.abs(one_turn_multipliers(systems, which, speeds)).max(axis=1)
        growth = np.log(np.maximum(sizes, np.finfo(float).tiny)) * speeds / (2.0 * math.pi)
        growth = np.maximum(growth, fast_growth(systems, which, speeds)[0])
    return np.maximum(growth, _free_decay(systems)[which])


def _free_decay(systems: list[Linearised]) -> NDArray[np.float64]:
    """Growth rates (systems,) [1/s] of the weights' turns that the rotor does not feel."""
    return np.array([-s.free_decay.min(initial=math.inf) for s in systems])


def growth_and_errors(
    systems: list[Linearised], which: NDArray, speeds: NDArray
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """As `active_growth`, and the largest error (b,) [1/s] of each rate.

    The error is rounding, by the condition of the eigenvalues of the balanced matrix; where
    coefficients are periodic also what twice as many steps change.  It is looked for where growth
    is slow: elsewhere it is 0, for the sign of the rate is known.
    """
    growth = active_growth(systems, which, speeds)
    error = np.zeros_like(growth)
    limit = _SLOW_CONSTANT if systems[0].constant else _SLOW
    slow = np.flatnonzero(np.abs(growth) * (2.0 * math.pi) < limit * speeds)
    if len(slow):
        rates = _exponents if systems[0].constant else _followed
        found, error[slow] = rates(systems, which[slow], speeds[slow])
        growth[slow] = np.maximum(found, _free_decay(systems)[which[slow]])
    return growth, error


def _exponents(
    systems: list[Linearised], which: NDArray, speeds: NDArray
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Growth rates and errors (b,) [1/s] of systems with constant coefficients."""
    values, errors = eigenvalues_with_errors(constant_matrices(systems, which, speeds))
    return largest(values.real, errors)


def _followed(
    systems: list[Linearised], which: NDArray, speeds: NDArray
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Growth rates and errors (b,) [1/s] of systems with periodic coefficients."""
    found = []
    for finer in (1, _FINER):
        turns, steps = half_turns(systems, which, speeds, finer)
        values, errors = eigenvalues_with_errors(turns, roundings=float(steps.max(initial=0)))
        sizes = np.maximum(np.abs(values), np.finfo(float).tiny)
        each = (np.log(sizes), np.minimum(errors / sizes, 1.0))
        found.append([part * speeds / math.pi for part in largest(*each)])
    (coarse, _), (growth, rounding) = found
    error = rounding + np.abs(growth - coarse) / _SHRINKS
    fast, unknown = fast_growth(systems, which, speeds)
    return np.maximum(growth, fast), np.maximum(error, unknown)


def find_growth(assembly: Assembly, speed: float) -> Growth:
    """Largest growth rate [1/s] about the main motion at one speed, with its error.

    Args:
        assembly, speed: as of `growth_rates`, which says what is raised.

    >>> find_growth(ab.load("two_balls").assembly(), 6.0).state
    'stable'
    """
    speeds = _speeds(speed)
    growth, error = growth_and_errors(*systems_at(assembly, speeds), speeds)
    return Growth(float(growth[0]), float(error[0]))


def growth_rates(assembly: Assembly, speeds: ArrayLike) -> NDArray[np.float64]:
    """Largest growth rate [1/s] at each speed (b,), neutral turns apart; negative means stable.

    Args:
        assembly: rotor and balancers; the weights' angles are made to balance, see
            `balanced.balanced_angles`.
        speeds: (b,) [rad/s], positive.

    Raises:
        CannotBalance: the weights cannot undo the unbalance.
    """
    w = _speeds(speeds)
    return active_growth(*systems_at(assembly, w), w)


def growth_at_rest(
    assembly: Assembly, speeds: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Largest growth rates and their errors (b,) [1/s]; NaN where weights have no rest on lobes.

    Raises:
        CannotBalance: the weights cannot undo the unbalance.
    """
    systems, which = systems_at_rest(assembly, speeds)
    growth, error, rests = np.full(len(speeds), math.nan), np.zeros(len(speeds)), which >= 0
    if rests.any():
        growth[rests], error[rests] = growth_and_errors(systems, which[rests], speeds[rests])
    return growth, error


def growth_map(assemblies: Sequence[Assembly], speeds: ArrayLike) -> NDArray[np.float64]:
    """Largest growth rate [1/s] of every assembly at every speed, (len(assemblies), len(speeds)).

    NaN where the weights of an assembly cannot undo its unbalance, or have no rest on races with
    lobes: it has no main motion.
    """
    return growth_map_with_errors(assemblies, speeds)[0]


def growth_map_with_errors(
    assemblies: Sequence[Assembly], speeds: ArrayLike
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """As `growth_map`, and the error [1/s] of every rate, see `growth_and_errors`."""
    w = _speeds(speeds)
    shape = len(assemblies), len(w)
    rates, errors = np.full(shape, math.nan), np.zeros(shape)
    groups: dict[tuple[int, int, bool], list[tuple[int, Linearised]]] = {}
    for i, assembly in enumerate(assemblies):
        try:
            if assembly.rotor.varies or has_lobes(assembly):
                rates[i], errors[i] = growth_at_rest(assembly, w)
                continue
            system = linearise(assembly)
        except CannotBalance:
            continue
        groups.setdefault((*system.steady.shape[:2], system.constant), []).append((i, system))
    for members in groups.values():
        rows = np.array([i for i, _ in members])
        systems = [system for _, system in members]
        which = np.repeat(np.arange(len(systems)), len(w))
        growth, error = growth_and_errors(systems, which, np.tile(w, len(systems)))
        rates[rows], errors[rows] = (each.reshape(len(systems), len(w)) for each in (growth, error))
    return rates, errors
