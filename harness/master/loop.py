"""The algebraic loop force <-> acceleration: consistent start values, loop gain, quasi-Newton.

A map G takes forces (value and slope of each connection) to the forces that the balancers answer
with; a consistent start and every implicit step solve u = G(u).  A vector u has of each connection
the force, and its slope times the step; matrices have real and imaginary parts of these alternate.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ..errors import SimulationError
from .limits import (
    LOOP_SINGULAR,
    SLOW_CONVERGENCE,
    START_ITERATIONS,
    START_ROUNDING,
    START_TOLERANCE,
)
from .signals import Knots, cubics_from_start
from .system import System

Vector = NDArray[np.complex128]


def pack(ends: Knots, step: float) -> Vector:
    """Forces and slopes as one vector."""
    return np.asarray((ends * _value_and_slope(step)).ravel())


def unpack(vector: Vector, step: float) -> Knots:
    """Inverse of `pack`."""
    return vector.reshape(-1, 2) * _value_and_slope(1.0 / step)


@lru_cache(maxsize=64)
def _value_and_slope(factor: float) -> NDArray[np.float64]:
    """Factors of the two: every pass of every step has the same."""
    return np.array([1.0, factor])


def size(vector: Vector) -> float:
    """Largest modulus."""
    return max(map(abs, vector.tolist()), default=0.0)


def jacobian(
    g: Callable[[Vector], Vector], u: Vector, g_u: Vector, change: float | NDArray[np.float64]
) -> NDArray[np.float64]:
    """dG/du by one-sided differences of size `change`; exact for the affine maps met here."""
    moves = (np.eye(2 * len(u)) * np.reshape(change, (-1, 1))).view(complex)
    return np.array([(g(u + move) - g_u).view(float) for move in moves]).T / change


class QuasiNewton:
    """Solves u = G(u) with a kept inverse of 1 - dG/du, improved by Broyden's good update.

    Converges unless the loop has an eigenvalue 1, where fixed-point iteration needs a gain below 1.

    Args:
        jacobian: dG/du in the units of `pack` with `step` [s].

    Attributes:
        gain: of the loop at first.

    Raises:
        SimulationError: an eigenvalue is 1, so that u = G(u) has no unique solution.
    """

    def __init__(self, jacobian: NDArray[np.float64], step: float) -> None:
        self.step = step
        try:
            self.inverse = np.linalg.inv(np.eye(len(jacobian)) - jacobian)
            eigenvalues = value_eigenvalues(jacobian)
            unique = all(abs(1.0 - j) >= LOOP_SINGULAR for j in eigenvalues)
        except np.linalg.LinAlgError:  # values so far from 1 that they leave no digit of it
            unique = False
        if not unique:
            raise SimulationError(
                "the loop between force and acceleration has gain 1: every force answers itself, "
                "and there is no unique solution"
            )
        self.gain = max(map(abs, eigenvalues), default=0.0)

    def rescale(self, step: float) -> None:
        """Adapt to another step [s]: slopes enter as slope times step."""
        if step != self.step:
            self.inverse, self.step = rescaled(self.inverse, step / self.step), step

    def correction(self, residual: Vector) -> Vector:
        """The change of u that would make the residual G(u) - u vanish."""
        return np.asarray(self.inverse.dot(residual.view(float)).view(complex))

    def learn(self, du: Vector, old: Vector, new: Vector) -> None:
        """Use how the residual changed over a change du (Broyden 1965, Sherman-Morrison)."""
        moved = du.view(float)
        with np.errstate(over="ignore", invalid="ignore"):  # motion beyond bounds teaches nothing
            expected = self.inverse @ (old - new).view(float)
            weight = moved @ expected
        if weight != 0.0 and np.isfinite(weight):
            self.inverse = self.inverse + np.outer(
                (moved - expected) / weight, moved @ self.inverse
            )


def rescaled(matrix: np.ndarray, ratio: float) -> np.ndarray:
    """A matrix between vectors as `pack` makes them, for steps `ratio` times as long."""
    rows, columns = (np.arange(n) // 2 % 2 for n in matrix.shape)
    return np.asarray(matrix * ratio ** np.subtract.outer(rows, columns))


def consistent_start(
    system: System,
    step: float,
    rounding: float = 0.0,
    change: float | NDArray[np.float64] | None = None,
    agreement: float = START_TOLERANCE,
) -> NDArray[np.float64]:
    """Bring forces and accelerations of units in initialisation mode into agreement.

    Args:
        step: communication step to come [s].
        rounding: of the forces [N]: where they cancel, nothing larger can be made of them.
        change: of forces, for the slopes; by default their size.
        agreement: that is asked for, of the largest force.

    Returns:
        dG/du at the start, (4 c, 4 c) for c connections, whose spectral radius is the loop gain;
        and d(acceleration)/du below it, (4 p, 4 c) for p planes.

    Raises:
        SimulationError: the iteration did not converge, or the loop has gain 1.
    """
    if not system.coupled:
        return np.zeros((0, 0))

    def respond(u: Vector) -> Vector:
        motion = system.rotor_answer(cubics_from_start(unpack(u, step)))
        answers = system.balancer_answer(cubics_from_start(motion))
        return pack(np.concatenate((answers, motion)), step)

    # slopes take squares of the values, but these converge before them
    count = 2 * len(system.forces.now)
    u = np.zeros(count, complex)
    g_u = respond(u)
    if change is None:
        change = size(g_u[:count]) or 1.0
    slopes = jacobian(respond, u, g_u, change)
    g_u, slope_of_g = g_u[:count], slopes[: 2 * count]
    if not np.isfinite(slope_of_g).all():
        raise SimulationError("start values: the forces of the balancers are not finite at t = 0 s")
    newton = QuasiNewton(slope_of_g, step)
    residual = g_u - u
    tolerance = max(agreement, START_ROUNDING * newton.gain)
    for _ in range(START_ITERATIONS):
        du, before = newton.correction(residual), residual
        u = u + du
        g_u = respond(u)[:count]
        residual = g_u - u
        if size(residual) > SLOW_CONVERGENCE * size(before):  # a weight sticks that has slid
            newton.learn(du, before, residual)
        if size(residual) <= max(tolerance * max(size(u), size(g_u)), rounding):
            break
    else:
        raise SimulationError(
            f"consistent start values were not found in {START_ITERATIONS} iterations: forces "
            f"still change by {size(residual):.3g} N of {size(u):.3g} N; loop gain "
            f"{newton.gain:.3g}"
        )
    system.forces.now = unpack(g_u, step)
    system.drop_past()
    return slopes


def of_values(jacobian: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which rows and columns are of values."""
    return np.arange(len(jacobian)) % 4 < 2


def value_eigenvalues(jacobian: NDArray[np.float64]) -> list[complex]:
    """Eigenvalues of the loop of values, 2 c of them; slopes answer slopes with the same ones.

    As double eigenvalues of the whole they would have half the digits.  The largest modulus is the
    loop gain, which explicit schemes need below 1.
    """
    values = of_values(jacobian)
    return list(np.linalg.eigvals(jacobian[np.ix_(values, values)]).tolist())
