"""All multipliers of one revolution; the product needs the largest growth rate alone."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from autobalancer.harness.stability.revolution import Revolution
from autobalancer.models.assembly import Assembly
from autobalancer.models.linear.floquet import exponents, one_turn_multipliers
from autobalancer.models.linear.linearised import linearise


def units_multipliers(units: Revolution, speed: float, state: NDArray) -> NDArray[np.complex128]:
    """The same by the one-revolution map of coupled units at a state, largest modulus first."""
    values = np.linalg.eigvals(units.monodromy(state, speed)).astype(complex)
    return values[np.argsort(-np.abs(values), kind="stable")]


def multipliers(assembly: Assembly, speeds: ArrayLike) -> NDArray[np.complex128]:
    """Multipliers of one revolution about the main motion; arguments as of `growth_rates`.

    Returns:
        (b, size), size = 4 n + 2 K for n stations and K weights.  The last columns
        are the neutral turns of three and more weights, exactly 1 by structure; before them stand
        the free decays e^{-d T} of their rates; the columns before these decide.  Motions that turn
        more than about 500 times in a revolution show as 0 (`floquet.MOST_STEPS`): their growth is
        in `growth_rates` only.

    Raises:
        CannotBalance: the weights cannot undo the unbalance.
    """
    w = np.atleast_1d(np.asarray(speeds, float))
    system = linearise(assembly)
    which = np.zeros(len(w), int)
    period = 2.0 * math.pi / w[:, None]
    if system.constant:
        active = np.exp(exponents([system], which, w) * period)
    else:
        active = one_turn_multipliers([system], which, w)
    decays = np.exp(-system.free_decay * period)
    return np.hstack([active, decays, np.ones((len(w), system.neutral))])
