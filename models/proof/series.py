"""Matrix series sum x^p e^{2 i k beta} X[p, k] in floating point, with a bound of every error.

x^p are the monomials of s, e_1, e_2, ... by their degrees.

A computed sum of n products errs by at most n u/(1 - n u) times the sum of their moduli, whatever
the order of summation (Higham 2002, section 3.1; Rump 2010, section 2): BLAS computes the series,
and once more with the moduli the bound.
"""

from __future__ import annotations

import functools
import itertools
import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Complex = NDArray[np.complex128]
Array = NDArray[np.float64]

_UNIT = 2.0**-53
_TINY = 1e-290  # above what underflow takes from a sum
UP = 1.0 + 2.0**-30  # of a bound: covers the rounding of fewer than 2^20 sums and products of it


@dataclass(frozen=True, eq=False)
class Series:
    """Matrices (P, K, d, e): monomials to a degree, harmonics -(K-1)/2 to (K-1)/2.

    Attributes:
        mid: approximate.
        rad: bound of the modulus of the error.
        variables: number of s, e_1, ...
    """

    mid: Complex
    rad: Array
    variables: int = 1

    @classmethod
    def exact(cls, mid: Complex, variables: int = 1) -> Series:
        """A series of floating-point numbers as they are."""
        return cls(mid, np.zeros(mid.shape), variables)

    @classmethod
    def number(cls, value: float) -> Series:
        """A floating-point number."""
        return cls.exact(np.array(value, complex))

    @property
    def size(self) -> Array:
        """Upper bounds of the moduli."""
        return (np.abs(self.mid) + self.rad) * UP

    def __add__(self, other: Series) -> Series:
        """The sum of two of one shape."""
        mid = self.mid + other.mid
        rad = (self.rad + other.rad + 2.0 * _UNIT * np.abs(mid)) * UP
        return Series(mid, rad, self.variables)

    def __mul__(self, other: Series) -> Series:
        """The product entry by entry."""
        a, b = self.size, other.size
        error = a * other.rad + self.rad * b + 8.0 * _UNIT * a * b
        return Series(self.mid * other.mid, (error + _TINY) * UP)

    def __matmul__(self, other: Series) -> Series:
        """The product."""
        terms = min(len(self.mid), len(other.mid)) * self.mid.shape[3]
        terms *= min(self.mid.shape[1], other.mid.shape[1])
        share = 3.0 * (terms + 2) * _UNIT
        size, n = np.abs(other.mid), self.variables
        error = convolved(np.abs(self.mid), share * size + other.rad, n)
        if self.rad.any():
            error = error + convolved(self.rad, size + other.rad, n)
        touched = _table(self.mid, other.mid, n)[np.ix_(_filled(self.size), _filled(other.size))]
        error[touched.ravel()] += _TINY
        return Series(convolved(self.mid, other.mid, n), error * UP, n)

    def widened(self, powers: int, harmonics: int) -> Series:
        """The same with zeros beyond its monomials and harmonics."""
        mid, rad = (widened(x, powers, harmonics) for x in (self.mid, self.rad))
        return Series(mid, rad, self.variables)


@functools.cache
def monomials(variables: int, degree: int) -> list[tuple[int, ...]]:
    """Exponents of s, e_1, ... to a degree, the lower degrees first."""
    chosen = itertools.combinations_with_replacement
    every = (each for d in range(degree + 1) for each in chosen(range(variables), d))
    return [tuple(each.count(k) for k in range(variables)) for each in every]


def count(variables: int, degree: int) -> int:
    """Number of monomials to a degree."""
    return math.comb(variables + degree, degree)


def degree_of(monomials_: int, variables: int) -> int:
    """The degree that so many monomials have."""
    return next(d for d in itertools.count() if count(variables, d) >= monomials_)


@functools.cache
def products(variables: int, left: int, right: int) -> NDArray[np.int64]:
    """Numbers of the products of monomials to two degrees, (P, Q)."""
    numbers = {m: k for k, m in enumerate(monomials(variables, left + right))}
    pairs = [
        [numbers[tuple(a + b for a, b in zip(m, n, strict=True))]
         for n in monomials(variables, right)]
        for m in monomials(variables, left)
    ]  # fmt: skip
    return np.array(pairs)


def widened(x: NDArray, powers: int, harmonics: int) -> NDArray:
    """The same series with zeros beyond, or without what is beyond."""
    out = np.zeros((powers, harmonics, *x.shape[2:]), x.dtype)
    most = min(powers, len(x))
    side = (harmonics - x.shape[1]) // 2
    if side >= 0:
        out[:most, side : side + x.shape[1]] = x[:most]
    else:
        out[:most] = x[:most, -side : x.shape[1] + side]
    return out


def _filled(x: NDArray) -> NDArray[np.int64]:
    """Numbers of the monomials that are there."""
    return np.flatnonzero(x.any(axis=(1, 2, 3)))


def _table(a: NDArray, b: NDArray, variables: int) -> NDArray[np.int64]:
    """Numbers of the products of monomials (P, Q)."""
    if 1 in (len(a), len(b)):
        return np.arange(len(a) * len(b)).reshape(len(a), len(b))
    return products(variables, *(degree_of(len(x), variables) for x in (a, b)))


def convolved(a: NDArray, b: NDArray, variables: int = 1) -> NDArray:
    """The product of two series, (P, K + L - 1, d, f)."""
    (_, k, d, _), (_, m, _, f) = a.shape, b.shape
    table = _table(a, b, variables)
    out = np.zeros((int(table[-1, -1]) + 1, k + m - 1, d, f), np.result_type(a, b))
    rows, columns = _filled(a), _filled(b)
    a, b, table = a[rows], b[columns], table[np.ix_(rows, columns)]
    left, right = (np.argwhere(x.any(axis=(2, 3))) for x in (a, b))
    if len(left) <= len(right):
        for i, j in left:
            out[table[i], j : j + m] += a[i, j] @ b
    else:
        for i, j in right:
            out[table[:, i], j : j + k] += a @ b[i, j]
    return out
