"""Matrix series sum s^p e^{2 i k beta} X[p, k] in floating point, with a bound of every error.

A computed sum of n products errs by at most n u/(1 - n u) times the sum of their moduli, whatever
the order of summation (Higham 2002, section 3.1; Rump 2010, section 2): BLAS computes the series,
and once more with the moduli the bound.
"""

from __future__ import annotations

from collections.abc import Sequence
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
    """Matrices (P, K, d, e): powers of s from 0, harmonics -(K-1)/2 to (K-1)/2.

    Attributes:
        mid: approximate.
        rad: bound of the modulus of the error.
    """

    mid: Complex
    rad: Array

    @classmethod
    def exact(cls, mid: Complex) -> Series:
        """A series of floating-point numbers as they are."""
        return cls(mid, np.zeros(mid.shape))

    @classmethod
    def number(cls, value: float) -> Series:
        """A floating-point number."""
        return cls.exact(np.array(value, complex))

    @classmethod
    def stack(cls, orders: Sequence[Series]) -> Series:
        """Of coefficients of s^0, s^1, ..."""
        return cls(np.concatenate([o.mid for o in orders]), np.concatenate([o.rad for o in orders]))

    def order(self, power: int) -> Series:
        """The coefficient of one power."""
        return Series(self.mid[power : power + 1], self.rad[power : power + 1])

    @property
    def size(self) -> Array:
        """Upper bounds of the moduli."""
        return (np.abs(self.mid) + self.rad) * UP

    def __add__(self, other: Series) -> Series:
        """The sum of two of one shape."""
        mid = self.mid + other.mid
        return Series(mid, (self.rad + other.rad + 2.0 * _UNIT * np.abs(mid) + _TINY) * UP)

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
        size = np.abs(other.mid)
        error = convolved(np.abs(self.mid), share * size + other.rad)
        if self.rad.any():
            error = error + convolved(self.rad, size + other.rad)
        return Series(convolved(self.mid, other.mid), (error + _TINY) * UP)

    def widened(self, powers: int, harmonics: int) -> Series:
        """The same with zeros beyond its powers and harmonics."""
        return Series(widened(self.mid, powers, harmonics), widened(self.rad, powers, harmonics))


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


def convolved(a: NDArray, b: NDArray) -> NDArray:
    """The product of two series, (P + Q - 1, K + L - 1, d, f)."""
    (p, k, d, _), (q, m, _, f) = a.shape, b.shape
    out = np.zeros((p + q - 1, k + m - 1, d, f), np.result_type(a, b))
    if p * k <= q * m:
        for i, j in np.argwhere(a.any(axis=(2, 3))):
            out[i : i + q, j : j + m] += a[i, j] @ b
    else:
        for i, j in np.argwhere(b.any(axis=(2, 3))):
            out[i : i + p, j : j + k] += a @ b[i, j]
    return out
