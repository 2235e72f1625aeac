"""Small motions about the balanced motion, x' = A(w, beta) x, with balls for coefficients.

The equations are assembled by `linear.small_motions`, but from other coordinates: zeta, D zeta, the
moments of the weights in the planes, and their rates for each balancer.  In these the turns of
weights that change no moment do not appear at all: N - 2 neutral directions of N weights in a plane
are divided out exactly, and the rates left over decay as e^{-d t}.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from flint import arb
from numpy.typing import NDArray
from scipy.linalg import matrix_balance

from ..linear.small_motions import Couplings, small_motions
from .arrays import balls, solve
from .balanced import Seen
from .rotors import RotorBalls
from .series import UP, Series, monomials
from .slopes import Exact, Sloped, ball, slopes_of

_AXES = np.eye(2, dtype=int)


@dataclass(frozen=True, eq=False)
class Equations:
    """A = sum_k w^k steady[k] + cosine cos 2 beta + sine sin 2 beta, scaled.

    Attributes:
        mid, rad: (5, d, d) of steady (3), cosine, sine, in the middle of a set of machines; (7, d,
            d) where bearings change with the speed: w cosine and w sine behind them.
        slopes: (m, 5 or 7, d, d) what each parameter e_j adds, |e_j| <= 1; `rad` bounds what more
            does.
        decays: drag rates of the turns that the rotor does not see: lower bounds [1/s].
        piece: speeds between which these are the equations [rad/s].
    """

    mid: NDArray[np.float64]
    rad: NDArray[np.float64]
    slopes: NDArray[np.float64]
    decays: tuple[float, ...]
    piece: tuple[float, float] = (0.0, math.inf)

    @classmethod
    def of(
        cls, middle: Exact, machines: Exact, weights: Sequence[Seen],
        piece: tuple[float, float] = (0.0, math.inf),
    ) -> Equations:  # fmt: skip
        """Doubles and bounds, in units that balance the sizes of rows and columns.

        Args:
            middle, machines: `matrices` of the machine in the middle, and of a set.
            weights: of the set.
            piece: as the attribute.
        """
        count = max((len(x.slopes) for x in machines.flat if isinstance(x, Sloped)), default=0)
        values = np.zeros((1 + count, *machines.shape))
        rad = np.zeros(machines.shape)
        for at, value in np.ndenumerate(middle):
            for k, part in enumerate([value, *slopes_of(machines[at], count)]):
                if not part.is_zero():
                    values[k][at] = float(part)
                    rad[at] += float((part - arb(values[k][at])).abs_upper()) * UP
        _, (scale, _) = matrix_balance(np.abs(values[0]).sum(axis=0), permute=False, separate=True)
        factor = scale / scale[:, None]  # powers of 2: exact
        decays = tuple(float(ball(w.rate).lower()) / UP for w in weights if w.free)
        return cls(values[0] * factor, rad * factor * UP, values[1:] * factor, decays, piece)

    @property
    def size(self) -> int:
        """Order d of the system."""
        return self.mid.shape[1]

    @property
    def variables(self) -> int:
        """Number of s, e_1, e_2, ..."""
        return 1 + len(self.slopes)

    def around(self, speed: float) -> Series:
        """A in s = w - speed and the e_j, degree 3, by harmonics e^{2 i k beta}, |k| <= 1 or 0."""
        rows = self._about(speed, range(3))
        orders = monomials(self.variables, 3)
        by_one = np.eye(self.variables, dtype=int)[:, 1:].tolist()  # 1, e_1, e_2, ...
        places = [[orders.index((p, *each)) for each in by_one] for p in range(3)]
        side = int(self.mid[3:].any() or self.slopes[:, 3:].any())
        out = np.zeros((len(orders), 1 + 2 * side, self.size, self.size), complex)
        bound = np.zeros(out.shape)
        for at, row in zip(places, rows, strict=True):
            out[at, side], bound[at, side] = row.mid, row.rad
        swings = (self._about(speed, range(first, len(self.mid), 2)) for first in (3, 4))
        for at, cosine, sine in zip(places, *swings, strict=False):
            radius = (cosine.rad + sine.rad) / (1.0 + side) * UP
            bound[at, 0] += radius
            if side:
                bound[at, 2] += radius
                out[at, 2] = (cosine.mid - 1j * sine.mid) / 2.0
                out[at, 0] = (cosine.mid + 1j * sine.mid) / 2.0
        return Series(out, bound, self.variables)

    def _about(self, speed: float, parts: Sequence[int]) -> list[Series]:
        """Coefficients of 1, s, s^2 of the sum of w^k part[k], w = speed + s: by parameters."""
        mid = np.concatenate([self.mid[None], self.slopes]).astype(complex)
        rad = np.concatenate([self.rad[None], np.zeros(self.slopes.shape)])
        given = [Series(mid[:, k], rad[:, k]) for k in parts]
        linear, square = Series.number(speed), Series.number(speed) * Series.number(speed)
        if len(given) == 1:
            return given
        if len(given) == 2:
            return [given[0] + linear * given[1], given[1]]
        zero, one, two = given
        twice = Series.number(2.0) * linear
        return [zero + linear * one + square * two, one + twice * two, two]


def matrices(rotor: RotorBalls, weights: Sequence[Seen]) -> Exact:
    """The matrices (5 or 7, d, d) of a rotor with its balancers, as in `Equations`, not scaled."""
    n = len(rotor.mass)
    sees = [np.kron(_AXES, rotor.planes[w.plane][None]) for w in weights]  # (2, 2n) each
    pulls = [rows.T @ w.basis for rows, w in zip(sees, weights, strict=True)]
    pull_turn, feeds = _turns(rotor, weights, pulls, sees)
    nothing = balls(np.zeros((0, 2 * n)))
    drives = [w.drive @ rows for rows, w in zip(sees, weights, strict=True)]
    couplings = Couplings(
        pull_turn=pull_turn,
        pull_rate=np.hstack([nothing.T, *pulls]),
        feed=np.hstack([balls(np.zeros((pull_turn.shape[1], 0))), *feeds]),
        drag=balls([w.rate for w in weights for _ in w.basis.T]),
        drive=np.vstack([nothing, *drives]),
    )
    mass = np.kron(_AXES, rotor.mass) - couplings.pull_rate @ couplings.drive
    return balls(small_motions(rotor, mass, couplings, _solve_each))


def _solve_each(matrix: Exact, parts: Exact) -> Exact:
    """matrix^-1 of each part (k, d, e)."""
    return np.stack(np.split(solve(matrix, np.hstack(list(parts))), len(parts), axis=1))


def _turns(
    rotor: RotorBalls, weights: Sequence[Seen], pulls: Sequence[Exact], sees: Sequence[Exact]
) -> tuple[Exact, list[Exact]]:
    """How moments pull on the stations (2n, r), and how they change by the rates of each."""
    n = rotor.planes.shape[1]
    planes = list(dict.fromkeys(w.plane for w in weights))
    if len(planes) > n:  # the stations' moments are fewer
        return balls(np.eye(2 * n)), list(pulls)
    columns, feeds = [balls(np.zeros((2 * n, 0)))], []
    bases = []
    for plane in planes:
        of = [k for k, w in enumerate(weights) if w.plane == plane]
        basis = weights[of[0]].basis if len(of) == 1 else balls(np.eye(2))
        bases.append(basis)
        columns.append(sees[of[0]].T @ basis)
    width, start = sum(b.shape[1] for b in bases), 0
    starts = {}
    for plane, basis in zip(planes, bases, strict=True):
        starts[plane] = start, basis
        start += basis.shape[1]
    for w in weights:
        begin, basis = starts[w.plane]
        feed = balls(np.zeros((width, w.basis.shape[1])))
        feed[begin : begin + basis.shape[1]] = basis.T @ w.basis
        feeds.append(feed)
    return np.hstack(columns), feeds
