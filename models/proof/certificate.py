"""What approximate modes prove about all speeds of an interval.

With x = F y and an approximate inverse G, G F = 1 + E, the system reads y' = (T + D) y,
|D| <= (1 - |E|)^-1 |G (A F - F' - F T)| entry by entry.  Let c be its matrix.  If numbers sigma > 0
exist with |Re c_ii| sigma_i > sum |c_ij| sigma_j at all times (j other than i), no multiplier lies
on the unit circle, and as many lie outside as Re c_ii are positive (Lazer 1971).  Proof: let
y(t) = e^{i a t} p(t), p periodic.  Where |y_i|/sigma_i is largest over i and t its derivative is 0,
but |Re c_ii y_i| > |sum c_ij y_j|.  With c_ij made smaller the same holds, so that the number of
multipliers outside is that of the diagonal.  For c - tau, tau > 0, it proves a growth above tau.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from .equations import Equations
from .modes import POWERS, Modes, derived, modes
from .rotors import Unproved
from .series import UP, Array, Series

State = Literal["stable", "unstable", "undecided"]


@dataclass(frozen=True, eq=False)
class Certificate:
    """Bounds for the speeds around one speed w0; s = w - w0.

    Attributes:
        speed: w0 [rad/s].
        found: the modes.
        residual: bounds of G (A F - F' - F T), (Q, d, d) by powers of s.
        error: of G F - 1, (P, d, d).
        decays: `Equations.decays`.
    """

    speed: float
    found: Modes
    residual: Array
    error: Array
    decays: tuple[float, ...]

    @classmethod
    def of(cls, system: Equations, speed: float, powers: int = POWERS) -> Certificate:
        """Modes around a speed [rad/s] and what they leave.

        Raises:
            Unproved: no modes were found.
        """
        a = system.around(speed)
        try:
            found = modes(a.mid, speed, powers)
        except np.linalg.LinAlgError as failure:
            raise Unproved(str(failure)) from failure
        f, t, g = (Series.exact(x) for x in (found.shapes, found.rates, found.inverse))
        left, right = a @ f, f @ t
        # each of the products by a turn rounds, and so does their sum
        slope = derived(found.shapes, speed)
        turned = Series(-slope, 8.0 * 2.0**-53 * np.abs(derived(np.abs(found.shapes), speed)) * UP)
        most = max(len(left.mid), len(right.mid), len(turned.mid))
        parts = [x.widened(most, left.mid.shape[1]) for x in (left, turned)]
        minus = Series(-right.mid, right.rad).widened(most, left.mid.shape[1])
        rest = g @ (parts[0] + parts[1] + minus)
        near = g @ f
        one = np.zeros(near.mid.shape, complex)
        one[0, near.mid.shape[1] // 2] = -np.eye(system.size)
        error = near + Series.exact(one)
        return cls(
            speed, found, rest.size.sum(axis=1) * UP, error.size.sum(axis=1) * UP, system.decays
        )

    @cached_property
    def growth(self) -> float:
        """Approximate largest growth rate at w0 [1/s]."""
        return float(self.found.rates[0, 0].diagonal().real.max())

    def state(self, low: float, high: float) -> State:
        """What is proved of all speeds from `low` to `high` [rad/s]."""
        bounds = self._bounds(low, high)
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

    def _bounds(self, low: float, high: float) -> tuple[Array, Array, Array] | None:
        """Least and largest Re c_ii (d,), and bounds of |c_ij| off the diagonal (d, d)."""
        from_middle = max(self.speed - low, high - self.speed, 0.0) * UP
        powers = from_middle ** np.arange(len(self.residual)) * UP
        residual = np.tensordot(powers, self.residual, 1) * UP
        error = np.tensordot(powers[: len(self.error)], self.error, 1) * UP
        size = len(error)
        with np.errstate(all="ignore"):
            try:
                rest = np.linalg.solve(np.eye(size) - error, residual) * (1.0 + 1e-6) + 1e-280
            except np.linalg.LinAlgError:
                return None
        # X > 0 and X > N + E X: then no power of E grows, and X bounds (1 - E)^-1 N
        if not ((rest > 0.0) & (rest > (residual + error @ rest * UP) * UP)).all():
            return None
        rates = self.found.rates[:, 0]
        sizes = np.abs(rates) * powers[: len(rates), None, None] * UP
        rounding = sizes.sum(axis=0) * 2.0**-48
        middle, half = 0.5 * (low + high) - self.speed, 0.5 * (high - low) * UP
        diagonal = rates.diagonal(axis1=1, axis2=2).real
        value = np.polynomial.polynomial.polyval(middle, diagonal)
        orders = np.arange(1, len(rates))
        slope = np.abs(diagonal[1:] * (orders * powers[: len(orders)])[:, None]).sum(axis=0) * UP
        reach = (half * slope + (rest + rounding).diagonal()) * UP + 2.0**-50 * np.abs(value)
        beside = (sizes.sum(axis=0) + rest) * UP
        np.fill_diagonal(beside, 0.0)
        return value - reach, value + reach, beside


def _dominant(least: Array, most: Array, beside: Array, shift: float) -> bool:
    """Whether numbers sigma as in the module's head exist for c - shift; found and then proved."""
    slack = 1.0 - 2.0**-40
    away = np.maximum(least - shift, shift - most) * slack
    if not (away > 0.0).all():
        return False
    sigma = np.linalg.solve(np.diag(away) - beside, away)
    return bool((sigma > 0.0).all() and (away * sigma * slack > beside @ sigma).all())
