"""Small motions about a steady whirl, and how they grow.

State in the rotor's frame: zeta, D zeta (D = d/dt + i w, real parts first), turns and their rates.
With alpha = D^2 zeta, a = S alpha at a weight, theta that of the whirl and s = w + theta'

    M alpha + (C + C_i - i w G) D zeta + (K - i w C_i) zeta + anisotropy
        = -S^T m R e^{i theta} (i turn'' - 2 s turn' - (theta'' + i s^2) turn),
    turn'' = -d turn' - (Im(a e^{-i theta}) - Re(a_whirl e^{-i theta}) turn)/(kappa R).

About a whirl that stands still in the rotor the coefficients are constant and eigenvalues decide;
else multipliers over half a revolution.

Where a plane of N >= 3 weights rests, as that of an isotropic rotor can, N - 2 turns that change no
moment meet no reaction: multiplier 1 by structure, taken out by coordinates.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..linear.balanced import WeightTable
from ..linear.floquet import NODES, half_turn, half_turn_steps
from ..linear.modes import modes
from .response import series
from .steady import Whirl, unfelt_turns

_TURN = np.array([[0.0, -1.0], [1.0, 0.0]])  # i
_RESTS = 1e-9  # of w^2 kappa R: a plane that is accelerated less drives no weight
_FOLLOWED = 15.0  # times w: faster motions are nothing to weights that the whirl holds


def multipliers(whirl: Whirl) -> NDArray[np.complex128]:
    """Multipliers of one revolution but the neutral ones, largest modulus first."""
    neutral = neutral_turns(whirl)
    n2 = 2 * whirl.assembly.rotor.stations
    kept = np.eye(2 * n2 + 2 * len(whirl.angles))
    if neutral.shape[1]:
        left = np.linalg.svd(neutral)[0][:, neutral.shape[1] :]
        at = slice(2 * n2, 2 * n2 + len(whirl.angles))
        kept = np.hstack([np.delete(kept, np.arange(at.start, at.stop), 1), kept[:, at] @ left])
    w = whirl.speed
    if len(whirl.theta) == 2:  # constant
        rates = np.linalg.eigvals(kept.T @ coefficients(whirl, np.zeros(1))[0] @ kept)
        values = np.exp(rates * 2.0 * math.pi / w)
    else:
        steps = _steps(whirl)
        at = np.pi / steps * (np.arange(steps)[:, None] + NODES).ravel()
        matrices = kept.T @ coefficients(whirl, at) @ kept / w
        nodes = matrices.reshape(steps, 1, len(NODES), *matrices.shape[1:])
        values = np.linalg.eigvals(half_turn(nodes.__getitem__, steps)[0]) ** 2
    return values[np.argsort(-np.abs(values), kind="stable")].astype(complex)


def growth_rate(whirl: Whirl) -> float:
    """Largest growth rate [1/s] of a small deviation, neutral turns apart; negative means stable.

    Natural frequencies beyond `_FOLLOWED` w are damped away by collocation; their growth is that
    of the rotor alone with the weights fixed to it.
    """
    largest = max(float(np.abs(multipliers(whirl)[0])), np.finfo(float).tiny)
    growth = math.log(largest) * whirl.speed / (2.0 * math.pi)
    own = modes(whirl.assembly.loaded_rotor, whirl.speed)
    fast = own.natural_frequencies > _FOLLOWED * whirl.speed
    return max(growth, float(own.eigenvalues.real[fast].max(initial=-math.inf)))


def neutral_turns(whirl: Whirl) -> Array:
    """Turns (K, m) of the weights that change nothing, orthonormal; those held where they drift."""
    if whirl.family.shape[1]:
        return whirl.family
    table = WeightTable.of(whirl.assembly)
    resting = np.abs(whirl.acceleration).max(axis=0) <= _RESTS * table.kappa_radius * whirl.speed**2
    rows = whirl.assembly.rotor.planes[table.plane]
    return unfelt_turns(table, rows, whirl.angles, resting)


def coefficients(whirl: Whirl, beta: Array) -> Array:
    """A of x' = A x at angles (b,) of the rotor, (b, d, d), d = 4 n + 2 K [1/s]."""
    rotor, table, w = whirl.assembly.loaded_rotor, WeightTable.of(whirl.assembly), whirl.speed
    n, count, b = rotor.stations, len(table.angle), len(beta)
    theta, rate, change = whirl.weights_at(beta)
    unit = np.exp(1j * theta)
    rows = rotor.planes[table.plane]
    across = _real_rows(np.conj(unit)[:, :, None] * rows)  # Im(a e^{-i theta}) by alpha
    pull = np.swapaxes(across, 1, 2) * table.moment  # of S^T m R i e^{i theta}
    spin = w + rate
    turned = table.moment * unit * (change + 1j * spin**2)  # by the turn
    slid = table.moment * unit * (2.0 * spin)  # by its rate
    q, u = slice(0, 2 * n), slice(2 * n, 4 * n)
    g, v = slice(4 * n, 4 * n + count), slice(4 * n + count, 4 * n + 2 * count)
    force = np.zeros((b, 2 * n + count, 4 * n + 2 * count))
    force[:, : 2 * n, q], force[:, : 2 * n, u] = _supports(whirl, beta)
    force[:, : 2 * n, g] = _columns(turned, rows)
    force[:, : 2 * n, v] = _columns(slid, rows)
    along = (_acceleration(whirl, beta) * np.conj(unit)).real / table.kappa_radius
    here = np.arange(count)
    force[:, 2 * n + here, 4 * n + here] = along
    force[:, 2 * n + here, 4 * n + count + here] = -table.damping_rate
    inertia = np.zeros((b, 2 * n + count, 2 * n + count))
    inertia[:, : 2 * n, : 2 * n] = np.kron(np.eye(2), rotor.mass)
    inertia[:, : 2 * n, 2 * n :] = pull
    inertia[:, 2 * n :, : 2 * n] = across / table.kappa_radius[:, None]
    inertia[:, 2 * n + here, 2 * n + here] = 1.0
    solved = np.linalg.solve(inertia, force)
    result = np.zeros((b, 4 * n + 2 * count, 4 * n + 2 * count))
    result[:, q, u] = np.eye(2 * n)
    result[:, g, v] = np.eye(count)
    result[:, u], result[:, v] = solved[:, : 2 * n], solved[:, 2 * n :]
    turning = np.kron(_TURN, np.eye(n)) * w
    result[:, q, q] -= turning
    result[:, u, u] -= turning
    return result


def _real_rows(rows: NDArray) -> Array:
    """Im(row z) as real rows (.., 2n) of z with its real parts first."""
    return np.concatenate([rows.imag, rows.real], axis=-1)


def _columns(values: NDArray, rows: Array) -> Array:
    """Sum over the stations of S^T value as real columns, (b, 2n, K), from values (b, K)."""
    spread = np.einsum("bk,kn->bnk", values, rows)
    return np.concatenate([spread.real, spread.imag], axis=1)


def _supports(whirl: Whirl, beta: Array) -> tuple[Array, Array]:
    """Force of supports, shaft and gyroscopes by zeta and D zeta, rotor's frame, (b, 2n, 2n)."""
    rotor = whirl.assembly.loaded_rotor
    n = rotor.stations
    _, damping, stiffness = rotor.real_coefficients(whirl.speed)
    cos, sin = np.cos(beta), np.sin(beta)
    turn = np.array([[cos, -sin], [sin, cos]]).transpose(2, 0, 1)
    turn = np.einsum("bij,kl->bikjl", turn, np.eye(n)).reshape(len(beta), 2 * n, 2 * n)
    back = np.swapaxes(turn, 1, 2)
    return -back @ stiffness @ turn, -back @ damping @ turn


def _acceleration(whirl: Whirl, beta: Array) -> NDArray[np.complex128]:
    """Of the centres of the weights' tracks, rotor's frame (b, K) [m/s^2]."""
    return series(np.fft.fft(whirl.acceleration, axis=0, norm="forward"), beta)


def _steps(whirl: Whirl) -> int:
    """Steps over half a revolution: they follow the fastest motion, or as fast as `_FOLLOWED`."""
    fastest = float(modes(whirl.assembly.loaded_rotor, whirl.speed).natural_frequencies.max())
    radians = math.pi * (1.0 + min(_FOLLOWED, fastest / whirl.speed))
    return max(int(half_turn_steps(np.array(radians))), len(whirl.theta))
