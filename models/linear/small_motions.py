"""The equations of small motions about the main motion, in the frame of the rotor.

In that frame (zeta = z e^{-i beta}, D = d/dt + i w) rotor and weights read

    M D^2 zeta + (C + C_i - i w G) D zeta + (K - i w C_i) zeta + anisotropy = -D^2 S^T ds,
    kappa theta_k'' + (b/m) theta_k' = -(1/R) Im(D^2 zeta_plane e^{-i theta_k}),
    anisotropy = e^{-2 i beta} (dC conj(D zeta) + dK conj(zeta)),

dC, dK half the difference between the axes: constant coefficients for an isotropic rotor, one pair
of harmonics of 2 beta for any other (Filimonikhin 2011 (11), Filimonikhina 2017 (9)).  With cross
terms K_xy, K_yx of the supports K becomes K - i (K_xy - K_yx)/2 and dK becomes
dK + i (K_xy + K_yx)/2, and so do C and dC.  The wave of a ring of liquid (`models.ring`) is one
station more; its damping by viscosity goes with the root of the speed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ..arrays import Numbers
from ..rotor import LinearRotor

Matrix = NDArray[np.float64]
TURN = np.array([[0.0, -1.0], [1.0, 0.0]])  # i


# e^{-2 i beta} conj(zeta) = (mirror[0] cos 2 beta + mirror[1] sin 2 beta) zeta
_MIRRORS = np.array([[[1.0, 0.0], [0.0, -1.0]], [[0.0, -1.0], [-1.0, 0.0]]])


@dataclass(frozen=True, eq=False)
class Couplings:
    """Weights in the coordinates that the rotor sees: turns g (r,) and rates v (R,)."""

    pull_turn: Numbers  # (2n, r)  S^T ds = pull_turn g
    pull_rate: Numbers  # (2n, R)  and of the rates
    feed: Numbers  # (r, R)   g' = feed v
    drag: Numbers  # (R,)     v' = -drag v - drive a
    drive: Numbers  # (R, 2n)
    spring: Numbers | None = None  # (R,)  v' = ... - w^2 spring g, of races with lobes
    neutral: int = 0
    free_decay: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))


@dataclass(frozen=True, eq=False)
class RotorParts:
    """Stiffness and damping of a rotor as real numbers and multiples of i, (n, n) each.

    Attributes:
        stiffness, damping: of both axes.
        half_stiffness, half_damping: by the conjugate.
        internal, gyroscopic: as in `LinearRotor`, with those of waves.
        centrifugal: (n,) force of the waves in proportion to their displacement, over w^2 [kg].
        rooted: (n,) damping of waves over the root of the speed; None where viscosity damps none.
        turning: the first four again as multiples of i; None where no support has cross terms.
        by_speed: what 1 rad/s more adds to stiffness and damping, of bearings that change with the
            speed along a line; None where none do.
    """

    stiffness: Numbers
    half_stiffness: Numbers
    damping: Numbers
    half_damping: Numbers
    internal: Numbers
    gyroscopic: Numbers
    centrifugal: Numbers
    rooted: Numbers | None = None
    turning: tuple[Numbers, Numbers, Numbers, Numbers] | None = None
    by_speed: RotorParts | None = None

    @classmethod
    def of(cls, rotor: LinearRotor) -> RotorParts:
        """Those of a rotor; the shaft's stiffness does not cancel, it does not stand in halves."""
        (k_xx, k_xy), (k_yx, k_yy) = rotor.springs
        (c_xx, c_xy), (c_yx, c_yy) = rotor.dampers
        waves = tuple(_waves(rotor))
        plain = (
            rotor.elastic + (k_xx + k_yy) / 2,
            (k_xx - k_yy) / 2,
            (c_xx + c_yy) / 2,
            (c_xx - c_yy) / 2,
            rotor.internal_damping + np.diag(waves[0]),
            rotor.gyroscopic + 4 * np.diag(waves[1]),
            2 * waves[1],
            waves[2] if any(ring.viscosity for _, ring in rotor.waves) else None,
        )
        if not rotor.crossed:
            return cls(*plain)
        turning = (k_yx - k_xy) / 2, (k_xy + k_yx) / 2, (c_yx - c_xy) / 2, (c_xy + c_yx) / 2
        return cls(*plain, turning)


def _waves(rotor: LinearRotor) -> Iterator[Numbers]:
    """Damping, inertia and damping over the root of the speed of every station's wave, (n,)."""
    for what in (
        lambda ring: ring.wave_inertia * ring.wave_damping,
        lambda ring: ring.wave_inertia,
        lambda ring: ring.wave_inertia * ring.root_damping,
    ):
        each = np.zeros(rotor.stations, object if rotor.mass.dtype == object else float)
        for at, ring in rotor.waves:
            each[at] = what(ring)
        yield each


@dataclass(frozen=True, eq=False)
class Blocks:
    """Where q = zeta, u = D zeta, turns g and rates v stand in the state; real parts first."""

    q: slice
    u: slice
    g: slice
    v: slice
    size: int

    @classmethod
    def of(cls, couplings: Couplings) -> Blocks:
        n2, r = couplings.pull_turn.shape
        size = 2 * n2 + r + couplings.pull_rate.shape[1]
        v = slice(2 * n2 + r, size)
        return cls(slice(0, n2), slice(n2, 2 * n2), slice(2 * n2, 2 * n2 + r), v, size)


def spread(axes: Matrix, matrix: Matrix) -> Matrix:
    """np.kron of (2, 2) and (n, n), which takes ten times as long in NumPy."""
    size = 2 * len(matrix)
    return (axes[:, None, :, None] * matrix[None, :, None, :]).reshape(size, size)


def small_motions(
    rotor: RotorParts, mass: Numbers, c: Couplings, solve: Callable[..., Numbers] = np.linalg.solve
) -> Numbers:
    """The matrices (5 or 7, d, d) of `Linearised`: steady, cosine, sine, and those of w^0.5, w^1.5.

    With bearings that change with the speed two more stand behind them: w cosine and w sine.

    Numbers may be of any kind that `solve` can compute with: a proof has balls.

    Args:
        rotor: its stiffness and damping.
        mass: of the rotor with its balancers, (2n, 2n), as D^2 zeta feels it.
    """
    at = Blocks.of(c)
    n, both = len(rotor.internal), np.eye(2)
    turn = spread(TURN, np.eye(n))
    parts = 5 + 2 * (rotor.rooted is not None) + 2 * (rotor.by_speed is not None)
    forces = np.zeros((parts, 2 * n, at.size), mass.dtype)  # rows of M_eff D^2 zeta
    _add_supports(forces, rotor, at, power=0, halves=3)
    if rotor.by_speed is not None:
        _add_supports(forces, rotor.by_speed, at, power=1, halves=parts - 2)
    forces[0, :, at.u] -= spread(both, rotor.internal)
    forces[0, :, at.v] = c.pull_rate * c.drag
    forces[1, :, at.q] += turn @ spread(both, rotor.internal)
    forces[1, :, at.u] += turn @ spread(both, rotor.gyroscopic)
    forces[1, :, at.v] = -2.0 * turn @ c.pull_rate
    forces[2, :, at.g] = c.pull_turn
    if c.spring is not None:
        forces[2, :, at.g] += c.pull_rate * c.spring
    forces[2, :, at.q] = spread(both, np.diag(rotor.centrifugal))
    if rotor.rooted is not None:
        forces[5, :, at.u] = -spread(both, np.diag(rotor.rooted))
        forces[6, :, at.q] = turn @ spread(both, np.diag(rotor.rooted))
    acceleration = solve(mass, forces)
    result = np.zeros((parts, at.size, at.size), mass.dtype)
    result[:, at.u], result[:, at.v] = acceleration, -c.drive @ acceleration
    result[0, at.q, at.u] += np.eye(2 * n, dtype=int)
    result[0, at.g, at.v] += c.feed
    result[0, at.v, at.v] -= np.diag(c.drag)
    if c.spring is not None:
        result[2, at.v, at.g] -= np.diag(c.spring)
    if c.drag.size:
        result[1, at.q, at.q] -= turn
        result[1, at.u, at.u] -= turn
    else:  # in fixed axes, where beta stays 0
        result[0] += result[3]
        result[3:5] = 0.0
        if rotor.by_speed is not None:
            result[1] += result[parts - 2]
            result[parts - 2 :] = 0.0
    return result


def _add_supports(
    forces: Numbers, rotor: RotorParts, at: Blocks, *, power: int, halves: int
) -> None:
    """Stiffness and damping among the forces by a power of the speed; their halves by the
    conjugate stand in two parts from `halves` on."""
    both = np.eye(2)
    forces[power, :, at.q] -= spread(both, rotor.stiffness)
    forces[power, :, at.u] -= spread(both, rotor.damping)
    for part, mirror in enumerate(_MIRRORS, start=halves):
        forces[part, :, at.q] -= spread(mirror, rotor.half_stiffness)
        forces[part, :, at.u] -= spread(mirror, rotor.half_damping)
    if rotor.turning is None:
        return
    # with cross terms supports turn what they push by i
    stiffness, half_stiffness, damping, half_damping = rotor.turning
    forces[power, :, at.q] -= spread(TURN, stiffness)
    forces[power, :, at.u] -= spread(TURN, damping)
    for part, mirror in enumerate(_MIRRORS, start=halves):
        forces[part, :, at.q] -= spread(TURN @ mirror, half_stiffness)
        forces[part, :, at.u] -= spread(TURN @ mirror, half_damping)
