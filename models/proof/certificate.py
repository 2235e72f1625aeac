"""What approximate modes prove about all speeds of an interval and all machines of a set.

With x = F y and an approximate inverse G, G F = 1 + E, the system reads y' = (T + D) y,
|D| <= (1 - |E|)^-1 |G (A F - F' - F T)| entry by entry.  Let c be its matrix.  If numbers sigma > 0
exist with |Re c_ii| sigma_i > sum |c_ij| sigma_j at all times (j other than i), no multiplier lies
on the unit circle, and as many lie outside as Re c_ii are positive (Lazer 1971).  Proof: let
y(t) = e^{i a t} p(t), p periodic.  Where |y_i|/sigma_i is largest over i and t its derivative is 0,
but |Re c_ii y_i| > |sum c_ij y_j|.  With c_ij made smaller the same holds, so that the number of
multipliers outside is that of the diagonal.  For c - tau, tau > 0, it proves a growth above tau.
"""

from __future__ import annotations

import functools
import operator
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from .arrays import Unproved
from .equations import Equations
from .modes import DEGREE, DEGREES, Modes, derived, modes
from .series import UP, Array, Series, degree_of, monomials

_NEAR = 1.0 + 2.0**-40  # of a product of powers: covers its rounding
State = Literal["stable", "unstable", "undecided"]


@dataclass(frozen=True, eq=False)
class Certificate:
    """Bounds for the speeds around one speed w0; s = w - w0.

    Attributes:
        speed: w0 [rad/s].
        found: the modes.
        residual: bounds of G (A F - F' - F T), (Q, d, d) by monomials, for all beta.
        error: of G F - 1, (P, d, d).
        orders: (Q, n) exponents of s, e_1, ... in the monomials.
        decays, piece: as of `Equations`; of speeds outside the piece nothing is known.
    """

    speed: float
    found: Modes
    residual: Array
    error: Array
    orders: NDArray[np.int64]
    decays: tuple[float, ...]
    piece: tuple[float, float]

    @classmethod
    def of(cls, system: Equations, speed: float, degree: int | None = None) -> Certificate:
        """Modes around a speed [rad/s] and what they leave.

        Args:
            degree: of the polynomial in speed and parameters.

        Raises:
            Unproved: no modes were found.
        """
        a, n = system.around(speed), system.variables
        if degree is None:
            degree = (*DEGREES, DEGREE)[min(n - 1, len(DEGREES))]
        try:
            found = modes(a.mid, speed, n, degree)
        except np.linalg.LinAlgError as failure:
            raise Unproved(str(failure)) from failure
        f, t, g = (Series.exact(x, n) for x in (found.shapes, found.rates, found.inverse))
        left, right = a @ f, f @ t
        # each of the products by a turn rounds, and so does their sum
        slope, sizes = (derived(x, speed, n, degree) for x in (f.mid, np.abs(f.mid)))
        turned = Series(-slope, 8.0 * 2.0**-53 * np.abs(sizes) * UP, n)
        most = max(len(left.mid), len(right.mid))
        minus = Series(-right.mid, right.rad, n)
        wide = (x.widened(most, left.mid.shape[1]) for x in (left, turned, minus))
        rest, near = g @ functools.reduce(operator.add, wide), g @ f
        one = np.zeros(near.mid.shape, complex)
        one[0, near.mid.shape[1] // 2] = -np.eye(system.size)
        error = near + Series.exact(one, n)
        orders = np.array(monomials(n, degree_of(len(rest.mid), n)))
        residual, size = (x.size.sum(axis=1) * UP for x in (rest, error))
        return cls(speed, found, residual, size, orders, system.decays, system.piece)

    @cached_property
    def growth(self) -> float:
        """Approximate largest growth rate at w0 [1/s]."""
        return float(self.found.rates[0, 0].diagonal().real.max())

    @cached_property
    def influences(self) -> list[float]:
        """How much the speed (per rad/s) and each parameter turn the modes and move their rates."""
        linear = slice(1, 1 + self.orders.shape[1])
        rates = self.found.rates[:, 0].diagonal(axis1=1, axis2=2).real
        moved = np.abs(rates[linear] / rates[0]).max(axis=1)
        return list(moved + np.abs(np.linalg.eigvals(self.error[linear])).max(axis=1))

    @cached_property
    def growth_slopes(self) -> list[float]:
        """By which each parameter moves the largest growth rate [1/s]."""
        rates = self.found.rates[:, 0].diagonal(axis1=1, axis2=2).real
        slopes: list[float] = rates[2 : 1 + self.orders.shape[1], rates[0].argmax()].tolist()
        return slopes

    def state(self, low: float, high: float, part: Sequence[tuple[float, float]] = ()) -> State:
        """What is proved of all speeds from `low` to `high` [rad/s].

        Args:
            part: of the machines: from and to in each e_j; default: all, -1 to 1.
        """
        inside = self.piece[0] <= low and high <= self.piece[1]
        bounds = self._bounds(low, high, part) if inside else None
        if bounds is None:
            return "undecided"
        least, most, beside = bounds
        if _dominant(least, most, beside, 0.0):
            if (least > 0.0).any():
                return "unstable"
            return "stable" if all(d > 0.0 for d in self.decays) else "undecided"
        top = float(least.max())
        below = most[most < top]
        for tau in (0.5 * top, 0.5 * (top + float(below.max(initial=0.0)))):
            if tau > 0.0 and _dominant(least, most, beside, tau):
                return "unstable"
        return "undecided"

    def _bounds(
        self, low: float, high: float, part: Sequence[tuple[float, float]]
    ) -> tuple[Array, Array, Array] | None:
        """Least and largest Re c_ii (d,), and bounds of |c_ij| off the diagonal (d, d)."""
        parts = part or [(-1.0, 1.0)] * (self.orders.shape[1] - 1)
        ends = np.array([(low - self.speed, high - self.speed), *parts])
        middle, size = ends.mean(axis=1), np.abs(ends).max(axis=1)
        half = 0.5 * np.ptp(ends, axis=1) + 2.0**-50 * size
        reach = np.prod((np.abs(middle) + half) ** self.orders, axis=1) * _NEAR
        residual, error = (
            np.tensordot(reach[: len(x)], x, 1) * UP for x in (self.residual, self.error)
        )
        with np.errstate(all="ignore"):
            try:
                rest = np.linalg.solve(np.eye(len(error)) - error, residual) * (1.0 + 1e-6) + 1e-280
            except np.linalg.LinAlgError:
                return None
        # X > 0 and X > N + E X: then no power of E grows, and X bounds (1 - E)^-1 N
        if not ((rest > 0.0) & (rest > (residual + error @ rest * UP) * UP)).all():
            return None
        rates = self.found.rates[:, 0]
        orders, reach = self.orders[: len(rates)], reach[: len(rates)]
        sizes = np.abs(rates) * reach[:, None, None] * UP
        rounding = sizes.sum(axis=0) * 2.0**-46
        diagonal = rates.diagonal(axis1=1, axis2=2).real
        places = np.prod(middle**orders, axis=1)
        value = places @ diagonal
        # |x^p - y^p| is at most (|y| + |x - y|)^p - |y|^p
        moved = (reach - np.abs(places) / _NEAR) @ np.abs(diagonal)
        away = (moved + (rest + rounding).diagonal()) * UP
        beside = (sizes.sum(axis=0) + rest) * UP
        np.fill_diagonal(beside, 0.0)
        return value - away, value + away, beside


def _dominant(least: Array, most: Array, beside: Array, shift: float) -> bool:
    """Whether numbers sigma as in the module's head exist for c - shift; found and then proved."""
    slack = 1.0 - 2.0**-40
    away = np.maximum(least - shift, shift - most) * slack
    if not (away > 0.0).all():
        return False
    sigma = np.linalg.solve(np.diag(away) - beside, away)
    return bool((sigma > 0.0).all() and (away * sigma * slack > beside @ sigma).all())
