"""Floquet multipliers of x' = A(w, beta) x, many at once.

In the rotor's frame the coefficients repeat every half revolution, so the map over half a turn
decides.  It is the product of steps of Radau IIA collocation with six stages (order 11, L-stable:
drag or damping of any size; Hairer & Wanner 1996, IV.5).  Nodes lie at fixed angles of
the rotor, the same for all speeds with equally many steps: one batched solve a step.

Natural frequencies beyond `MOST_STEPS` are not followed turn by turn.  Collocation damps them away,
and their own growth is taken from the eigenvalues with the rotor's angle frozen: in comparison with
such motions the rotor stands still.  The rotor's frame mixes the axes, so rounding moves the softer
stiffness by 1e-16 of the stiffer one: with a ratio of 1e12 the growth rates keep three digits.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from ..steps.radau import radau
from .linearised import Linearised

STAGES = 6
_RADIANS = 1.25  # of the fastest motion per step: collocation then damps it by 1e-10 a step
_FEWEST = 8  # the harmonics of the anisotropy need them, whatever the natural frequencies
MOST_STEPS = 2048  # resolves natural frequencies up to about 500 w
_FROZEN_ANGLES = 8  # over half a turn, for the motions faster than that
_MODULUS_ROUNDING = 64.0 * np.finfo(float).eps  # of an eigenvalue's modulus
_CHUNK = 256  # points a batch: its matrices stay in the cache


NODES, COEFFICIENTS = radau(STAGES)


def _radians(systems: list[Linearised], which: NDArray, speeds: NDArray) -> NDArray[np.float64]:
    """Turn of the fastest motion in half a revolution (b,)."""
    fastest, wave = np.array([(s.fastest, s.wave) for s in systems]).reshape(-1, 2)[which].T
    return math.pi * (1.0 + np.maximum(fastest / speeds, wave))


def half_turn_steps(radians: NDArray) -> NDArray[np.int_]:
    """Steps per half revolution, rounded up to a ladder with four rungs an octave."""
    wanted = np.clip(radians / _RADIANS, _FEWEST, MOST_STEPS)
    # less a rounding, which must not climb a rung
    rungs = np.ceil(4.0 * np.log2(wanted) - 1e-9)
    return np.minimum(np.ceil(2.0 ** (rungs / 4.0) - 1e-9), MOST_STEPS).astype(int)


def half_turn(
    at_nodes: Callable[[int], NDArray], steps: int, held: tuple[NDArray, NDArray]
) -> NDArray[np.float64]:
    """Map over half a revolution, (b, d, d), of x' = A x by the rotor's angle.

    Args:
        at_nodes: rows of A (b, `STAGES`, s, d) at the nodes of the step of that number, at the
            angles pi (number + `NODES`)/steps.
        steps: how many.
        held: which rows (d,) are the same at every node, and these (b, d - s, d): their stages
            are eliminated, once for all steps.  The others are those of `at_nodes`.
    """
    coefficients = _coefficients(steps)
    rows = at_nodes(0)
    batch, _, _, size = rows.shape
    mask, constant = held
    p, s = np.flatnonzero(mask), np.flatnonzero(~mask)
    # stages of p from p at the begin and the stages of s
    kept = _eliminated(constant[..., p], constant[..., s], steps)
    width = kept.shape[-1]
    right = np.zeros((batch, STAGES, len(s), size))
    right[..., len(p) :] = np.eye(len(s))
    unit = np.eye(STAGES * len(s))
    total = np.broadcast_to(np.eye(size), (batch, size, size))
    for k in range(steps):
        rows = rows if k == 0 else at_nodes(k)
        slopes = rows[..., p] @ kept
        for j in range(STAGES):
            begin = len(p) + j * len(s)
            slopes[:, j, :, begin : begin + len(s)] += rows[:, j][..., s]
        mixed = coefficients @ slopes.reshape(batch, STAGES, len(s) * width)
        mixed = mixed.reshape(batch, STAGES * len(s), width)
        right[..., : len(p)] = mixed[..., : len(p)].reshape(batch, STAGES, len(s), len(p))
        stages = np.linalg.solve(unit - mixed[..., len(p) :], right.reshape(batch, -1, size))
        # the last stage is the end of the step
        end = kept[:, -1, :, len(p) :] @ stages
        end[..., : len(p)] += kept[:, -1, :, : len(p)]
        total = np.concatenate([end, stages[:, (STAGES - 1) * len(s) :]], axis=1) @ total
    back = np.argsort(np.concatenate([p, s]))
    return total[:, back][:, :, back]


def _coefficients(steps: int) -> NDArray[np.float64]:
    """Collocation's coefficients for a step of a half turn of so many."""
    scaled: NDArray = math.pi / steps * COEFFICIENTS
    return scaled


@cache
def _eigenvectors(steps: int) -> tuple[NDArray, NDArray, NDArray]:
    """Eigenvalues of `_coefficients` above the real axis, and the vectors from and to these parts.

    The other eigenvalues are their conjugates.
    """
    values, vectors = np.linalg.eig(_coefficients(steps))
    above = values.imag > 0.0
    return values[above], np.linalg.inv(vectors)[above], 2.0 * vectors[:, above]


def _eliminated(own: NDArray, others: NDArray, steps: int) -> NDArray[np.float64]:
    """Stages (b, `STAGES`, p, p + `STAGES` s) of p' = own p + others s by p and the stages of s.

    In the eigenvectors of the coefficients stages are apart: a few small systems in place of a
    large one, which BLAS would share among threads.  These vectors lose two digits, which a
    residual gives back.
    """
    batch, p, s = others.shape
    width = p + STAGES * s
    coefficients = _coefficients(steps)
    values, inwards, outwards = _eigenvectors(steps)
    inverse = np.linalg.inv(np.eye(p) - values[:, None, None, None] * own)

    def together(apart: NDArray) -> NDArray:
        """Stages (`STAGES`, b, p, width) of their parts by eigenvectors."""
        flat = apart.reshape(len(values), -1)
        found = outwards.real @ flat.real - outwards.imag @ flat.imag
        return found.reshape(STAGES, batch, p, width)

    apart = np.empty((len(values), batch, p, width), complex)
    apart[..., :p] = inwards.sum(axis=1)[:, None, None, None] * inverse
    driven = (values[:, None] * inwards)[:, None, None, :, None] * (inverse @ others)[..., None, :]
    apart[..., p:] = driven.reshape(*apart.shape[:3], STAGES * s)
    stages = together(apart)
    slopes = own @ stages
    for j in range(STAGES):
        slopes[j, :, :, p + j * s : p + (j + 1) * s] += others
    left = (coefficients @ slopes.reshape(STAGES, -1)).reshape(stages.shape) - stages
    left[..., :p] += np.eye(p)
    sides = (inwards @ left.reshape(STAGES, -1)).reshape(apart.shape)
    return np.ascontiguousarray((stages + together(inverse @ sides)).swapaxes(0, 1))


def _harmonics_of(steady: NDArray, speeds: NDArray) -> NDArray:
    """A/w without anisotropy, (b, d, d), from its coefficients (b, 3 or 5, d, d)."""
    w = speeds[:, None, None]
    found: NDArray = steady[:, 0] / w + steady[:, 1] + steady[:, 2] * w
    if steady.shape[1] > 3:
        root = np.sqrt(w)
        found = found + steady[:, 3] / root + steady[:, 4] * root
    return found


def _at_nodes(parts: tuple[NDArray, ...], steps: int, number: int) -> NDArray:
    """Rows of A/w (b, `STAGES`, s, d) at the nodes of a step, from parts (b, s, d) each."""
    steady, cosine, sine = (part[:, None] for part in parts)
    angles = 2.0 * math.pi / steps * (number + NODES)[:, None, None]
    return steady + np.cos(angles) * cosine + np.sin(angles) * sine


def one_turn_multipliers(
    systems: list[Linearised], which: NDArray, speeds: NDArray
) -> NDArray[np.complex128]:
    """Multipliers over one revolution (b, d) of system `which[i]` at `speeds[i]`.

    Args:
        systems: of one size d.
        which: (b,) indices into `systems`.
        speeds: (b,) [rad/s], positive.

    Raises:
        OverflowError: one is so slow that a turn's motion is no finite number.
    """
    found = np.linalg.eigvals(half_turns(systems, which, speeds)[0]) ** 2
    return found.astype(complex)


def half_turns(
    systems: list[Linearised], which: NDArray, speeds: NDArray, finer: int = 1
) -> tuple[NDArray[np.float64], NDArray[np.int_]]:
    """Maps over half a revolution (b, d, d), and the steps (b,) that made them.

    Args:
        systems, which, speeds: as of `one_turn_multipliers`, which says what is raised.
        finer: how many times as many steps as usual.
    """
    steady = np.stack([s.steady for s in systems])
    cosine = np.stack([s.cosine for s in systems])
    sine = np.stack([s.sine for s in systems])
    held = np.asarray(~(cosine.any(axis=(0, 2)) | sine.any(axis=(0, 2))))
    steps = finer * half_turn_steps(_radians(systems, which, speeds))
    result = np.empty((len(speeds), systems[0].size, systems[0].size))
    for count in np.unique(steps):
        members = np.flatnonzero(steps == count)
        for start in range(0, len(members), _CHUNK):
            rows = members[start : start + _CHUNK]
            w, system = speeds[rows], which[rows]
            mean, each = _harmonics_of(steady[system], w), w[:, None, None]
            swings = (part[system][:, ~held] / each for part in (cosine, sine))
            at_nodes = partial(_at_nodes, (mean[:, ~held], *swings), int(count))
            with np.errstate(over="ignore", invalid="ignore"):  # raised below
                turn: NDArray = half_turn(at_nodes, int(count), (held, mean[:, held]))
            finite = np.isfinite(turn).all(axis=(1, 2))
            if not finite.all():
                slowest = speeds[rows][~finite].min()
                raise OverflowError(f"{slowest:g} rad/s: no double holds the motion of one turn")
            result[rows] = turn
    return result, steps


def fast_growth(
    systems: list[Linearised], which: NDArray, speeds: NDArray
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Largest growth rate [1/s] of motions too fast to be followed, and its rounding, (b,) each.

    The rate is -inf where all motions are followed.  It is the mean of each eigenvalue over the
    frozen angles: what a motion gains while the weights swing into its axis it loses when they
    leave.  Eigenvalues of different angles are matched by sorting, by imaginary part and then by
    real part.
    """
    growth, error = np.full(len(speeds), -math.inf), np.zeros(len(speeds))
    for i in np.flatnonzero(_radians(systems, which, speeds) > MOST_STEPS * _RADIANS):
        system, w = systems[which[i]], speeds[i]
        limit = MOST_STEPS * w / math.pi
        angles = 2.0 * math.pi * np.arange(_FROZEN_ANGLES)[:, None, None] / _FROZEN_ANGLES
        frozen = system.at_speed(w) + w * system.turning
        values = np.linalg.eigvals(
            frozen + np.cos(angles) * system.cosine + np.sin(angles) * system.sine
        )
        order = np.lexsort((values.real, values.imag), axis=1)
        means = np.take_along_axis(values, order, axis=1).mean(axis=0)
        fast = means[np.abs(means) > limit]
        rounding = _MODULUS_ROUNDING * np.abs(fast)
        rate = np.where(np.abs(fast.real) > rounding, fast.real, 0.0)
        growth[i] = rate.max(initial=-math.inf)
        error[i] = rounding.max(initial=0.0)
    return growth, error


def exponents(systems: list[Linearised], which: NDArray, speeds: NDArray) -> NDArray[np.complex128]:
    """Eigenvalues (b, d) [1/s] of systems with constant coefficients."""
    result = np.empty((len(speeds), systems[0].size), complex)
    for start in range(0, len(speeds), _CHUNK):
        rows = slice(start, start + _CHUNK)
        result[rows] = np.linalg.eigvals(constant_matrices(systems, which[rows], speeds[rows]))
    return result


def constant_matrices(
    systems: list[Linearised], which: NDArray, speeds: NDArray
) -> NDArray[np.float64]:
    """Matrices A (b, d, d) [1/s] of systems with constant coefficients."""
    steady = np.stack([s.steady for s in systems])[which]
    matrices: NDArray = _harmonics_of(steady, speeds) * speeds[:, None, None]
    return matrices
