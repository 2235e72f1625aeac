"""A step of the compensated scheme as linear maps.

All that such a step computes is linear in what it knows.  The formulas are applied to the columns
of an identity once for every length of a step; then a step costs three products.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from ..signals import end_of, extrapolated, hermite, leading_to, matrix_of

# derivatives 3 to 5, in powers of the step, at the start of a step of the quintic that ends with
# given value, slope and second derivative, begins with no value and no second derivative, and had
# no second derivative a step before
_BENDING = np.array([[-7.5, 7.5, -27.0 / 16.0], [0.0, 0.0, 1.0], [45.0, -45.0, 105.0 / 8.0]])
_FACTORIALS = np.cumprod([1.0, 1.0, 2.0, 3.0, 4.0, 5.0])
# exact to degree 23, so for turns of radians
_POINTS, _SHARES = np.polynomial.legendre.leggauss(12)
_NODES, _SHARES = 0.5 + 0.5 * _POINTS, 0.5 * _SHARES


class CompensatedMaps:
    """Maps of a step from what is known to what the units are told and what is found.

    Known are, as reals, `kept_of` numbers of every force, then of every acceleration, and as the
    units give them accelerations and forces with their `parts`: value, slope, of quintics second
    derivative.  Kept are the parts now, the higher derivatives of what is to be continued at the
    start of the step before, the parts that it missed, each times its power of the step, and how
    far the signal ended from where the cubic or quintic before had led.

    Continued is a cubic through both ends of the step before.  The quintic through both ends would
    multiply an error 121-fold, and so ask for a Jacobian that is right to 1/121 over the loop gain
    while weights move; the one that leaves out the slope before and takes the second derivative two
    steps before multiplies it 7.6-fold, a cubic 13-fold.  Until there are two steps of one length
    it is the first one.

    Args:
        parts: of a signal's end: 2 of cubics, 3 of quintics.
        planes: on which each exchange is.
        solution: what signals missed, per gap between forces answered and assumed.
        past, step: lengths of the step before (0: none) and of this one [s].
        jump: whether the step is negligible.

    Attributes:
        pushed, told: maps to what the rotor and the balancers are told.
        found: map to what is kept next, the forces answered, and by how much they differ from those
            assumed.
    """

    def __init__(
        self,
        parts: int,
        planes: Sequence[int],
        solution: np.ndarray,
        past: float,
        step: float,
        jump: bool = False,
    ) -> None:
        forces, every, keeps = len(planes), len(solution) // (2 * parts), kept_of(parts)
        known = _identity((keeps + parts) * every)
        bounds = [keeps * every, (keeps + parts) * every - parts * forces]
        kept, felt, answers = np.split(known, bounds, 1)
        kept, answers = _parted(kept, every, keeps), _parted(answers, forces, parts)
        felt = _parted(felt, parts, every - forces).swapaxes(0, 2)
        now, missed = kept[:parts], kept[2 * parts : 3 * parts]

        self._parts, self._planes, self._past, self._step = parts, planes, past, step
        self._angle = np.nan
        size, order = 2 * parts, 2 * parts - 1
        predicting = matrix_of(lambda *c: extrapolated(c[:parts], c, past, order), size).T
        ending = matrix_of(lambda *cubic: end_of(cubic, step), size).T
        joining = matrix_of(lambda *ends: hermite(ends[:parts], ends[parts:], step), size).T
        predicted = _combined(predicting, kept[: 2 * parts])
        self._assumed = predicted[..., :forces]
        self._missed = missed
        if jump and parts == 3:  # rounding would be all that is left of the quintic's derivatives
            leading = matrix_of(lambda *end: leading_to(end, step), parts).T
            motion = _combined(leading, felt)
        else:
            motion = _combined(joining, np.concatenate([now[..., forces:], felt]))
        motion += self._made_good(0.0, missed[..., forces:])
        self.told = _map(motion[..., planes])

        times = step ** np.arange(parts)[:, None, None]
        led = _combined(ending, predicted)
        ends = led[..., :forces]
        gaps = (answers - ends) * times
        found = _parted((solution @ _map(gaps)).T.copy().view(complex), every, parts)
        right = np.concatenate([ends, felt], axis=2) + found / times
        signals = _combined(joining, np.concatenate([now, right]))
        if parts == 3 and past == step:
            bend = _combined(_BENDING, (right - led) * times) / times / step**3
            signals[3:] = predicted[3:] + bend
        rows = np.concatenate([right, signals[parts:], found, right[:1] - led[:1]])
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
        return _combined(carried(angle, self._past, self._step, self._parts), missed)


def kept_of(parts: int) -> int:
    """How many numbers are kept of a signal whose ends have so many parts."""
    return 3 * parts + 1


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
def carried(turn: float, past: float, step: float, parts: int = 2) -> np.ndarray:
    """Cubic, or quintic, over a step that gives a free mass what it missed in the step before.

    Missed was the one that starts from nothing and ends with value and slope (and second
    derivative); the one found ends in nothing.  Both leave the mass with the same velocity in the
    same place, and of quintics the integral of the place is the same.

    Args:
        turn: of the signals' axes in the past step [rad].
        past, step: lengths of the past step and of this one [s].
        parts: of a signal's end.

    Returns:
        (2 parts, parts): value and derivatives at the start of the step, per missed value, missed
        slope times `past`, and missed second derivative times its square.
    """
    ratio, moments = step / past, np.arange(parts)[:, None]
    nothing = (0.0,) * parts
    rising = matrix_of(lambda *end: hermite(nothing, end, 1.0), parts)
    falling = matrix_of(lambda *start: hermite(start, nothing, 1.0), parts)
    powers = _NODES ** np.arange(2 * parts)[:, None] / _FACTORIALS[: 2 * parts, None]
    # impulse and its moments about the end of this step, in axes of the start of the past one
    before = _SHARES * np.exp(1j * turn * _NODES) * (1.0 - _NODES + ratio) ** moments
    after = _SHARES * ratio * np.exp(1j * turn * (1.0 + ratio * _NODES))
    after = after * (ratio * (1.0 - _NODES)) ** moments
    missed, given = before @ (rising @ powers).T, after @ (falling @ powers).T
    orders = falling.T @ np.linalg.solve(given, missed)
    return orders / step ** np.arange(2 * parts)[:, None]
