"""Natural frequencies, damping and mode shapes of a turning rotor.

Motion q = e^{lambda t}: |lambda| is the natural frequency, -Re/|lambda| the damping ratio, and the
sense in which the shaft's centre runs round its orbit tells forward whirl from backward.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..rotor import LinearRotor
from ..supports import SHAFT
from .growth import Growth, State, eigenpairs_with_errors

_PLANAR = 1e-6  # |whirl| below it is a straight line: rounding of equal x and y frequencies
REAL = 1e-9  # |Im|/|lambda| below it is an overdamped motion, not an oscillation
FREE_RATE = 1e-6  # of the highest natural frequency: a motion that nothing holds
RIGID = 1e-12  # of the largest stiffness, or squared frequency: a motion without stiffness


@dataclass(frozen=True, eq=False)
class Modes:
    """Modes at one speed, by rising frequency; m = 2n (more if some are overdamped).

    Attributes:
        speed: of the rotor [rad/s].
        eigenvalues: (m,) lambda with Im >= 0 [1/s]; of a neutral mode the real part is 0: its
            rounding is no growth.
        shapes: (m, 2, n) complex amplitudes of x and y per station, largest modulus 1:
            x = Re(X e^{lambda t}).
        whirl: (m,) +1 forward circles, -1 backward circles, 0 a straight line, ellipses between.
    """

    speed: float
    eigenvalues: NDArray[np.complex128]
    shapes: NDArray[np.complex128]
    whirl: NDArray[np.float64]

    @property
    def natural_frequencies(self) -> NDArray[np.float64]:
        """|lambda| (m,) [rad/s]."""
        return np.abs(self.eigenvalues)

    @property
    def damping_ratios(self) -> NDArray[np.float64]:
        """-Re lambda/|lambda| (m,): negative when unstable, 0 when neutral."""
        size = np.abs(self.eigenvalues)
        return (0.0 - self.eigenvalues.real) / np.where(size > 0.0, size, 1.0)

    @property
    def states(self) -> tuple[State, ...]:
        """ "stable", "unstable" or, where nothing damps it, "neutral" for each mode."""
        return tuple(Growth(float(rate), 0.0).state for rate in self.eigenvalues.real)

    @property
    def directions(self) -> tuple[str, ...]:
        """ "forward", "backward" or "planar" for each mode."""
        return tuple(
            "planar" if abs(w) < _PLANAR else "forward" if w > 0.0 else "backward"
            for w in self.whirl
        )


@dataclass(frozen=True, eq=False)
class Campbell:
    """Modes followed over the speeds: column k is one and the same mode.

    Attributes:
        speeds: (s,) [rad/s].
        eigenvalues: (s, m) [1/s].
        whirl: (s, m) as in `Modes`.
    """

    speeds: NDArray[np.float64]
    eigenvalues: NDArray[np.complex128]
    whirl: NDArray[np.float64]


def modes(rotor: LinearRotor, speed: float) -> Modes:
    """Modes at a constant speed [rad/s]."""
    values, vectors = _eigenpairs(rotor, speed)
    values = np.where(np.abs(values.imag) <= REAL * np.abs(values), values.real, values)
    if rotor.isotropic:
        # e^{lambda t} of z = x + i y turns; as real motion its conjugate has Im >= 0
        backward = values.imag < 0.0
        values = np.where(backward, values.conj(), values)
        x = np.where(backward[:, None], vectors.conj(), vectors)
        shapes = np.stack([x, np.where(backward, 1j, -1j)[:, None] * x], axis=1)
    else:
        upper = values.imag >= 0.0
        values = values[upper]
        shapes = vectors[upper].reshape(len(values), 2, rotor.stations)
    order = np.lexsort((values.real, np.abs(values)))
    shapes = _normalised(shapes[order])
    values = values[order]
    whirl = np.where(values.imag > 0.0, _whirl(shapes), 0.0)
    return Modes(speed, values, shapes, whirl)


def lowest_natural(rotor: LinearRotor) -> float:
    """Lowest natural frequency at rest [rad/s], rigid motions of a free machine apart; of bearings
    over the speed at the lowest speed of their tables."""
    found = modes(rotor.at_bottom, 0.0).natural_frequencies
    return float(found[found > FREE_RATE * found.max()].min())


def campbell(rotor: LinearRotor, speeds: Sequence[float]) -> Campbell:
    """Modes against speed, each followed from one speed to the next.

    Where two frequencies cross, eigenvalue and shape together tell the modes apart.

    Raises:
        ValueError: no speeds, or a mode is an oscillation at one speed and overdamped at another,
            so that their number changes.
    """
    if not len(speeds):
        raise ValueError("speeds: give at least one [rad/s]")
    steps = [modes(rotor, float(speed)) for speed in speeds]
    if len({len(step.eigenvalues) for step in steps}) > 1:
        raise ValueError(
            "a mode is overdamped at some of these speeds and oscillates at others: "
            "use modes() at each speed"
        )
    tracks = [np.arange(len(steps[0].eigenvalues))]
    for last, now in pairwise(steps):
        tracks.append(_match(last, now)[tracks[-1]])
    return Campbell(
        np.asarray(speeds, float),
        np.array([step.eigenvalues[t] for step, t in zip(steps, tracks, strict=True)]),
        np.array([step.whirl[t] for step, t in zip(steps, tracks, strict=True)]),
    )


def moving(rotor: LinearRotor) -> NDArray[np.intp]:
    """Which of the displacements of `coefficients` can move: all but the locked ones."""
    held = [axis * rotor.stations + station for axis, station in rotor.locked]
    count = rotor.stations * (1 if rotor.isotropic else 2)
    return np.setdiff1d(np.arange(count), held)


def _eigenpairs(rotor: LinearRotor, speed: float) -> tuple[NDArray, NDArray]:
    """Eigenvalues (m,) and displacements of the eigenvectors, (m, dof); m = 2 dof if all move."""
    kept = moving(rotor)
    dof = rotor.stations * (1 if rotor.isotropic else 2)
    both = np.append(kept, kept + dof)
    matrix = rotor.first_order(speed)[np.ix_(both, both)]
    values, vectors, errors = eigenpairs_with_errors(matrix[None])
    damped = np.abs(values[0].real) > errors[0]
    found = np.where(damped, values[0], values[0] - values[0].real)
    shapes = np.zeros((len(found), dof), vectors.dtype)
    shapes[:, kept] = vectors[0, : len(kept)].T
    own = _without_added(rotor, found, speed)
    return found[own], shapes[own]


def _without_added(rotor: LinearRotor, values: NDArray, speed: float) -> NDArray[np.intp]:
    """Which eigenvalues are motions: not the rates -1/tau that the form of rubber adds, and not
    those of what in a shaft of rubber follows it where it does not bend, see `models/rubber.py`."""
    kept = np.arange(len(values))
    for rate in _added_rates(rotor, speed):
        kept = np.delete(kept, np.abs(values[kept] - rate).argmin())
    return kept


def _added_rates(rotor: LinearRotor, speed: float) -> Iterator[complex]:
    axes = range(1 if rotor.isotropic else 2)
    for support in rotor.supports:
        if support.name == SHAFT:
            u = len(support.rows) // 2
            branch = support.stiffness[0, 0, :u, :u]
            rate = support.stiffness[0, 0, u, u] / support.damping[0, 0, u, u]
            rigid = u - int(np.linalg.matrix_rank(branch, tol=RIGID * np.abs(branch).max()))
            yield from (-rate for _ in axes for _ in range(u))
            yield from (-rate + 1j * speed * (1 - 2 * a) for a in axes for _ in range(rigid))
        elif support.rows.shape[0] > support.across > 0:
            for axis in axes:
                u = support.across
                own, fast = (b[axis, axis, u, u] for b in (support.stiffness, support.damping))
                yield -2.0 * own / fast


def _normalised(shapes: NDArray) -> NDArray:
    """Every shape divided by its largest entry."""
    flat = shapes.reshape(len(shapes), -1)
    largest = flat[np.arange(len(flat)), np.abs(flat).argmax(axis=1)]
    return shapes / largest[:, None, None]


def _whirl(shapes: NDArray) -> NDArray[np.float64]:
    """z = (X + i Y)/2 e^{i t} + conj(X - i Y)/2 e^{-i t}: forward share less backward."""
    x, y = shapes[:, 0], shapes[:, 1]
    forward = (np.abs(x + 1j * y) ** 2).sum(axis=1)
    backward = (np.abs(x - 1j * y) ** 2).sum(axis=1)
    return (forward - backward) / (forward + backward)


def _match(last: Modes, now: Modes) -> NDArray[np.intp]:
    """Index in `now` of every mode of `last`: nearest eigenvalue, least change of shape."""
    from scipy.optimize import linear_sum_assignment  # a third of what a run would load

    a = last.shapes.reshape(len(last.shapes), -1)
    b = now.shapes.reshape(len(now.shapes), -1)
    a = a / np.linalg.norm(a, axis=1)[:, None]
    b = b / np.linalg.norm(b, axis=1)[:, None]
    size = np.abs(last.eigenvalues).max()
    apart = np.abs(last.eigenvalues[:, None] - now.eigenvalues) / (size or 1.0)
    cost = apart + (1.0 - np.abs(a.conj() @ b.T) ** 2)
    return linear_sum_assignment(cost)[1]
