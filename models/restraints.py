"""Cubic springs, stops and dampers with a free stroke that hold a rotor beside linear supports.

All act on the displacement d across a support.  A cubic spring pulls back by k3 |d|^2 d (radial)
or by k3 x^3, k3 y^3 (along each axis); a stop pushes back by ks (r - g) + cs r' along d where
r = |d| is beyond the gap g and that is above 0, and never pulls.

**A balanced rotor feels none of them.**  Where weights or liquid balance the rotor fully and
nothing pulls it aside, d = 0: the derivative of the cubic force there is 0, and a stop that is away
is away for all small motions, and so is a damper that rests in the middle of its free stroke.
Stability of that state is that of the linear rotor.  With gravity the supports sag to d0; small
motions about the sag feel the tangent k3 (|d0|^2 1 + 2 d0 d0^T), none of a stop unless the
sag reaches it, and none of a damper, whose stroke is centred about the sag.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import root

from .arrays import Numbers
from .assembly import Assembly
from .rotor import LinearRotor
from .supports import CubicSpring, Slider, Stop, Support, spread

_SOLVED = 1e-12  # of the weight: what a sag leaves


def tangent(spring: CubicSpring, at: Numbers) -> Numbers:
    """Stiffness (2, 2) of a cubic spring for small motions about a displacement (2,) [N/m]."""
    x, y = at
    if not spring.radial:
        return np.diag([3.0 * spring.stiffness[0] * x * x, 3.0 * spring.stiffness[1] * y * y])
    square = x * x + y * y
    found: Numbers = spring.stiffness[0] * (square * np.eye(2) + 2.0 * np.outer(at, at))
    return found


@dataclass(frozen=True, eq=False)
class Rest:
    """A rotor at rest under gravity on cubic springs.

    Attributes:
        sag: (2, n) displacement of the stations [m].
        linear: the rotor for small motions about it; its own `sag` is not this one.
        touching: numbers of stops from 0 that the sag reaches.
    """

    sag: Numbers
    linear: LinearRotor
    touching: tuple[int, ...]


def at_rest(rotor: LinearRotor, speed: float = 0.0) -> Rest:
    """The rotor about its sag, at rest in fixed axes while it turns [rad/s].

    Without gravity the sag is 0, and the linear rotor is the rotor without springs and stops.

    Raises:
        ValueError: the supports cannot carry the weight, or the sag reaches a stop's gap where
            nothing is linear.
    """
    plain = replace(rotor, cubics=(), stops=(), sliders=())
    if not rotor.gravity:
        return Rest(np.zeros((2, rotor.stations)), plain, ())
    linear = plain.at(speed)
    _, _, stiffness = linear.real_coefficients(speed)
    weight = np.kron(np.eye(2), linear.mass) @ _falling(linear)
    scale = float(np.abs(weight).max()) or 1.0

    def left(q: Numbers) -> Numbers:
        pulled = sum((_force(one, q) for one in rotor.cubics), np.zeros(len(q)))
        return np.asarray((stiffness @ q + pulled - weight) / scale)

    begin = linear.rest_position(speed).ravel()
    found = root(left, begin, method="hybr", options={"xtol": 1e-14})
    if not float(np.abs(left(found.x)).max()) <= _SOLVED:
        raise ValueError("gravity: the supports cannot carry the rotor's weight: no sag was found")
    sag = found.x.reshape(2, -1)
    supports = [_as_support(one, tangent(one, across(one.rows, sag))) for one in rotor.cubics]
    reached = [k for k, stop in enumerate(rotor.stops) if _reaches(stop, sag)]
    return Rest(sag, replace(plain, supports=(*plain.supports, *supports)), tuple(reached))


def about_rest(assembly: Assembly, speed: float) -> Assembly:
    """A machine for small motions about rest, as `at_rest`.

    Raises:
        ValueError: as `at_rest`.
    """
    rest = at_rest(assembly.loaded_rotor, speed)
    n = assembly.rotor.stations
    more = rest.linear.supports[len(assembly.rotor.supports) :]
    own = tuple(replace(one, rows=one.rows[:, :n]) for one in more)

    def plain(rotor: LinearRotor) -> LinearRotor:
        loose = tuple(one for one in rotor.sliders if one.free_stroke)
        beside: tuple[CubicSpring | Stop | Slider, ...] = (*rotor.cubics, *rotor.stops, *loose)
        held = (*rotor.supports, *own)
        sliders = tuple(one for one in rotor.sliders if one.limit and not one.free_stroke)
        return replace(rotor, supports=held, cubics=(), stops=(), sliders=sliders, beside=beside)

    later = tuple((time, plain(rotor)) for time, rotor in assembly.later)
    return replace(assembly, rotor=plain(assembly.rotor), later=later)


def across(rows: Numbers, motion: Numbers) -> Numbers:
    """Displacement (2, ...) across rows (2, n) by that of the stations (2, n, ...)."""
    return np.asarray(np.einsum("an,an...->a...", rows, motion))


def _reaches(stop: Stop, sag: Numbers) -> bool:
    return math.hypot(*across(stop.rows, sag)) >= stop.gap


def _falling(rotor: LinearRotor) -> Numbers:
    field = np.full(rotor.stations, rotor.gravity)
    field[[at for at, _ in rotor.waves]] = 0.0
    return np.concatenate([field.real, field.imag])


def _force(spring: CubicSpring, q: Numbers) -> Numbers:
    """Pull of a spring (2 n,) at displacements (2 n,) [N]."""
    d = across(spring.rows, q.reshape(2, -1))
    return np.asarray((-spring.force(d)[:, None] * spring.rows).ravel())


def _as_support(spring: CubicSpring, stiffness: Numbers) -> Support:
    """A support of two rows with a stiffness (2, 2), which is no bearing of its own."""
    k = spread(stiffness, 2)
    return Support(spring.rows, k, np.zeros_like(k), across=0)
