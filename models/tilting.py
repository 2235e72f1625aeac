"""A massless shaft with the slopes of discs that tilt, by beam elements.

Every coordinate is a displacement: x of the stations, and for each disc that tilts that of a point
of its axis, an arm beyond its station.  The slopes of all other stations have no inertia; they
follow, exactly, from the others (static condensation).  Przemieniecki 1968 (5.116) has the element.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from .arrays import Numbers, numbers

Solve = Callable[[Numbers, Numbers], Numbers]


@dataclass(frozen=True, eq=False)
class TiltingShaft:
    """A shaft with n stations, t of them with a disc that tilts; c = n + t coordinates.

    Attributes:
        stiffness: (c, c) of the free shaft [N/m].
        motion: (2n, c) displacements, then slopes [1/m], of all stations.
        tilts: (n,) which stations have a disc that tilts.
    """

    stiffness: Numbers
    motion: Numbers
    tilts: tuple[bool, ...]

    @property
    def slopes(self) -> Numbers:
        """(n, c) of the stations [1/m]."""
        return self.motion[len(self.tilts) :]

    def row(self, z: Numbers, place: float) -> Numbers:
        """(c,) displacement at a place between two stations; by reciprocity a force's shares."""
        n = len(z)
        left = max(k for k in range(n - 1) if float(z[k]) <= place)
        length = z[left + 1] - z[left]
        s = (place - z[left]) / length
        bent = numbers(
            [
                1 - 3 * s * s + 2 * s * s * s,
                length * (s - 2 * s * s + s * s * s),
                3 * s * s - 2 * s * s * s,
                length * (s * s * s - s * s),
            ]
        )
        return bent @ self.motion[[left, n + left, left + 1, n + left + 1]]

    def compliances(self, ends: Sequence[int], solve: Solve) -> list[Numbers]:
        """Displacement of every station but `ends` by a unit force, simply supported there."""
        n, free = len(self.tilts), [k for k in range(len(self.stiffness)) if k not in ends]
        inverse = solve(self.stiffness[np.ix_(free, free)], np.eye(len(free)))
        return [inverse[k, k] for k, at in enumerate(free) if at < n]


def arms(masses: Iterable[float], transverse: Sequence[float]) -> list[float]:
    """Radius of gyration of every disc about a diameter, 0 for a point [m].

    A coordinate's scale: any length does, and no interval may be one.
    """
    pairs = zip(masses, transverse, strict=True)
    return [math.sqrt(float(inertia) / float(mass)) for mass, inertia in pairs]


def tilting_shaft(
    z: Numbers,
    lengths: Sequence[float],
    bending_stiffness: float,
    shear_stiffness: float | None,
    solve: Solve,
) -> TiltingShaft:
    """The shaft between stations at z (n,).

    Args:
        lengths: (n,) arms of the discs, 0 where a station has no slope of its own [m].
        bending_stiffness, shear_stiffness: E I [N m^2]; kappa G A [N], None: no shear.
        solve: matrix^-1 right.
    """
    n, tilts = len(z), tuple(length > 0.0 for length in lengths)
    whole = _free_shaft(z, bending_stiffness, shear_stiffness)
    own, passive = np.flatnonzero(tilts), np.flatnonzero(~np.array(tilts))
    active = np.zeros((n + len(own), n + len(own)))
    active[:n, :n] = np.eye(n)
    for arm, station in enumerate(own.tolist(), start=n):
        active[arm, [arm, station]] = [1.0 / lengths[station], -1.0 / lengths[station]]
    motion = np.zeros((2 * n, n + len(own)), whole.dtype)
    kept = [*range(n), *(n + own)]
    motion[kept] = active
    if len(passive):
        coupled = whole[np.ix_(n + passive, kept)] @ active
        motion[n + passive] = -solve(whole[np.ix_(n + passive, n + passive)], coupled)
    stiffness = motion.T @ whole @ motion
    return TiltingShaft((stiffness + stiffness.T) / 2, motion, tilts)


def _free_shaft(z: Numbers, bending: float, shear: float | None) -> Numbers:
    """Stiffness (2n, 2n) of displacements, then slopes, of all stations."""
    n = len(z)
    total = np.zeros((2 * n, 2 * n), z.dtype) * bending
    for k in range(n - 1):
        at = [k, n + k, k + 1, n + k + 1]
        total[np.ix_(at, at)] = total[np.ix_(at, at)] + _element(z[k + 1] - z[k], bending, shear)
    return total


def _element(length: float, bending: float, shear: float | None) -> Numbers:
    """Stiffness (4, 4) of a beam by (x_j, psi_j, x_k, psi_k)."""
    phi = 0 if shear is None else 12 * bending / (shear * length * length)
    a, b = 6 * length, length * length
    rows = [
        [12, a, -12, a],
        [a, (4 + phi) * b, -a, (2 - phi) * b],
        [-12, -a, 12, -a],
        [a, (2 - phi) * b, -a, (4 + phi) * b],
    ]
    return numbers(rows) * (bending / (length * length * length * (1 + phi)))
