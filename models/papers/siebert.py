"""Influence coefficients from amplitudes without phases: Siebert's construction.

An initial run reads |A|; a trial unbalance U makes the reading |A + K U|.  On paper it is a circle
of that radius about the tip of A; three trial runs at different angles give circles that meet in
one point.  Here the phase of A is set to 0 and K is found by least squares over all runs, which
also says how far the circles miss each other.  Trial unbalances along one line leave the mirror
image of K as a second solution, and no run tells the two apart.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from ..arrays import Array, Complex

FEWEST_TRIALS = 3  # of each plane
_DIRECTIONS = 72  # of a circle, from which minima are searched for
_ALIKE = 1e-4  # of |K|: two minima are one
_COLLINEAR = 0.02  # of the largest change: how far a third trial must lie off a line through 0


@dataclass(frozen=True, eq=False)
class FromAmplitudes:
    """Coefficients found without phases.

    Attributes:
        responses: (s,) amplitudes of the initial run, smoothed by all runs; their phases are 0.
        coefficients: (s, p) K, their phases relative to those of `responses`.
        left: (r, s) what the fit leaves of the readings.
        second: (s, p) rms that the second best K leaves of the trial runs of a plane; infinite
            where there is no other.
    """

    responses: Array
    coefficients: Complex
    left: Array
    second: Array


def from_amplitudes(amplitudes: NDArray, mounted: NDArray) -> FromAmplitudes:
    """Fit K (s, p) to the amplitudes of an initial run and at least three trial runs per plane.

    Phases between sensors are not needed: each sensor counts its own phase from its initial
    vibration, and the sum of squares that corrections make least does not depend on it.

    Args:
        amplitudes: (r, s) of every run, the first one is the initial run.
        mounted: (r, p) complex unbalances.

    Raises:
        ValueError: a plane has too few trial runs of its own, or all at one line.
    """
    amplitudes = np.asarray(amplitudes, float)
    changes = np.asarray(mounted, complex)[1:] - mounted[0]
    alone = [_own_runs(changes, plane) for plane in range(changes.shape[1])]
    sensors = range(amplitudes.shape[1])
    solved = [_of_sensor(amplitudes[:, s], changes, alone) for s in sensors]
    responses, coefficients, left, second = map(np.array, zip(*solved, strict=True))
    return FromAmplitudes(responses, coefficients, left.T, second)


def _own_runs(changes: Complex, plane: int) -> NDArray[np.int_]:
    """Trial runs in which only this plane differs from the initial run."""
    others = np.delete(changes, plane, axis=1)
    own = np.flatnonzero((changes[:, plane] != 0.0) & (others == 0.0).all(axis=1))
    if len(own) < FEWEST_TRIALS:
        raise ValueError(
            f"without phases, plane {plane + 1} needs {FEWEST_TRIALS} trial runs in which only its "
            f"mass differs from the initial run; it has {len(own)}"
        )
    trials = changes[own, plane] / np.abs(changes[own, plane]).max()
    cross = np.abs((trials[:, None] * trials[None].conj()).imag)
    if cross.max() < _COLLINEAR:
        raise ValueError(
            f"without phases, the trial masses of plane {plane + 1} lie on one line through the "
            "axis: the correction and its mirror image fit alike; mount one at another angle"
        )
    return own


def _of_sensor(
    readings: Array, changes: Complex, alone: list[NDArray[np.int_]]
) -> tuple[float, Complex, Array, Array]:
    """Initial amplitude, K (p,), what is left (r,), and the rms of the second best (p,)."""
    initial, scale = float(readings[0]), float(readings.max()) or 1.0
    sizes = np.abs(changes).max(axis=0)
    found = [
        _one_plane(initial / scale, readings[1:][own] / scale, changes[own, p] / sizes[p])
        for p, own in enumerate(alone)
    ]
    scaled = np.vstack([np.zeros(len(sizes)), changes / sizes])

    def left(v: Array) -> Array:
        k = v[1 : 1 + len(sizes)] + 1j * v[1 + len(sizes) :]
        return np.abs(v[0] + scaled @ k) - readings / scale

    first = np.array([minima[0][1] for minima in found])
    start = np.concatenate([[initial / scale], first.real, first.imag])
    v = least_squares(left, start, xtol=1e-14, ftol=1e-14, gtol=1e-14).x
    k = v[1 : 1 + len(sizes)] + 1j * v[1 + len(sizes) :]
    turn = math.copysign(1.0, v[0])  # a negative amplitude is one that points the other way
    second = np.array([minima[1][0] if len(minima) > 1 else np.inf for minima in found])
    return scale * abs(v[0]), turn * scale * k / sizes, scale * left(v), scale * second


def _one_plane(initial: float, readings: Array, changes: Complex) -> list[tuple[float, complex]]:
    """Minima of the misses of the circles: rms and K, the best first."""

    def left(v: Array) -> Array:
        return np.abs(initial + changes * complex(*v)) - readings

    grid = np.exp(2j * math.pi * np.arange(_DIRECTIONS) / _DIRECTIONS)
    starts = (readings[0] * grid - initial) / changes[0]  # all on the first circle
    costs = [float(np.sum(left(np.array([k.real, k.imag])) ** 2)) for k in starts]
    minima: list[tuple[float, complex]] = []
    for k, cost in enumerate(costs):
        if cost > min(costs[k - 1], costs[(k + 1) % _DIRECTIONS]):
            continue
        end = least_squares(left, [starts[k].real, starts[k].imag], xtol=1e-14, ftol=1e-14)
        value, rms = complex(*end.x), math.sqrt(float(np.mean(end.fun**2)))
        if all(abs(value - other) > _ALIKE * abs(other) for _, other in minima):
            minima.append((rms, value))
    return sorted(minima, key=lambda one: one[0])
