"""The algebraic loop force <-> acceleration: consistent start values, loop gain, quasi-Newton.

A map G takes forces (value and slope of each connection) to the forces that the balancers answer
with; a consistent start and every implicit step solve u = G(u).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ...models.constants import (
    LOOP_SINGULAR,
    SLOW,
    START_ITERATIONS,
    START_ROUNDING,
    START_TOLERANCE,
)
from ..errors import SimulationError
from .signals import Knot, begun
from .system import System

Vector = list[complex]  # of each connection the force, and its slope times the step


def pack(ends: Sequence[Knot], step: float) -> Vector:
    """Forces and slopes as one vector."""
    return [part for value, slope in ends for part in (value, step * slope)]


def unpack(vector: Sequence[complex], step: float) -> list[Knot]:
    """Inverse of `pack`."""
    per_step = 1.0 / step
    return [(vector[i], per_step * vector[i + 1]) for i in range(0, len(vector), 2)]


def size(vector: Sequence[complex]) -> float:
    """Largest modulus."""
    return max(map(abs, vector), default=0.0)


def difference(a: Sequence[complex], b: Sequence[complex]) -> Vector:
    """a - b."""
    return [x - y for x, y in zip(a, b, strict=True)]


def components(vector: Sequence[complex]) -> np.ndarray:
    """Real and imaginary parts, alternating."""
    return np.array(vector, complex).view(float)


def jacobian(g: Callable[[Vector], Vector], u: Vector, g_u: Vector, change: float) -> np.ndarray:
    """dG/du by one-sided differences of size `change`; exact for the affine maps met here.

    Real and imaginary parts alternate in rows and columns.
    """
    columns = []
    for i in range(len(u)):
        for moved_by in (change, 1j * change):
            moved = list(u)
            moved[i] += moved_by
            columns.append(components(difference(g(moved), g_u)))
    return np.array(columns).T / change


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

    def __init__(self, jacobian: np.ndarray, step: float) -> None:
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
        return self.inverse.dot(components(residual)).view(complex).tolist()

    def learn(self, du: Vector, old: Vector, new: Vector) -> None:
        """Use how the residual changed over a change du (Broyden 1965, Sherman-Morrison)."""
        moved = components(du)
        with np.errstate(over="ignore", invalid="ignore"):  # motion beyond bounds teaches nothing
            expected = self.inverse @ components(difference(old, new))
            weight = moved @ expected
        if weight != 0.0 and np.isfinite(weight):
            self.inverse = self.inverse + np.outer(
                (moved - expected) / weight, moved @ self.inverse
            )


def rescaled(matrix: np.ndarray, ratio: float) -> np.ndarray:
    """A matrix between vectors as `pack` makes them, for steps `ratio` times as long."""
    rows, columns = (np.arange(n) // 2 % 2 for n in matrix.shape)
    return matrix * ratio ** np.subtract.outer(rows, columns)


def rotor_response(system: System, step: float) -> np.ndarray:
    """d(acceleration)/d(force) of a rotor in initialisation mode, (4 p, 4 c).

    For p planes and c connections; leaves the rotor without forces.
    """
    if not system.exchanges:
        return np.zeros((0, 0))

    def respond(u: Vector) -> Vector:
        system.set_forces([begun(end) for end in unpack(u, step)])
        return pack(system.read_accelerations(), step)

    nothing = [0j] * (2 * len(system.exchanges))
    found = jacobian(respond, nothing, respond(nothing), 1.0)
    respond(nothing)
    return found


def consistent_start(system: System, step: float, rounding: float = 0.0) -> np.ndarray:
    """Bring forces and accelerations of units in initialisation mode into agreement.

    Args:
        step: communication step to come [s].
        rounding: of the forces [N]: where they cancel, nothing larger can be made of them.

    Returns:
        dG/du at the start, (4 c, 4 c) for c connections; its spectral radius is the loop gain.

    Raises:
        SimulationError: the iteration did not converge, or the loop has gain 1.
    """
    if not system.coupled:
        return np.zeros((0, 0))

    def respond(u: Vector) -> Vector:
        system.set_forces([begun(end) for end in unpack(u, step)])
        for state, knot in zip(system.accelerations, system.read_accelerations(), strict=True):
            state.now = knot
        return pack(system.answer([begun(a.now) for a in system.accelerations]), step)

    # slopes take squares of the values, but these converge before them
    u = [0j] * (2 * len(system.forces))
    g_u = respond(u)
    slope_of_g = jacobian(respond, u, g_u, size(g_u) or 1.0)
    if not np.isfinite(slope_of_g).all():
        raise SimulationError("start values: the forces of the balancers are not finite at t = 0 s")
    newton = QuasiNewton(slope_of_g, step)
    residual = difference(g_u, u)
    tolerance = max(START_TOLERANCE, START_ROUNDING * newton.gain)
    for _ in range(START_ITERATIONS):
        du, before = newton.correction(residual), residual
        u = [a + b for a, b in zip(u, du, strict=True)]
        g_u = respond(u)
        residual = difference(g_u, u)
        if size(residual) > SLOW * size(before):  # a weight sticks where the one before has slid
            newton.learn(du, before, residual)
        if size(residual) <= max(tolerance * max(size(u), size(g_u)), rounding):
            break
    else:
        raise SimulationError(
            f"consistent start values were not found in {START_ITERATIONS} iterations: forces "
            f"still change by {size(residual):.3g} N of {size(u):.3g} N; loop gain "
            f"{newton.gain:.3g}"
        )
    for force, knot in zip(system.forces, unpack(g_u, step), strict=True):
        force.now = knot
    system.drop_past()
    return slope_of_g


def of_values(jacobian: np.ndarray) -> np.ndarray:
    """Which rows and columns are of values."""
    return np.arange(len(jacobian)) % 4 < 2


def value_eigenvalues(jacobian: np.ndarray) -> list[complex]:
    """Eigenvalues of the loop of values, 2 c of them; slopes answer slopes with the same ones.

    As double eigenvalues of the whole they would have half the digits.  The largest modulus is the
    loop gain, which explicit schemes need below 1.
    """
    values = of_values(jacobian)
    return np.linalg.eigvals(jacobian[np.ix_(values, values)]).tolist()
