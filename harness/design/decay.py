"""How fast the end of a run decays: fitted, against Goncharov's slow root and the exact spectrum.

The slow root is compared where it is dominant, which is decided by the spectrum alone, before
anything is fitted: at the position where the run ended (weights that touch counted as one) the
slowest eigenvalue of units and rotor together is real, all others are `APART` times faster, and
the same weights touch from the first reading of the window to the last.  The window is linear: from
residuals below `WINDOW[1]` down to `WINDOW[0]` of the scale.  The fit begins once all other motions
have had the time to fall a hundredfold against the slowest one.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...models.assembly import Assembly
from ...models.linear.balanced import CannotBalance
from ...models.linear.floquet import exponents
from ...models.linear.linearised import linearise
from ...models.papers.settling import critical_drag_factor, slow_root
from ...models.papers.touching import Packed, joint_alignment, merged, packed_groups
from ...models.weights import Weights

WINDOW = (1e-6, 1e-3)  # of the scale: residuals of the linear end of a run
APART = 2.0  # the slow root is dominant where everything else is this many times faster
ALONE = 100.0  # fall of everything else against it before the fit begins
FEWEST = 8  # readings in a fit
_REAL = 1e-6  # of a root's modulus: a smaller imaginary part is rounding

UNSETTLED = "not yet at rest"
CONTACT = "contacts change"
SWINGS = "slowest motion swings"
ALIKE = "others nearly as slow"
SHORT = "too few readings"


@dataclass(frozen=True)
class Decay:
    """The linear end of one run.

    Attributes:
        root: Goncharov's (1) at the end's position, touching weights as one [1/s]; real part.
        exact: slowest eigenvalue there [1/s]; real part.
        fitted: rate of the residual [1/s]; NaN where the slow root is not dominant.
        excluded: why it is not; empty where it is.
        touching: some weights touch at the end.
    """

    root: float
    exact: float
    fitted: float
    excluded: str
    touching: bool

    @property
    def dominant(self) -> bool:
        """Whether the slow root was compared."""
        return not self.excluded


def decay(
    assembly: Assembly,
    speed: float,
    alpha: float,
    times: np.ndarray,
    residuals: np.ndarray,
    angles: Sequence[Sequence[float]],
) -> Decay:
    """What the end of a run says of its slow root.

    Args:
        assembly: planar isotropic rotor with one set of weights, at any angles.
        speed: of the rotor [rad/s].
        alpha: half the angle between weights that touch [rad].
        times, residuals: (k,) readings [s] and residual unbalance over the scale.
        angles: (k,) lists of the weights' angles [rad].
    """
    begin = below(residuals, WINDOW[1])
    groups = packed_groups(angles[-1], alpha)
    touching = len(groups) < len(angles[-1])
    root, slowest, following = spectrum(assembly, speed, alpha, groups)

    def without(why: str) -> Decay:
        return Decay(root.real, slowest.real, math.nan, why, touching)

    if residuals[-1] > WINDOW[0] or begin >= len(times):
        return without(UNSETTLED)
    if [g.size for g in packed_groups(angles[begin], alpha)] != [g.size for g in groups]:
        return without(CONTACT)
    if not slowest.real < 0.0 or abs(slowest.imag) > _REAL * abs(slowest):
        return without(SWINGS)
    if following > APART * slowest.real:
        return without(ALIKE)
    wait = math.log(ALONE) / (slowest.real - following)
    chosen = np.flatnonzero((times >= times[begin] + wait) & (residuals > WINDOW[0]))
    if len(chosen) < FEWEST:
        return without(SHORT)
    fitted = float(np.polyfit(times[chosen], np.log(residuals[chosen]), 1)[0])
    return Decay(root.real, slowest.real, fitted, "", touching)


def spectrum(
    assembly: Assembly, speed: float, alpha: float, groups: Sequence[Packed]
) -> tuple[complex, complex, float]:
    """Slow root (1), slowest exact eigenvalue, and real part of the next one [1/s].

    A pair of conjugates counts once.  NaN where no balanced position is near.
    """
    rotor = assembly.loaded_rotor
    weights = assembly.weights[0].device
    assert isinstance(weights, Weights)
    number, joint = joint_alignment(groups, alpha)
    root = slow_root(weights, joint, critical_drag_factor(rotor, speed, weights.kappa), number)
    try:
        system = linearise(merged(assembly, alpha, groups))
    except CannotBalance:
        return root, complex(math.nan), math.nan
    values = exponents([system], np.zeros(1, int), np.array([speed]))[0]
    values = values[np.argsort(-values.real, kind="stable")]
    slowest = complex(values[0])
    swings = abs(slowest.imag) > _REAL * abs(slowest)
    return root, slowest, float(values[1 + swings].real)


def below(residuals: np.ndarray, limit: float) -> int:
    """First reading from which on no residual is above the limit; their number if the last is."""
    above = np.flatnonzero(residuals > limit)
    return int(above[-1]) + 1 if above.size else 0
