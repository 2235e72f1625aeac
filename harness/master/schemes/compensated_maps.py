"""A step of the compensated scheme as linear maps.

All that such a step computes is linear in what it knows.  The formulas are applied to the columns
of an identity once for every length of a step; then a step costs three products.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np

from ..signals import Knot, end_of, extrapolated, hermite

# exact to degree 23, so for turns of radians
_POINTS, _SHARES = np.polynomial.legendre.leggauss(12)
_NODES, _SHARES = 0.5 + 0.5 * _POINTS, 0.5 * _SHARES
_UNITS = np.eye(4).tolist()
KEPT = 7  # numbers kept of a signal


class StepMaps:
    """Maps of a step from what is known to what the units are told and what is found.

    Known are, as reals, KEPT numbers of every force, then of every acceleration, and as the units
    give them accelerations with slopes and forces with slopes.  Kept are value, slope, second and
    third derivative at the start of the step before, value and slope times step that it missed,
    and how far the signal ended from where the cubic before had led.

    Args:
        planes: on which each exchange is.
        solution: what signals missed, per gap between forces answered and assumed.
        past, step: lengths of the step before (0: none) and of this one [s].

    Attributes:
        pushed, told: maps to what the rotor and the balancers are told.
        found: map to what is kept next, the forces answered, and by how much they differ from those
            assumed.
    """

    def __init__(
        self, planes: Sequence[int], solution: np.ndarray, past: float, step: float
    ) -> None:
        forces, every = len(planes), len(solution) // 4
        known = _identity((KEPT + 2) * every)
        kept, felt, answers = np.split(known, [KEPT * every, (KEPT + 2) * every - 2 * forces], 1)
        kept, answers = _parted(kept, every, KEPT), _parted(answers, forces, 2)
        felt = _parted(felt, 2, every - forces).swapaxes(0, 2)
        now, missed = kept[:2], kept[4:6]

        self._planes, self._past, self._step, self._angle = planes, past, step, np.nan
        predicting = _formula(lambda f, d, d2, d3: extrapolated((f, d), (f, d, d2, d3), past, 3))
        ending = _formula(lambda *cubic: end_of(cubic, step))
        joining = _formula(lambda f, d, g, e: hermite((f, d), (g, e), step))
        predicted = _combined(predicting, kept[:4])
        self._assumed = predicted[..., :forces]
        self._missed = missed
        motion = _combined(joining, np.concatenate([now[..., forces:], felt]))
        motion += self._made_good(0.0, missed[..., forces:])
        self.told = _map(motion[..., planes])

        times = np.array([1.0, step])[:, None, None]
        led = _combined(ending, predicted)
        ends = led[..., :forces]
        gaps = (answers - ends) * times
        found = _parted((solution @ _map(gaps)).T.copy().view(complex), every, 2)
        right = np.concatenate([ends, felt], axis=2) + found / times
        cubic = _combined(joining, np.concatenate([now, right]))
        rows = np.concatenate([right, cubic[2:], found, right[:1] - led[:1]])
        self.found = np.concatenate([_map(rows), _map(answers[:1]), _map(gaps[:1])])

    def turn(self, angle: float) -> None:
        """Take over by how much the signals' axes turned in the step before [rad]."""
        if angle == self._angle:
            return
        forces = len(self._planes)
        cubics = self._assumed + self._made_good(angle, self._missed[..., :forces])
        on_planes = np.zeros((*cubics.shape[:2], self._missed.shape[2] - forces), complex)
        for exchange, plane in enumerate(self._planes):
            on_planes[..., plane] += cubics[..., exchange]
        self.pushed, self._angle = _map(on_planes.swapaxes(0, 2)), angle

    def _made_good(self, angle: float, missed: np.ndarray) -> np.ndarray | float:
        """Cubics that make good what was missed in the past step, `carried` on."""
        if not self._past:
            return 0.0
        return _combined(np.array(carried(angle, self._past, self._step)), missed)


def _formula(formula: Callable[..., Sequence[complex]]) -> np.ndarray:
    """Coefficients of a formula that is linear in four numbers, a column each."""
    return np.array([formula(*unit) for unit in _UNITS]).T


# Below, numbers that are linear in what is known are an array (parts of a signal, known, signals)
# of complex numbers; a real and an imaginary part of what is known are two.


def _combined(coefficients: np.ndarray, parts: np.ndarray) -> np.ndarray:
    """Parts of signals from others."""
    return (coefficients @ parts.reshape(len(parts), -1)).reshape(-1, *parts.shape[1:])


@lru_cache(maxsize=8)
def _identity(count: int) -> np.ndarray:
    """Complex numbers per real and imaginary part of themselves, (2 count, count)."""
    return np.eye(2 * count).view(complex)


def _parted(rows: np.ndarray, outer: int, inner: int) -> np.ndarray:
    """(known, outer inner) as (inner, known, outer)."""
    return rows.reshape(-1, outer, inner).transpose(2, 0, 1)


def _map(parts: np.ndarray) -> np.ndarray:
    """The matrix from what is known to a signal's parts, signal by signal, of `_parted` numbers."""
    rows = np.ascontiguousarray(parts.transpose(1, 2, 0)).reshape(parts.shape[1], -1)
    return rows.view(float).T


@lru_cache(maxsize=64)
def carried(turn: float, past: float, step: float) -> tuple[Knot, ...]:
    """Cubic over a step that gives a free mass what it missed in the step before.

    Missed was the cubic that starts from nothing and ends with a value and a slope; the one found
    ends in nothing, and both leave the mass with the same velocity in the same place.

    Args:
        turn: of the signals' axes in the past step [rad].
        past, step: lengths of the past step and of this one [s].

    Returns:
        (4, 2): value and derivatives of order 1 to 3 at the start of the step, per missed value and
        per missed slope times `past`.
    """
    s = _NODES
    rising = np.array([s * s * (3.0 - 2.0 * s), s * s * (s - 1.0)])
    falling = np.array([1.0 - rising[0], s * (s - 1.0) ** 2])
    ratio = step / past
    # impulse, and its moment about the end of this step, in axes of the start of the past one
    before = _SHARES * np.exp(1j * turn * s)
    after = _SHARES * ratio * np.exp(1j * turn * (1.0 + ratio * s))
    missed = np.array([rising @ before, rising @ (before * (1.0 - s + ratio))])
    given = np.array([falling @ after, falling @ (after * ratio * (1.0 - s))])
    start = np.linalg.solve(given, missed)  # value, and slope times step
    shape = np.array([[1.0, 0.0], [0.0, 1.0], [-6.0, -4.0], [12.0, 6.0]])
    orders = shape @ start / step ** np.arange(4)[:, None]
    return tuple((value, slope) for value, slope in orders.tolist())
