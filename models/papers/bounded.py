"""Complex masses of bounded size that leave the least: second-order cones by a barrier method.

All readings must lie within a common bound t, every mass within its own (Lobo, Vandenberghe, Boyd &
Lebret 1998).  The logarithm of what is left of each bound is a self-concordant barrier: Newton's
method reaches the least t from any start, however much the planes are alike (Boyd & Vandenberghe
2004, chapter 11).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Complex

_GAP = 1e-10  # of the largest reading: by so much the least bound may be missed
_SHARPER = 20.0  # times from one centre to the next
_MOST_STEPS, _CENTRED = 200, 1e-3  # of Newton's method to a centre; its squared decrement
_PROMISED = 0.1  # of the fall that the slope promises: a step gives so much
_SHORTEST = 1e-10  # share of a step below which rounding is all that is left


@dataclass(frozen=True, eq=False)
class _Cones:
    """|rows v + offset| < bound for k cones, v the unknowns with t as the last.

    Attributes:
        rows, offset: (k, j, n) and (k, j).
        bound: (k,); NaN: t.
    """

    rows: Array
    offset: Array
    bound: Array

    def left(self, v: Array) -> tuple[Array, Array]:
        """What is left of the squares (k,), negative beyond a bound, and rows v + offset (k, j)."""
        bound = np.where(np.isnan(self.bound), v[-1], self.bound)
        inside = self.rows @ v + self.offset
        size = np.linalg.norm(inside, axis=1)
        return (bound - size) * (bound + size), inside

    def barrier(self, v: Array) -> float:
        """Minus the logarithms; infinite beyond a bound."""
        left, _ = self.left(v)
        return float(-np.log(left).sum()) if left.min() > 0.0 < v[-1] else np.inf

    def derivatives(self, v: Array) -> tuple[Array, Array]:
        """Slopes (n,) and curvatures (n, n) of the barrier."""
        left, inside = self.left(v)
        moves = np.isnan(self.bound)
        fall = np.einsum("kj,kjn->kn", inside, self.rows)
        fall[moves, -1] -= v[-1]
        fall *= 2.0 / left[:, None]
        curved = fall.T @ fall
        scaled = self.rows * np.sqrt(2.0 / left)[:, None, None]
        curved += np.einsum("kjn,kjm->nm", scaled, scaled)
        curved[-1, -1] -= (2.0 / left[moves]).sum()
        return fall.sum(axis=0), curved


def least_bounded(
    coefficients: Complex, response: Complex, largest: Array, min_max: bool
) -> Complex:
    """w (p,) with |w| < `largest` and the least sum of |A + K w|^2, or the least maximum.

    Args:
        coefficients: K (s, p), of rank p.
        response: A (s,).
        largest: (p,) bounds, above 0; infinite: none.
        min_max: the largest |A + K w| is to be least.

    Raises:
        ArithmeticError: none was found.
    """
    size = float(np.abs(response).max()) or 1.0
    scale = np.minimum(largest, size / np.linalg.norm(coefficients, axis=0))
    cones, masses = _cones(coefficients * scale / size, response / size, largest / scale, min_max)
    v = np.zeros(2 * len(scale) + 1)
    v[-1] = 2.0 * float(np.linalg.norm(cones[0].offset, axis=1).max()) + 1.0
    barriers = 2.0 * sum(len(one.bound) for one in cones)
    sharp = 1.0
    while barriers > _GAP * sharp:
        sharp *= _SHARPER
        v = _centre(v, sharp, cones)
    return (v[:masses] + 1j * v[masses : 2 * masses]) * scale


def _cones(k: Complex, a: Complex, bound: Array, min_max: bool) -> tuple[list[_Cones], int]:
    """Those of the readings and of the masses, and how many masses there are."""
    (readings, masses), zero = k.shape, np.zeros((len(a), 1))
    real, imaginary = np.hstack([k.real, -k.imag, zero]), np.hstack([k.imag, k.real, zero])
    rows: Array = np.stack([real, imaginary], axis=1)
    offset: Array = np.stack([a.real, a.imag], axis=1)
    if not min_max:  # one cone of the whole
        rows, offset = rows.reshape(1, 2 * readings, -1), offset.reshape(1, -1)
    found = [_Cones(rows, offset, np.full(len(rows), np.nan))]
    held = np.flatnonzero(np.isfinite(bound))
    if len(held):
        each = np.eye(2 * masses + 1)
        own = np.stack([each[held], each[masses + held]], axis=1)
        found.append(_Cones(own, np.zeros((len(held), 2)), bound[held]))
    return found, masses


def _centre(v: Array, sharp: float, cones: list[_Cones]) -> Array:
    """Least of sharp t + barrier, from a point within the bounds."""

    def value(at: Array) -> float:
        return sharp * float(at[-1] - v[-1]) + sum(one.barrier(at) for one in cones)

    point = v
    for _ in range(_MOST_STEPS):
        parts = [one.derivatives(point) for one in cones]
        slope, curved = (np.sum([part[k] for part in parts], axis=0) for k in (0, 1))
        slope[-1] += sharp
        ruler = 1.0 / np.sqrt(curved.diagonal())
        step = -ruler * np.linalg.solve(curved * np.outer(ruler, ruler), ruler * slope)
        promised = float(-slope @ step)
        if not promised > _CENTRED:
            return point
        share, here = 1.0, value(point)
        while value(point + share * step) > here - _PROMISED * share * promised:
            share *= 0.5
            if share < _SHORTEST:
                return point
        point = point + share * step
    raise ArithmeticError("no correction was found: the readings or masses differ too much in size")
