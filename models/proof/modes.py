"""Coordinates in which A(w, beta) is nearly diagonal: approximate, for `certificate` to judge.

x = F y with F a polynomial in s = w - w0 and in the parameters e_j, and in harmonics of 2 beta.
Where all of them are 0 its columns are Floquet modes: eigenvectors of the truncated harmonic
problem (Hill's), refined by Newton's method; higher degrees follow by perturbation.  In
y' = T y, T is diagonal but for blocks of modes too near to each other to be distinguished.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .arrays import Unproved
from .series import Complex, convolved, count, products, widened

DEGREES = (4, 4, 3, 3)  # of F by number of parameters: 4 for a tenth of the speed: some 8 digits
DEGREE = 1  # of F with more parameters
_HILL = 3  # harmonics on either side of the first approximation
_MOST_HARMONICS = 40
_TAIL = 1e-13, 1e-6  # of the modes: harmonics smaller than this may be left out
_ALIKE = 0.5  # of the lesser decay rate: nearer modes stay in one block
_INDEPENDENT = 1e-7  # part of a column outside of the others' span
_CUT = 10.0  # the same by what its first and last harmonics leave out
_NEWTON = 8


@dataclass(frozen=True, eq=False)
class Modes:
    """Approximate modes around a speed.

    Attributes:
        shapes: F (P, K, d, d) by monomials.
        rates: T (P, 1, d, d).
        inverse: of F where s and the parameters are 0, (1, K, d, d).
    """

    shapes: Complex
    rates: Complex
    inverse: Complex


def modes(a: Complex, speed: float, variables: int, degree: int) -> Modes:
    """Modes of a system.

    Args:
        a: A (P, 3, d, d) by monomials and harmonics -1, 0, 1; (P, 1, d, d) if constant.
        speed: w0 [rad/s].
        variables, degree: of the polynomial F.

    Raises:
        Unproved: none were found.
    """
    swings = a.shape[1] > 1
    start = _hill(a[0], speed, _HILL) if swings else _eigen(a[0, 0])
    shapes, rates, same = _blocks(*start)
    while True:
        shapes, rates, inverse = _refined(a[:1], speed, shapes, rates, same)
        tail = np.abs(shapes[0, [0, -1]]).max() if swings else 0.0
        side = shapes.shape[1] // 2
        if tail < _TAIL[variables > 1] * np.abs(shapes).max() or side >= _MOST_HARMONICS:
            break
        shapes = widened(shapes, 1, 2 * (2 * side) + 1)
    return _expanded(a, speed, shapes, rates, inverse, same, variables, degree)


def _eigen(a: Complex) -> tuple[NDArray, Complex]:
    values, vectors = np.linalg.eig(a)
    return values, vectors.T[:, None]


def _hill(a: Complex, speed: float, side: int) -> tuple[NDArray, Complex]:
    """Exponents (d,) and harmonics (d, K, d) of the modes nearest to the middle of the spectrum."""
    d, count = a.shape[1], 2 * side + 1
    matrix = np.zeros((count, d, count, d), complex)
    for k in range(count):
        for j in range(max(0, k - 1), min(count, k + 2)):
            matrix[k, :, j] = a[1 + k - j]
        matrix[k, :, k] -= 2j * (k - side) * speed * np.eye(d)
    values, vectors = np.linalg.eig(matrix.reshape(count * d, count * d))
    vectors = vectors.T.reshape(-1, count, d)
    weight = (np.abs(vectors) ** 2).sum(axis=2)
    centre = weight @ np.arange(-side, side + 1) / weight.sum(axis=1)
    chosen: list[int] = []
    span = np.zeros((0, d), complex)
    for i in np.argsort(np.abs(centre), kind="stable"):
        column = vectors[i].sum(axis=0)  # at beta = 0, where all shifts of a mode are alike
        size = np.linalg.norm(column)
        rest = column - (span.conj() @ column) @ span
        rest = rest - (span.conj() @ rest) @ span
        if np.linalg.norm(rest) > _INDEPENDENT * size + _CUT * np.sqrt(weight[i, [0, -1]].max()):
            chosen.append(int(i))
            span = np.vstack([span, rest / np.linalg.norm(rest)])
        if len(chosen) == d:
            return values[chosen], vectors[chosen]
    if side < _MOST_HARMONICS:
        return _hill(a, speed, 2 * side)
    raise Unproved("the modes of the system cannot be distinguished")


def _blocks(values: NDArray, vectors: Complex) -> tuple[Complex, Complex, NDArray[np.bool_]]:
    """F, T and which modes share a block: orthonormal vectors in each, T triangular."""
    decay = np.abs(values.real)
    near = np.abs(values[:, None] - values) <= _ALIKE * np.minimum(decay[:, None], decay)
    same = near
    for _ in values:  # the blocks are what is connected
        same = (same.astype(float) @ near) > 0.0
    d, count = vectors.shape[2], vectors.shape[1]
    flat = vectors.reshape(d, -1).T
    shapes, rates = np.zeros(flat.shape, complex), np.zeros((1, 1, d, d), complex)
    for block in {tuple(np.flatnonzero(row)) for row in same}:
        at = list(block)
        shapes[:, at], upper = np.linalg.qr(flat[:, at])
        mixed = upper @ np.diag(values[at])
        with np.errstate(all="ignore"):
            rates[0, 0][np.ix_(at, at)] = np.linalg.lstsq(upper.T, mixed.T, rcond=None)[0].T
    return shapes.reshape(1, count, d, d), rates, same


def derived(shapes: NDArray, speed: float, variables: int, degree: int) -> NDArray:
    """F' = 2 i k (w0 + s) F, with one degree more."""
    side = shapes.shape[1] // 2
    turns = 2j * np.arange(-side, side + 1)[:, None, None]
    out = widened(turns * shapes * speed, count(variables, degree + 1), shapes.shape[1])
    out[products(variables, 1, degree)[1]] += turns * shapes
    return out


def _solved(z: Complex, rates: Complex, same: NDArray, speed: float) -> tuple[Complex, Complex]:
    """Y, T of T0 Y - Y T0 - Y' + Z = T, for one power of s: Y takes what no block of T holds."""
    side = z.shape[1] // 2
    t0 = rates[0, 0]
    values, rest = t0.diagonal(), t0 - np.diag(t0.diagonal())
    turns = 2j * speed * np.arange(-side, side + 1)[:, None, None]
    divisor = values[None, None, :] - values[None, :, None] + turns
    left = np.broadcast_to(same, z.shape[1:]) & (turns == 0)
    divisor = np.where(left, 1.0, divisor)
    y = np.zeros_like(z)
    for _ in range(2 * len(same) if rest.any() else 1):
        before = y
        with np.errstate(all="ignore"):
            y = np.where(left, 0.0, (z + rest @ y - y @ rest) / divisor)
        if not np.isfinite(y).all():
            raise Unproved("two modes cannot be distinguished")
        if np.abs(y - before).max() <= 1e-14 * np.abs(y).max():
            break
    block = np.where(left, z + rest @ y - y @ rest, 0.0)
    return y, block[:, side : side + 1]


def _inverse(shapes: Complex) -> Complex:
    """F^-1 at s = 0, by its values at evenly spread angles."""
    harmonics = shapes.shape[1]
    points = 1 if harmonics == 1 else 2 * harmonics
    side = harmonics // 2
    spread = np.zeros((points, *shapes.shape[2:]), complex)
    spread[np.arange(-side, side + 1) % points] = shapes[0]
    try:
        values = np.linalg.inv(np.fft.ifft(spread, axis=0) * points)
    except np.linalg.LinAlgError:
        raise Unproved("the modes of the system are not independent") from None
    back = np.fft.fft(values, axis=0) / points
    return back[np.arange(-side, side + 1) % points][None]


def _residual(
    a: Complex, speed: float, shapes: Complex, rates: Complex, variables: int, degree: int
) -> Complex:
    """Coefficients of one degree of A F - F' - F T, with all its harmonics."""
    at = slice(count(variables, degree - 1) if degree else 0, count(variables, degree))
    total = convolved(a[: count(variables, degree)], shapes, variables)[at]
    right = convolved(shapes, rates, variables)
    for other in (derived(shapes, speed, variables, degree), right):
        total -= widened(other[at], len(total), total.shape[1])
    return total


def _refined(
    a: Complex, speed: float, shapes: Complex, rates: Complex, same: NDArray
) -> tuple[Complex, Complex, Complex]:
    """Newton's method, as long as the residual falls."""
    kept, least = None, np.inf
    for _ in range(_NEWTON):
        inverse = _inverse(shapes)
        z = convolved(inverse, _residual(a, speed, shapes, rates, 1, 0))
        size = float(np.abs(z).max())
        if not size < 0.5 * least:
            break
        kept, least = (shapes, rates, inverse), size
        y, change = _solved(widened(z, 1, shapes.shape[1]), rates, same, speed)
        rates = rates + change
        shapes = shapes + widened(convolved(shapes, y), 1, shapes.shape[1])
    if kept is None:
        raise Unproved("the modes of the system were not found")
    return kept


def _expanded(
    a: Complex, speed: float, shapes: Complex, rates: Complex, inverse: Complex,
    same: NDArray, variables: int, degree: int,
) -> Modes:  # fmt: skip
    """The degrees above 0, one after the other."""
    first, harmonics = shapes, shapes.shape[1]
    for power in range(1, degree + 1):
        done, more = count(variables, power - 1), count(variables, power)
        shapes, rates = widened(shapes, more, harmonics), widened(rates, more, 1)
        left = _residual(a, speed, shapes, rates, variables, power)
        z = widened(convolved(inverse, left), more - done, harmonics)
        y, change = _solved(z, rates, same, speed)
        rates[done:] = change
        shapes[done:] = widened(convolved(first, y), more - done, harmonics)
    return Modes(shapes, rates, inverse)
