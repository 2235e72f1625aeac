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
from .linear.floquet import exponents, fast_growth, one_turn_multipliers
from .linear.linearised import Linearised, linearise


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
        growth = np.maximum(growth, fast_growth(systems, which, speeds))
    decay = np.array([-s.free_decay.min(initial=math.inf) for s in systems])
    return np.maximum(growth, decay[which])


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
    return active_growth([linearise(assembly)], np.zeros(len(w), int), w)


def growth_map(assemblies: Sequence[Assembly], speeds: ArrayLike) -> NDArray[np.float64]:
    """Largest growth rate [1/s] of every assembly at every speed, (len(assemblies), len(speeds)).

    NaN where the weights of an assembly cannot undo its unbalance: it has no main motion.
    """
    w = _speeds(speeds)
    result = np.full((len(assemblies), len(w)), math.nan)
    groups: dict[tuple[int, bool], list[tuple[int, Linearised]]] = {}
    for i, assembly in enumerate(assemblies):
        try:
            system = linearise(assembly)
        except CannotBalance:
            continue
        groups.setdefault((system.size, system.constant), []).append((i, system))
    for members in groups.values():
        rows = np.array([i for i, _ in members])
        systems = [system for _, system in members]
        which = np.repeat(np.arange(len(systems)), len(w))
        growth = active_growth(systems, which, np.tile(w, len(systems)))
        result[rows] = growth.reshape(len(systems), len(w))
    return result
