"""Speeds at which the main motion gains or loses stability."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..assembly import Assembly
from ..stability import active_growth
from .linearised import Linearised, linearise

MARGIN = 1e-10  # growth per revolution that rounding alone can make
GRID = 1000  # intervals of the scan, unless the caller says how narrow a band may be missed
_SPLIT = 12  # parts of a bracket per round of refinement
_PLATEAU = 1e-9  # of the growth: what rounding makes of one that does not depend on the speed
_PROBE_ROUNDS = 6  # an extremum is located to (2/_SPLIT)^rounds of the scan's spacing
_TOLERANCE = 1e-9  # of the speed


@dataclass(frozen=True)
class Crossing:
    """A boundary of stability: its speed [rad/s] and what holds just above it."""

    speed: float
    above: Literal["stable", "unstable"]


def _growth(system: Linearised, speeds: NDArray) -> NDArray[np.float64]:
    """Growth rate of one system [1/s] at speeds of any shape."""
    which = np.zeros(speeds.size, int)
    return active_growth([system], which, speeds.ravel()).reshape(speeds.shape)


def _decided(speeds: NDArray, growth: NDArray) -> NDArray[np.bool_]:
    """Where the sign of the growth is more than rounding."""
    return np.abs(growth) * (2.0 * math.pi) > MARGIN * speeds


def _probe(
    growth_at: Callable[[NDArray], NDArray], w: NDArray, g: NDArray
) -> tuple[NDArray, NDArray]:
    """Samples that show a change of sign between two of the scan's speeds.

    Looked for wherever the growth, seen at three neighbouring speeds, comes closest to zero in the
    middle: the extremum is closed in on until the sign changes or the spacing is used up.
    """
    same = (np.sign(g[:-2]) == np.sign(g[1:-1])) & (np.sign(g[1:-1]) == np.sign(g[2:]))
    before, size, behind = np.abs(g[:-2]), np.abs(g[1:-1]), np.abs(g[2:])
    near = (size <= np.minimum(before, behind)) & (
        np.maximum(before, behind) > (1.0 + _PLATEAU) * size
    )
    middle = np.flatnonzero(same & near & _decided(w[1:-1], g[1:-1])) + 1
    low, high, sign = w[middle - 1], w[middle + 1], np.sign(g[middle])
    found_w: list[NDArray] = []
    found_g: list[NDArray] = []
    for _ in range(_PROBE_ROUNDS):
        if not len(low):
            break
        nodes = low[:, None] + (high - low)[:, None] * np.linspace(0.0, 1.0, _SPLIT + 1)
        values = growth_at(nodes)
        crossed = ((np.sign(values) == -sign[:, None]) & _decided(nodes, values)).any(axis=1)
        found_w.append(nodes[crossed].ravel())
        found_g.append(values[crossed].ravel())
        best = np.abs(values).argmin(axis=1)
        rows = np.arange(len(low))
        low = nodes[rows, np.maximum(best - 1, 0)][~crossed]
        high = nodes[rows, np.minimum(best + 1, _SPLIT)][~crossed]
        sign = sign[~crossed]
    return np.concatenate([w, *found_w]), np.concatenate([g, *found_g])


def balancing_boundaries(
    assembly: Assembly,
    low: float,
    high: float,
    *,
    narrowest: float | None = None,
    tolerance: float = _TOLERANCE,
) -> list[Crossing]:
    """Every speed between `low` and `high` at which stability changes, ascending.

    The range is scanned with a spacing of at most `narrowest`: no stable or unstable band wider
    than that is missed.  Narrower bands are looked for wherever the growth comes near zero between
    two of the scan's speeds; they are found down to about `narrowest`/10^4 when the growth rate
    is smooth there, and can be missed otherwise.  Speeds at which the growth is zero to rounding
    (no damping at all) count as neither stable nor unstable: none is reported among them.

    Args:
        low, high: range of speeds [rad/s], 0 < low < high.
        narrowest: width of a band that must not be missed [rad/s]; (high - low)/1000 by default.
        tolerance: relative error of the speeds.

    Raises:
        CannotBalance: the weights cannot undo the unbalance.
        ValueError: the range is empty or not positive, or `narrowest` is not positive.
    """
    if not 0.0 < low < high < math.inf:
        raise ValueError(f"range = {low:g} to {high:g} rad/s: must be positive and ascending")
    width = (high - low) / GRID if narrowest is None else narrowest
    if not width > 0.0:
        raise ValueError(f"narrowest = {width:g} rad/s: must be positive")
    scan = np.linspace(low, high, max(3, math.ceil((high - low) / width) + 1))
    return growth_boundaries(partial(_growth, linearise(assembly)), scan, tolerance)


def growth_boundaries(
    growth_at: Callable[[NDArray], NDArray], scan: NDArray, tolerance: float = _TOLERANCE
) -> list[Crossing]:
    """Where a growth rate changes its sign, as `balancing_boundaries`.

    Args:
        growth_at: growth rates [1/s] at speeds of any shape [rad/s].
        scan: speeds to begin with, ascending [rad/s].
        tolerance: relative error of the speeds.
    """
    w, g = _probe(growth_at, scan, growth_at(scan))
    left, right, sign = _brackets(w, g)
    while len(left) and ((right - left) > tolerance * right).any():
        nodes = left[:, None] + (right - left)[:, None] * np.linspace(0.0, 1.0, _SPLIT + 1)
        values = np.empty_like(nodes)
        values[:, 1:-1] = growth_at(nodes[:, 1:-1])
        values[:, 0], values[:, -1] = sign, -sign
        # a bracket may hold more than one change: every one found is kept
        row, column = np.nonzero(np.sign(values[:, 1:]) != np.sign(values[:, :-1]))
        left, right = nodes[row, column], nodes[row, column + 1]
        sign = np.sign(values[row, column])
    return [
        Crossing(float(speed), "stable" if before > 0.0 else "unstable")
        for speed, before in zip((left + right) / 2.0, sign, strict=True)
    ]


def _brackets(w: NDArray, g: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Neighbouring decided speeds between which the sign changes, and the sign before."""
    w, unique = np.unique(w, return_index=True)
    g = g[unique]
    sure = _decided(w, g)
    w, sign = w[sure], np.sign(g[sure])
    change = np.flatnonzero(sign[1:] != sign[:-1])
    return w[change], w[change + 1], sign[change]
