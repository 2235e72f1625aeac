"""Drag of a weight on its track, from measured motion or from the oil.

Drag is linear: the force -c v on a weight that moves at v along the track.  A ball has the inertia
kappa m with kappa = 7/5 along its track.

Viscosity falls with temperature by ASTM D341: log10 log10(v + 0.7) = A - B log10 T, v in mm^2/s and
T in K.  ISO 3448 names an oil by v at 40 degC.  v at 100 degC is that of a mineral oil of viscosity
index 95 (ASTM D2270).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.polynomial import Chebyshev
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, root_scalar
from scipy.special import ellipe, ellipk

# ISO VG grade, which is v at 40 degC, and v at 100 degC [mm^2/s] for the viscosity index 95
_GRADES = {
    10: 2.64, 15: 3.38, 22: 4.25, 32: 5.29, 46: 6.64, 68: 8.53, 100: 11.1, 150: 14.5, 220: 18.7,
    320: 24.0, 460: 30.3,
}  # fmt: skip
_COLD, _HOT = 313.15, 373.15  # K, of the two viscosities
_MANY = 100  # half swings: of more one after the other takes too long
_NODES = 48  # of the map of a half swing: off by 1e-9 at most, of a drag
_LONGEST = 200.0  # of a half swing in the race's own time: without drag from 180 deg - 1e-80
OIL_DENSITY = 870.0  # kg/m^3: mineral oils have 850 to 900


def from_swing(
    mass: float, kappa: float, first: float, last: float, time: float, swings: float | None = None
) -> float:
    """Drag [N s/m] of a weight that swings about the lowest point of a race at rest.

    With the number of swings exact: theta'' + 2 d theta' + sin theta = 0 in the race's own time is
    integrated from rest at `first` over so many swings, and d is found for which they end at
    `last`.  Without it for weak drag, that is for many swings: the area of an orbit in the plane of
    angle and speed shrinks as exp(-c t/(kappa m)) under linear drag.  It is
    8 (E(m) - (1 - m) K(m)) with m = sin^2(amplitude/2), for small swings pi amplitude^2/2.

    Args:
        first, last: amplitudes [rad], below pi.
        time: between them [s].
        swings: from the first amplitude to the last, there and back each; halves end on the other
            side.
    """
    decrement = math.log(_orbit(first) / _orbit(last))
    if swings is not None:
        decrement = _exact_decrement(first, last, round(2.0 * swings), decrement)
    return kappa * mass * decrement / time


def swing_range(first: float, last: float) -> float:
    """Ratio of the drags by half a swing and by very many, between two amplitudes [rad], above 1.

    The amplitudes and the time alone do not tell the number of swings.
    """
    decrement = math.log(_orbit(first) / _orbit(last))
    return _exact_decrement(first, last, 1, decrement) / decrement


def _orbit(amplitude: float) -> float:
    m = math.sin(0.5 * amplitude) ** 2
    return float(ellipe(m) - (1.0 - m) * ellipk(m))


def _exact_decrement(first: float, last: float, halves: int, weak: float) -> float:
    """c t/(kappa m) of a decay over so many half swings; `weak`: the same for weak drag."""
    if halves > _MANY:
        return _decrement_by_map(first, last, halves, weak)

    def amplitude(rate: float) -> float:
        return _swung(first, rate, halves)[0] - last

    high = weak / (math.pi * halves)  # a half swing takes pi at least
    while amplitude(high) > 0.0:
        high *= 2.0
    rate = brentq(amplitude, 1e-3 * high, high, xtol=1e-12, rtol=1e-8)
    return float(rate) * _swung(first, rate, halves)[1]


def _decrement_by_map(first: float, last: float, halves: int, weak: float) -> float:
    """The same by a table of the half swings of each drag that is tried."""
    start, end = _place(first), _place(last)

    def swung(rate: float) -> tuple[float, float]:
        lost, lasting = _map_of_half_swing(start, end, rate)
        place, time = start, 0.0
        for _ in range(halves):
            at = max(place, end)  # lower amplitudes belong to trials alone
            place, time = place - lost(at), time + lasting(at)
        return place, time

    guess = weak / (math.pi * halves)
    found = root_scalar(
        lambda rate: swung(rate)[0] - end, x0=guess, x1=0.9 * guess, method="secant", rtol=1e-10
    )
    if not found.converged:
        raise ArithmeticError(f"no drag was found for {halves} half swings")
    return float(found.root) * swung(found.root)[1]


def _map_of_half_swing(start: float, end: float, rate: float) -> tuple[Chebyshev, Chebyshev]:
    """What a half swing takes off the place of an amplitude, and its time, over that place.

    Over ln tan(amplitude/2) both are smooth, and straight lines near rest and near 180 deg.
    """
    nodes = np.cos(np.pi * (np.arange(_NODES) + 0.5) / _NODES)
    places = end + 0.5 * (start - end) * (1.0 + nodes)
    swings = np.array([_swung(2.0 * math.atan(math.exp(x)), rate, 1) for x in places])
    lost = places - [_place(amplitude) for amplitude in swings[:, 0]]
    domain = (end, start)
    return (
        Chebyshev.fit(places, lost, _NODES - 1, domain),
        Chebyshev.fit(places, swings[:, 1], _NODES - 1, domain),
    )


def _place(amplitude: float) -> float:
    return math.log(math.tan(0.5 * amplitude))


def _swung(first: float, rate: float, halves: int) -> tuple[float, float]:
    """Amplitude after so many half swings from rest, and the time; 0 where it creeps down."""
    angle, time = first, 0.0

    def at_rest(_: float, state: tuple[float, float]) -> float:
        return state[1]

    at_rest.terminal, at_rest.direction = True, 1.0  # type: ignore[attr-defined]
    for _ in range(halves):  # each from the same side: the next one is its mirror image
        end = solve_ivp(
            lambda _, y: (y[1], -rate * y[1] - math.sin(y[0])),
            (0.0, _LONGEST),
            (angle, 0.0),
            "DOP853",
            events=at_rest,
            rtol=1e-10,
            atol=1e-13,
        )
        if not end.t_events[0].size:
            return 0.0, math.inf
        angle, time = abs(float(end.y_events[0][-1][0])), time + float(end.t_events[0][-1])
    return angle, time


def from_slowing(mass: float, kappa: float, first: float, last: float, time: float) -> float:
    """Drag [N s/m] of a weight that runs around a level race at rest, and slows down.

    Args:
        first, last: speeds, in one unit.
        time: between them [s].
    """
    return kappa * mass * math.log(first / last) / time


def stokes(viscosity: float, diameter: float) -> float:
    """Drag [N s/m] of a sphere in a liquid without walls, at small Reynolds numbers (Stokes 1851).

    Args:
        viscosity: dynamic [Pa s].
    """
    return 3.0 * math.pi * viscosity * diameter


def oil_viscosity(grade: float, temperature: float) -> float:
    """Kinematic viscosity [m^2/s] of a mineral oil by its ISO VG grade.

    Args:
        temperature: [K].

    Raises:
        ValueError: no such grade.
    """
    if grade not in _GRADES:
        raise ValueError(f"ISO VG {grade:g}: must be one of {', '.join(map(str, _GRADES))}")
    cold, hot = (math.log10(math.log10(v + 0.7)) for v in (grade, _GRADES[int(grade)]))
    place = math.log10(temperature / _COLD) / math.log10(_HOT / _COLD)
    return 1e-6 * float(10.0 ** (10.0 ** (cold + (hot - cold) * place)) - 0.7)
