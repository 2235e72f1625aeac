"""Growth about balance by derivatives of the reference's equations, taken over one period.

The balanced motion is known: the rotor is at rest, and the weights turn with it.  So derivatives
of the equations in one piece are needed there alone, at a few angles: differences of fourth order.
Between these angles they are Fourier series.  The map over one period is a product of Magnus steps
of fourth order (Blanes, Casas, Oteo & Ros 2009, (253)), doubled in number until growth stays.
Of `models.linear` only the angles of the weights and the number of neutral turns are used.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eig

from autobalancer.models.assembly import Assembly, SpeedProfile
from autobalancer.models.linear.linearised import linearise
from autobalancer.models.reference.coupled import Monolith

Array = NDArray[np.float64]
ANGLES = 64  # of the rotor, at which derivatives are taken
STEP = 1e-3  # of a state's scale
TAIL = 1e-7  # of the derivatives' harmonics: how small the highest ones must be
REST = 1e-9  # of the speed: how fast the balanced motion may change
FEWEST, MOST = 64, 2**16  # steps of a period
AGREES = 1e-9  # of growth over a period: what twice as many steps may change
ROUNDINGS = 100.0  # of the largest number of a map, by which its numbers may err
EPSILON = float(np.finfo(float).eps)
PADE = 6  # order of numerator and denominator
_CHUNK = 1024  # steps at once


def growth_over_a_period(assembly: Assembly, speed: float) -> tuple[float, float]:
    """Largest growth rate [1/s] of what balance is disturbed by, neutral turns apart; its error.

    The error is large where a multiplier is double, as of a free machine: rounding splits it.

    Args:
        assembly: whose weights can balance; matrices at `speed` [rad/s].

    Raises:
        CannotBalance: the weights cannot undo the unbalance.
        ArithmeticError: balance is no motion of the equations, or `MOST` steps are not enough.
    """
    assembly = assembly.at_speed(speed)
    system = linearise(assembly)
    series = _series(_derivatives(Monolith(assembly, SpeedProfile.constant(speed)), system.angles))
    period, steps, before = math.tau / speed, FEWEST, math.inf
    while steps <= MOST:
        growth, error = _largest(_period_map(series, period, steps), system.neutral)
        if abs(growth - before) <= AGREES * max(1.0, abs(growth)) + error:
            return growth / period, (AGREES + error) / period
        steps, before = 2 * steps, growth
    raise ArithmeticError(f"{MOST} steps of a period are not enough")


def _largest(period_map: Array, neutral: int) -> tuple[float, float]:
    """Logarithm of the largest multiplier, but for so many of 1, and its error by rounding."""
    values, left, right = eig(period_map, left=True)
    sizes = np.abs(values)
    others = np.argsort(np.abs(sizes - 1.0))[neutral:]
    at = others[np.argmax(sizes[others])]
    slope = max(float(np.abs(left[:, at].conj() @ right[:, at])), math.sqrt(EPSILON))
    error = ROUNDINGS * EPSILON * float(np.abs(period_map).max()) / slope
    return math.log(sizes[at]), error / float(sizes[at])


def _derivatives(monolith: Monolith, angles: Array) -> Array:
    """Of x' by x (ANGLES, size, size), both over their scales, on the balanced motion."""
    scales, size = monolith.scales(), monolith.size
    n4, count = 4 * monolith.stations, monolith.weights
    turned = np.linspace(0.0, math.tau, ANGLES, endpoint=False)
    speed = monolith.profile.end
    balanced = np.zeros((ANGLES, size))
    balanced[:, n4 : n4 + count] = angles + turned[:, None]
    balanced[:, n4 + count :] = speed

    def slopes(states: Array) -> Array:
        """x' over its scales, of states (k, ANGLES, size)."""
        each = np.broadcast_to(turned[:, None], (*states.shape[:-1], 1))
        turning = each, np.full_like(each, speed), np.zeros_like(each)
        lateral, weights = monolith.accelerations_of(turning, states)
        flat = lateral.reshape(*states.shape[:-1], -1)
        half = n4 // 2
        parts = states[..., half:n4], flat, states[..., n4 + count :], weights
        return np.concatenate(parts, axis=-1) / scales

    drift = slopes(balanced[None])[0]
    drift[:, n4 : n4 + count] -= speed
    if np.abs(drift).max() > REST * speed:
        raise ArithmeticError(f"balance is no motion: it changes by {np.abs(drift).max():.1e} 1/s")
    columns = []
    for k in range(size):
        moves = np.zeros((4, 1, size))
        moves[:, 0, k] = STEP * scales[k] * np.array([1.0, -1.0, 2.0, -2.0])
        up, down, far_up, far_down = slopes(balanced + moves)
        columns.append((8.0 * (up - down) - (far_up - far_down)) / (12.0 * STEP))
    return np.stack(columns, axis=-1)


def _series(values: Array) -> NDArray[np.complex128]:
    """Fourier coefficients (h, size, size) of derivatives at equally spaced angles, h that matter.

    Raises:
        ArithmeticError: the highest ones are not small.
    """
    found = np.fft.rfft(values, axis=0)[:-1] / ANGLES
    found[1:] *= 2.0
    sizes = np.abs(found).max(axis=(1, 2)) / np.abs(found).max()
    if sizes[-4:].max() > TAIL:
        raise ArithmeticError(f"{ANGLES} angles are not enough: {sizes[-4:].max():.1e}")
    return np.asarray(found[: 1 + np.flatnonzero(sizes > EPSILON)[-1]])


def _period_map(series: NDArray[np.complex128], period: float, steps: int) -> Array:
    """Map over a period (size, size) of x' = A(t) x."""
    size, length = series.shape[-1], period / steps
    turns = 1j * math.tau / steps * np.arange(len(series))
    result = np.eye(size)
    for begin in range(0, steps, _CHUNK):
        here = np.arange(begin, min(begin + _CHUNK, steps))
        # no product of matrices: a library would share it among threads, and wait for them
        first, second = (
            np.einsum("th,hij->tij", np.exp(np.outer(here + node, turns)), series).real
            for node in (0.5 - math.sqrt(3.0) / 6.0, 0.5 + math.sqrt(3.0) / 6.0)
        )
        turn = second @ first - first @ second
        maps = _exponentials(
            0.5 * length * (first + second) + math.sqrt(3.0) / 12.0 * length**2 * turn
        )
        for one in maps:
            result = one @ result
    return result


def _exponentials(matrices: Array) -> Array:
    """Of matrices (b, d, d): Pade approximants with scaling and squaring.

    SciPy's share each of their small systems among threads, which takes a hundred times as long on
    a busy machine.
    """
    norm = np.abs(matrices).sum(axis=1).max()
    halvings = max(0, math.ceil(math.log2(max(norm, EPSILON))))
    scaled, one = matrices / 2.0**halvings, np.eye(matrices.shape[-1])
    square, power = scaled @ scaled, one
    even, odd = np.zeros_like(matrices), np.zeros_like(matrices)
    for k in range(PADE // 2 + 1):
        even = even + _pade(2 * k) * power
        odd = odd + (_pade(2 * k + 1) if 2 * k < PADE else 0.0) * power
        power = power @ square
    odd = scaled @ odd
    result = np.linalg.solve(even - odd, even + odd)
    for _ in range(halvings):
        result = result @ result
    return np.asarray(result)


def _pade(power: int) -> float:
    """Coefficient of a power in the numerator of the approximant of order `PADE` of e^x."""
    p, k = math.factorial, power
    return p(2 * PADE - k) * p(PADE) / (p(2 * PADE) * p(k) * p(PADE - k))
