"""Small motions about the main motion, x' = A(t) x, in the frame of the rotor; see `small_motions`.

Turns of the weights that leave S^T ds unchanged are neutral: the turned weights are at rest again,
so their multiplier is exactly 1.  They are taken out by coordinates, not recognised afterwards: the
state holds only the part of the turns that S^T ds sees, and of the rates only what feeds it.
The rates left over, of weights of equal drag rate d, decay freely as e^{-d t}.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..assembly import Assembly
from ..rotor import LinearRotor
from .balanced import balanced_angles
from .small_motions import TURN, Blocks, Couplings, Matrix, RotorParts, small_motions, spread
from .weight_table import WeightTable

POWERS = np.array([0.0, 1.0, 2.0, 0.5, 1.5])  # of the speed, by which `steady` is multiplied
_RANK = 1e-12  # such a direction couples to the rotor with the square of this


@dataclass(frozen=True, eq=False)
class Linearised:
    """A(w, beta) = sum_k w^k steady[k] + cosine cos 2 beta + sine sin 2 beta.

    Attributes:
        steady: (3, d, d) coefficients of 1, w, w^2; (5, d, d) with those of w^0.5, w^1.5 where
            waves are damped by viscosity.
        cosine, sine: (d, d) parts due to anisotropy.
        turning: (d, d) what w must be multiplied by and added to undo the turning of the frame.
        constant: True when they vanish, so that eigenvalues decide.
        neutral: number of turns of weights that change no moment: multiplier exactly 1 each.
        free_decay: (f,) drag rates d of the free rates: multiplier e^{-d T} each [1/s].
        fastest: estimate of the highest natural frequency [rad/s].
        angles: (K,) of the weights in the main motion [rad].
        wave: speed of the fastest free wave of a ring of liquid, over that of the rotor; 0: none.
    """

    steady: Matrix
    cosine: Matrix
    sine: Matrix
    turning: Matrix
    constant: bool
    neutral: int
    free_decay: NDArray[np.float64]
    fastest: float
    angles: NDArray[np.float64]
    wave: float = 0.0

    @property
    def size(self) -> int:
        """Order d of the system without neutral and freely decaying directions."""
        return int(self.steady.shape[1])

    def at_speed(self, speed: float) -> Matrix:
        """A without anisotropy (d, d) [1/s], at a speed [rad/s]."""
        return np.einsum("k,kij->ij", speed ** POWERS[: len(self.steady)], self.steady)


def _row_space(matrix: Matrix) -> Matrix:
    """Orthonormal basis (columns) of the row space."""
    _, values, rows = np.linalg.svd(matrix, full_matrices=False)
    rank = int((values > _RANK * values.max(initial=0.0)).sum())
    return rows[:rank].T


def _couplings(assembly: Assembly, table: WeightTable, angles: NDArray) -> Couplings:
    """Split the weights' turns and rates, group by group of equal drag rate."""
    planes = assembly.loaded_rotor.planes[table.plane]  # (K, n)
    tangent = np.hstack(
        [-np.sin(angles)[:, None] * planes, np.cos(angles)[:, None] * planes]
    )  # (K, 2n): along-track part of a unit acceleration; transposed, of a unit moment
    reach = np.linalg.norm(planes, axis=1)
    reach[reach == 0.0] = 1.0
    # turns are counted as moments, so that light and heavy weights have columns of equal length
    column = (tangent / reach[:, None]).T
    turns = _row_space(column)
    # the first of each is what a rotor without weights has
    bases, drives = [np.zeros((len(angles), 0))], [np.zeros((0, tangent.shape[1]))]
    drags, decays = [np.zeros(0)], [np.zeros(0)]
    for rate in np.unique(table.damping_rate):
        group = np.flatnonzero(table.damping_rate == rate)
        inside = _row_space(column[:, group])
        basis = np.zeros((len(angles), inside.shape[1]))
        basis[group] = inside
        bases.append(basis)
        drags.append(np.full(inside.shape[1], rate))
        decays.append(np.full(len(group) - inside.shape[1], rate))
        weight = table.moment[group] * reach[group] / table.kappa_radius[group]
        drives.append(inside.T @ (weight[:, None] * tangent[group]))
    rates = np.hstack(bases)
    return Couplings(
        pull_turn=column @ turns,
        pull_rate=column @ rates,
        feed=turns.T @ rates,
        drag=np.concatenate(drags),
        drive=np.vstack(drives),
        neutral=len(angles) - turns.shape[1],
        free_decay=np.concatenate(decays),
    )


def fastest_rate(rotor: LinearRotor, mass: Matrix) -> float:
    """Estimate of the highest natural frequency [rad/s] for the real (2n, 2n) mass matrix."""
    _, _, stiffness = rotor.real_coefficients(0.0)
    return float(np.sqrt(np.abs(np.linalg.eigvals(np.linalg.solve(mass, stiffness))).max()))


def linearise_at(assembly: Assembly, speeds: NDArray) -> tuple[list[Linearised], NDArray[np.int_]]:
    """Systems of one size and kind, and which of them (b,) belongs to each speed (b,) [rad/s].

    It is one system, unless bearings change with the speed.

    Raises:
        CannotBalance: the weights cannot undo the unbalance.
        ValueError: a table of a bearing does not hold a speed.
    """
    if not assembly.rotor.varies:
        return [linearise(assembly)], np.zeros(len(speeds), int)
    each, which = np.unique(speeds, return_inverse=True)
    systems = [linearise(assembly.at_speed(float(speed))) for speed in each]
    if len({system.constant for system in systems}) > 1:  # round bearings in some rows of a table
        systems = [replace(system, constant=False) for system in systems]
    return systems, which.reshape(-1)


def system_of(rotor: LinearRotor, c: Couplings, angles: NDArray[np.float64]) -> Linearised:
    """The system of a loaded rotor and weights at `angles` (K,) [rad] in these coordinates."""
    mass = spread(np.eye(2), rotor.mass) - c.pull_rate @ c.drive
    found = small_motions(RotorParts.of(rotor), mass, c)
    steady, (cosine, sine) = np.concatenate([found[:3], found[5:]]), found[3:5]
    turning, at = np.zeros_like(cosine), Blocks.of(c)
    if c.drag.size:
        turning[at.q, at.q] = turning[at.u, at.u] = spread(TURN, np.eye(rotor.stations))
    return Linearised(
        steady=steady,
        cosine=cosine,
        sine=sine,
        turning=turning,
        constant=not (cosine.any() or sine.any()),
        neutral=c.neutral,
        free_decay=c.free_decay,
        fastest=fastest_rate(rotor, mass),
        angles=angles,
        wave=max([0.0, *(ring.wave_speeds[1] for _, ring in rotor.waves)]),
    )


def linearise(assembly: Assembly) -> Linearised:
    """The system about the main motion of any assembly.

    Without weights the frame is fixed instead, where every rotor has constant coefficients; the
    main motion is then the steady whirl, and a linear rotor is disturbed alike about any motion.

    Raises:
        CannotBalance: the weights cannot undo the unbalance.
    """
    rotor = assembly.loaded_rotor
    rotor.refuse_sliders("linear stability")
    angles = balanced_angles(assembly)
    return system_of(rotor, _couplings(assembly, WeightTable.of(assembly), angles), angles)
