"""Small motions about the balanced motion, x' = A(w, beta) x, with balls for coefficients.

The equations are those of `linear.linearised`, in other coordinates: zeta, D zeta, the moments of
the weights in the planes, and their rates for each balancer.  In these the turns of weights that
change no moment do not appear at all: N - 2 neutral directions of N weights in a plane are divided
out exactly, and the rates left over decay as e^{-d t}.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from flint import arb
from numpy.typing import NDArray
from scipy.linalg import matrix_balance

from .balanced import Seen
from .rotors import Exact, RotorBalls, balls, product, solve
from .series import UP, Series

_AXES = np.eye(2, dtype=int)
_TURN = np.array([[0, -1], [1, 0]])  # i
_MIRRORS = np.array([[[1, 0], [0, -1]], [[0, -1], [-1, 0]]])  # of cos 2 beta and sin 2 beta


@dataclass(frozen=True, eq=False)
class Equations:
    """A = sum_k w^k steady[k] + cosine cos 2 beta + sine sin 2 beta, scaled.

    Attributes:
        mid, rad: (5, d, d) of steady (3), cosine, sine.
        periodic: whether the last two are not 0.
        decays: drag rates of the turns that the rotor does not see: lower bounds [1/s].
    """

    mid: NDArray[np.float64]
    rad: NDArray[np.float64]
    periodic: bool
    decays: tuple[float, ...]

    @property
    def size(self) -> int:
        """Order d of the system."""
        return self.mid.shape[1]

    def around(self, speed: float) -> Series:
        """A in powers of w - speed (3) and in harmonics e^{2 i k beta}, k = -1, 0, 1 (or 0)."""
        steady = Series(self.mid[:3, None].astype(complex), self.rad[:3, None])
        zero, one, two = (steady.order(k) for k in range(3))
        linear, square = Series.number(speed), Series.number(speed) * Series.number(speed)
        rows = zero + linear * one + square * two, one + Series.number(2.0) * linear * two, two
        expanded = Series.stack(rows)
        if not self.periodic:
            return expanded
        mid = np.zeros((3, 3, self.size, self.size), complex)
        rad = np.zeros(mid.shape)
        mid[:, 1:2], rad[:, 1:2] = expanded.mid, expanded.rad
        mid[0, 2] = (self.mid[3] - 1j * self.mid[4]) / 2.0
        mid[0, 0] = mid[0, 2].conj()
        rad[0, 0] = rad[0, 2] = (self.rad[3] + self.rad[4]) / 2.0 * UP
        return Series(mid, rad)


def equations(rotor: RotorBalls, mass: Exact, weights: Sequence[Seen]) -> Equations:
    """The system of a rotor with its balancers.

    Args:
        mass: the rotor's mass matrix with all balancers.
    """
    n = len(mass)
    sees = [np.kron(_AXES, rotor.planes[w.plane][None]) for w in weights]  # (2, 2n) each
    pulls = [product(rows.T, w.basis) for rows, w in zip(sees, weights, strict=True)]
    drives = [product(w.drive, rows) for rows, w in zip(sees, weights, strict=True)]
    pull_turn, feeds = _turns(rotor, weights, pulls, sees)
    widths = [2 * n, 2 * n, pull_turn.shape[1], *(p.shape[1] for p in pulls)]
    ends = np.cumsum([0, *widths])
    q, u, g, *v = (slice(a, b) for a, b in pairwise(ends))
    size, turn = int(ends[-1]), np.kron(_TURN, np.eye(n, dtype=int))
    effective = np.kron(_AXES, mass)
    forces = balls(np.zeros((5, 2 * n, size)))
    forces[0, :, q] = -np.kron(_AXES, rotor.stiffness)
    forces[0, :, u] = -np.kron(_AXES, rotor.damping + rotor.internal)
    forces[1, :, q] = np.kron(_TURN, rotor.internal)
    forces[1, :, u] = np.kron(_TURN, rotor.gyroscopic)
    forces[2, :, g] = pull_turn
    for w, pull, drive, at in zip(weights, pulls, drives, v, strict=True):
        effective = effective - product(pull, drive)
        forces[0, :, at] = pull * w.rate
        forces[1, :, at] = -2 * (turn @ pull)
    for k, mirror in enumerate(_MIRRORS, start=3):
        forces[k, :, q] = -np.kron(mirror, rotor.half_stiffness)
        forces[k, :, u] = -np.kron(mirror, rotor.half_damping)
    acceleration = solve(effective, np.hstack(list(forces)))
    matrices = balls(np.zeros((5, size, size)))
    for k, part in enumerate(np.split(acceleration, 5, axis=1)):
        matrices[k, u] = part
        for drive, at in zip(drives, v, strict=True):
            matrices[k, at] = -product(drive, part)
    matrices[0, q, u] += np.eye(2 * n, dtype=int)
    for feed, w, at in zip(feeds, weights, v, strict=True):
        matrices[0, g, at] += feed
        for k in range(at.start, at.stop):
            matrices[0, k, k] -= w.rate
    if weights:
        matrices[1, q, q] -= turn
        matrices[1, u, u] -= turn
    else:  # in fixed axes, where beta stays 0
        matrices[0] += matrices[3]
        matrices[3:] = balls(np.zeros((2, size, size)))
    decays = tuple(float(w.rate.lower()) / UP for w in weights if w.free)
    return _in_floats(matrices, decays)


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
        columns.append(product(sees[of[0]].T, basis))
    width, start = sum(b.shape[1] for b in bases), 0
    starts = {}
    for plane, basis in zip(planes, bases, strict=True):
        starts[plane] = start, basis
        start += basis.shape[1]
    for w in weights:
        begin, basis = starts[w.plane]
        feed = balls(np.zeros((width, w.basis.shape[1])))
        feed[begin : begin + basis.shape[1]] = product(basis.T, w.basis)
        feeds.append(feed)
    return np.hstack(columns), feeds


def _in_floats(matrices: Exact, decays: tuple[float, ...]) -> Equations:
    """Balls of doubles, in units that balance the sizes of rows and columns."""
    mid, rad = np.zeros(matrices.shape), np.zeros(matrices.shape)
    for index, value in np.ndenumerate(matrices):
        if not value.is_zero():
            mid[index] = float(value)
            rad[index] = float((value - arb(mid[index])).abs_upper()) * UP
    sizes = np.abs(mid).sum(axis=0)
    _, (scale, _) = matrix_balance(sizes, permute=False, separate=True)  # powers of 2: exact
    factor = scale / scale[:, None]
    return Equations(mid * factor, rad * factor, bool(mid[3:].any() or rad[3:].any()), decays)
