"""Critical speeds: speeds at which unbalance excites an undamped mode of a rotor."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh, eigvals, eigvalsh

from ..rotor import LinearRotor, as_real
from ..supports import SHAFT
from .modes import REAL, RIGID, moving

_ABOVE = 1.3  # a range ends this much above the highest speed of interest
_LOWEST = 0.01  # of a range's end: a rotor that stands still has neither whirl nor response
_SCAN = 400  # speeds at which the stiffness is looked at where it changes with the speed
_STIFF = 1e12  # rad/s: rubber is stiffest
_FAR = 3.0  # critical speeds beyond this many operating speeds are of no interest


def critical_speeds(rotor: LinearRotor) -> NDArray[np.float64]:
    """Speeds at which unbalance excites an undamped mode [rad/s], ascending.

    K v = w^2 (M - G) v for an isotropic rotor: forward whirl only, and where the polar inertia
    exceeds the transverse one a mode has none.  Otherwise K v = w^2 (M - i J G) v in both axes,
    where backward whirl is excited too.
    """
    if rotor.varies or rotor.inner:
        return _critical_over_speed(rotor)
    bare = replace(rotor, waves=())
    mass, damping, stiffness = bare.coefficients(0.0)
    _, turning, _ = bare.coefficients(1.0)
    kept = moving(rotor)
    mass, damping, stiffness, turning = (
        each[np.ix_(kept, kept)] for each in (mass, damping, stiffness, turning)
    )
    elastic = stiffness.real if rotor.isotropic else stiffness
    inertial = mass - 1j * (turning - damping)
    for at, ring in rotor.waves:  # K - 2 w^2 m f + i w (-4 i w m f), without damping
        own = np.zeros((rotor.stations, rotor.stations), complex)
        own[at, at] = ring.wave_inertia
        still, swirl = (own, -4j * own) if rotor.isotropic else (as_real(own), as_real(-4j * own))
        inertial = inertial + (2.0 * still - 1j * swirl)[np.ix_(kept, kept)]
    elastic = (elastic + elastic.conj().T) / 2.0  # what cross terms do beyond is like damping
    strength = eigvalsh(elastic)
    if strength[0] <= RIGID * strength[-1]:  # a body that is free
        return _critical_of_free(elastic, inertial)
    # K is positive definite, M - i J G need not be: solve for 1/w^2
    inverse_squares = eigh(inertial, elastic, eigvals_only=True)
    real = inverse_squares[inverse_squares > np.finfo(float).eps * np.abs(inverse_squares).max()]
    return np.sort(1.0 / np.sqrt(real))


def at_frequency(rotor: LinearRotor, speed: float) -> LinearRotor:
    """The rotor as it answers a motion at its own speed [rad/s], without damping.

    Bearings are those of the speed, and rubber is a spring: the real part of its dynamic stiffness.

    Raises:
        ValueError: a table of a bearing does not hold the speed.
    """
    own = rotor.stations - len(rotor.waves)  # waves stand behind rubber
    kept = np.delete(np.arange(rotor.stations), np.s_[own - rotor.inner : own])
    supports = []
    for one in rotor.at(speed).supports:
        rows, k, c = one.rows[:, kept], one.stiffness, np.zeros_like(one.damping)
        if one.rows.shape[0] > one.across > 0:
            d, u = slice(0, one.across), one.across
            rows, k = rows[d], k[:, :, d, d].copy()
            for axis in (0, 1):
                own, at = one.stiffness[axis, axis], axis * (one.across - 1)
                relaxed = one.damping[axis, axis, u, u] / own[u, u] / 2.0
                turned = 1j * speed * relaxed
                k[axis, axis, at, at] += own[at, u] * (1.0 / (1.0 + turned)).real
            c = np.zeros_like(k)
        if one.name != SHAFT:  # which does not bend as it whirls at the rotor's speed
            supports.append(replace(one, rows=rows, stiffness=k, damping=c, table=None))
    square = np.ix_(kept, kept)
    return replace(
        rotor, mass=rotor.mass[square], elastic=rotor.elastic[square], supports=tuple(supports),
        internal_damping=np.zeros((len(kept), len(kept))), gyroscopic=rotor.gyroscopic[square],
        planes=rotor.planes[:, kept], unbalance=rotor.unbalance[kept],
        deflection=rotor.deflection[:, kept], inner=0,
        waves=tuple((at - rotor.inner, ring) for at, ring in rotor.waves),
    )  # fmt: skip


def _critical_over_speed(rotor: LinearRotor) -> NDArray[np.float64]:
    """`critical_speeds` where the stiffness changes with the speed: those at which one of the
    rotor of that speed is the speed itself, of a table those within it."""
    from scipy.optimize import brentq  # most rotors do without

    low, high = rotor.table_speeds
    if not rotor.varies:  # rubber alone: softest at rest, stiffest at a high speed
        least, most = (critical_speeds(at_frequency(rotor, w)) for w in (0.0, _STIFF))
        low, high = 0.5 * float(least.min(initial=0.0)), 2.0 * float(most.max(initial=0.0))
        if not high:
            return np.zeros(0)
        low = low or high * 1e-6
    found: list[float] = []
    grid = np.geomspace(max(low, 1e-9 * high), high, _SCAN)

    def excess(speed: float) -> NDArray[np.float64]:
        here = critical_speeds(at_frequency(rotor, speed))
        return np.append(here, np.full(2 * rotor.stations - len(here), math.inf)) - speed

    values = np.array([excess(float(w)) for w in grid])
    crosses = np.isfinite(values[:-1] + values[1:]) & ((values[:-1] > 0.0) != (values[1:] > 0.0))
    for k, number in np.argwhere(crosses).tolist():
        ends = float(grid[k]), float(grid[k + 1])
        found.append(brentq(lambda w, number=number: excess(w)[number], *ends, rtol=1e-13))
    return np.sort(np.array(found))


def _critical_of_free(elastic: NDArray, inertial: NDArray) -> NDArray[np.float64]:
    """`critical_speeds` where a motion has no stiffness, which is critical at no speed."""
    found = eigvals(elastic, inertial)
    size = np.abs(found[np.isfinite(found)]).max(initial=0.0)
    is_square = (np.abs(found.imag) <= REAL * size) & (found.real > RIGID * size)
    return np.sort(np.sqrt(found[is_square].real))


def speeds_of_interest(rotor: LinearRotor, speed: float) -> tuple[float, float]:
    """From near standstill to beyond a speed and the critical ones near it [rad/s], as far as
    tables of bearings go."""
    critical = critical_speeds(rotor)
    high = _ABOVE * max([speed, *critical[critical < _FAR * speed].tolist()])
    least, most = rotor.table_speeds
    return max(_LOWEST * high, least), min(high, most)
