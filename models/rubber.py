"""Rubber in supports and feet: a Zener element, which has one state for each axis.

A spring k0 stands beside a spring k1 in series with a damper, tau = damping/k1:

    f = k0 d + k1 (d - u),   tau u' = d - u,   K(i nu) = k0 + k1 i nu tau/(1 + i nu tau)

A complex stiffness k (1 + i eta) describes one harmonic motion alone: it is not causal.  The
element has the dynamic stiffness kd and the loss factor eta at one frequency nu0, where its loss
factor is largest; from nu0/2 to 2 nu0 it differs by at most a fifth.

A rotor is made of displacements with inertia.  So u becomes one more of them, and its equation is
differentiated once: (tau D + 1) (tau u' + u - d) = 0, D = d/dt.  A motion that begins relaxed,
with u = d and u' = 0, stays one of the element; the rate -1/tau that is added is that of no motion.

A shaft of rubber turns: in its frame tau U' = D - U, in fixed axes tau (u' - i w u) = d - u.  At a
constant speed w the same differentiation, (tau D + 1), gives

    tau^2 u'' + (2 tau - i w tau^2) u' + (1 - i w tau) u = tau d' + d:

a mass tau^2, a damping tau that stands and one that turns, and a gyroscopic term tau^2.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from .arrays import Numbers, zeros
from .rotor import LinearRotor
from .supports import SHAFT, Support


@dataclass(frozen=True)
class Zener:
    """A spring beside a spring and damper in series.

    Attributes:
        static: k0, what is left after a long time [N/m].
        branch: k1, stiffness of the spring in series [N/m].
        time: tau, damping of the damper over that [s].
    """

    static: float
    branch: float
    time: float

    def dynamic(self, frequency: float) -> complex:
        """K(i nu) [N/m] at a frequency nu [rad/s]."""
        turned = 1j * frequency * self.time
        return self.static + self.branch * turned / (1.0 + turned)


def zener(stiffness: float, loss_factor: float, frequency: float) -> Zener:
    """The element with a dynamic stiffness [N/m] and a loss factor [1] at a frequency [rad/s].

    >>> zener(1.0, 0.2, 1.0).static
    0.836038...
    """
    square = loss_factor * loss_factor
    ratio = 2.0 * square + 2.0 * loss_factor * _root(1.0 + square)
    static = stiffness * (2.0 + ratio) / (2.0 * (1.0 + ratio))
    return Zener(static, ratio * static, 1.0 / (frequency * _root(1.0 + ratio)))


def _root(value: Any) -> Any:
    """Of a float, or of a number that a proof computes with instead."""
    return value.sqrt() if hasattr(value, "sqrt") else math.sqrt(value)


def foot_numbers(supports: int, bodies: Iterable[tuple[int, bool]]) -> Iterator[list[int]]:
    """Numbers, from 0, that the feet of each body have among the supports of `with_bodies`.

    Args:
        supports: how many the rotor has.
        bodies: of each the number of its feet, and whether it moves along one axis alone, so that
            a support that holds the other one stands behind its feet.
    """
    for feet, is_held in bodies:
        yield list(range(supports, supports + feet))
        supports += feet + is_held


def with_rubber(rotor: LinearRotor, elements: Mapping[int, Sequence[Zener]]) -> LinearRotor:
    """A rotor some of whose supports are rubber; their displacements u stand behind all others.

    Args:
        elements: elements along x and y by the number of the support, from 0.  They take the place
            of its stiffness; what damping it has is beside them.
    """
    wide = rotor.widened(len(elements))
    supports = list(wide.supports)
    for place, (number, pair) in enumerate(elements.items(), start=rotor.stations):
        inertia = sum(one.branch * one.time * one.time for one in pair) / 2.0
        if isinstance(inertia, float) and not inertia:
            inertia = float(rotor.mass[0, 0])
        wide.mass[place, place] = inertia
        inner = np.eye(wide.stations)[place]
        supports[number] = _element(supports[number], inner, pair, inertia)
    return replace(wide, supports=tuple(supports), inner=rotor.inner + len(elements))


def with_turning_rubber(rotor: LinearRotor, count: int, element: Zener) -> LinearRotor:
    """A rotor whose shaft is of rubber, at a constant speed; displacements u stand behind all
    others, one for each of the shaft.

    It drives whirl that is slower than the rotor.

    Args:
        count: how many of the displacements, the first ones, are of the shaft.
        element: of a dynamic stiffness of 1 N/m, by which the shaft's is multiplied.
    """
    wide = rotor.widened(count)
    shaft, inner = np.arange(count), rotor.stations + np.arange(count)
    branch = element.branch * rotor.elastic[np.ix_(shaft, shaft)]
    # the equation of u has no size: any will do
    slow = max(float(one) for one in branch.diagonal())
    fast = slow * element.time
    for matrix, value in (
        (wide.mass, fast * element.time),
        (wide.gyroscopic, fast * element.time),
        (wide.internal_damping, fast),
    ):
        matrix[inner, inner] = value
    stiffness, damping = (zeros((2, 2, 2 * count, 2 * count), branch) for _ in range(2))
    d, u = np.arange(count), count + np.arange(count)
    for axis in (0, 1):
        stiffness[axis, axis][:count, :count] = branch
        stiffness[axis, axis][:count, count:] = -branch
        stiffness[axis, axis][u, d], stiffness[axis, axis][u, u] = -slow, slow
        damping[axis, axis][u, d], damping[axis, axis][u, u] = -fast, fast
    rows = np.eye(wide.stations)[np.concatenate([shaft, inner])]
    turning = Support(rows, stiffness, damping, name=SHAFT, across=0)
    return replace(
        wide, elastic=element.static * wide.elastic, supports=(*wide.supports, turning),
        inner=rotor.inner + count,
    )  # fmt: skip


def _element(support: Support, inner: Numbers, pair: Sequence[Zener], inertia: Any) -> Support:
    """A support of d, then u; `inertia` [kg] scales the equation of u, which has no size."""
    count = support.across
    stiffness, damping = (zeros((2, 2, count + 1, count + 1), support.damping) for _ in range(2))
    damping[:, :, :count, :count] = support.damping
    for axis, one in enumerate(pair):
        d, u = axis * (count - 1), count
        fast = inertia / one.time
        slow = fast / one.time
        stiffness[axis, axis, d, [d, u]] = one.static + one.branch, -one.branch
        stiffness[axis, axis, u, [d, u]] = -slow, slow
        damping[axis, axis, u, [d, u]] = -fast, 2.0 * fast
    rows = np.vstack([support.rows[:count], inner])
    return replace(support, rows=rows, stiffness=stiffness, damping=damping)
