"""Groups of equal weights, and their lag while k_c of each group are left behind together.

Weights that turn at w while the rotor turns at Om are pulled along by their drag and held back by
the vibration that they cause.  With S_c the static moment of the bunched weights of group c, psi_c
their angle, and g of `receptance`, the mean torques per turn are in balance when

    k_c h_c R_c^2 (Om - w) = w^4 sum_d S_c S_d Re(i e^{i (psi_d - psi_c)} g_cd(w; Om))

for every group.  One group: h (Om - w) = k m^2 w^4 (-Im g): track radius and rolling inertia
cancel.  Weights of a size touch: S = m R sin(k alpha)/sin(alpha), alpha half the angle between
neighbours (Goncharov 2017 (5)); their contact forces cancel in the sum.

A weight that turns with the rotor swings in it while its plane moves by Z e^{i w t}.  Its force is

    m w^2 Z (1 - w^2/(2 kappa (v^2 - i v d))),   v = w - Om,   d = h/(kappa m),

averaged over its angle: less than its mass makes, and for w < Om its drag feeds the rotor's motion
as internal damping does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Complex
from ..assembly import Assembly, Mounted, weights_of
from ..spacing import half_angle
from .receptance import Receptance

_NEWTON_STEPS = 12
_BALANCED = 1e-9  # of the torque: what Newton's method leaves
_LARGEST_TURN = 0.5  # rad by which it turns a group at once


@dataclass(frozen=True)
class Group:
    """Equal weights of one balancer.

    Attributes:
        balancer: its index among those that have weights.
        plane: index.
        count, moment, drag, radius: number, m R of each [kg m], h of each [N s/m], R [m].
        half_angle: half the angle between two that touch [rad]; 0: points.
        mass, kappa: of each [kg], and its inertia as it rolls over its mass.
    """

    balancer: int
    plane: int
    count: int
    moment: float
    drag: float
    radius: float
    half_angle: float
    mass: float
    kappa: float

    def bunched(self, numbers: Array) -> Array:
        """Static moment of so many weights side by side [kg m]."""
        if not self.half_angle:
            return numbers * self.moment
        return self.moment * np.sin(numbers * self.half_angle) / np.sin(self.half_angle)


def groups_of(assembly: Assembly) -> tuple[Group, ...]:
    """Every group of equal weights, in the balancers' order."""
    found = []
    for number, mounted in enumerate(assembly.weights):
        found += _of_balancer(number, mounted)
    return tuple(found)


def _of_balancer(number: int, mounted: Mounted) -> list[Group]:
    weights = weights_of(mounted)
    kinds: dict[tuple[float, float, float], int] = {}
    for one in weights.each:
        kind = (one.moment, one.drag, one.radius)
        kinds[kind] = kinds.get(kind, 0) + 1
    return [
        Group(number, mounted.plane, count, moment, drag, weights.track_radius,
              half_angle(radius, weights.track_radius), moment / weights.track_radius,
              weights.kappa)
        for (moment, drag, radius), count in kinds.items()
    ]  # fmt: skip


def ordered_numbers(groups: tuple[Group, ...], drags: Array, reach: Array) -> Array:
    """For k = 1 to N those k weights that are held most strongly, numbers by group (N, c, 2).

    Groups are filled one after the other, and (the second) evenly: which of both can be left
    behind, and longer, depends on the phases between the planes.

    Args:
        reach: (c,) moduli of the mode shape at the groups' planes.
    """
    counts = np.array([one.count for one in groups])
    moments = np.array([one.moment for one in groups])
    resistance = drags * np.array([one.radius**2 for one in groups])
    strength = moments * reach / resistance
    order = np.argsort(-np.round(strength / max(strength.max(), 1e-300), 6), kind="stable")
    rank = np.argsort(order)
    weights = [(c, number) for c, count in enumerate(counts) for number in range(count)]
    ways = (
        sorted(weights, key=lambda one: (rank[one[0]], one[1])),
        sorted(weights, key=lambda one: ((one[1] + 0.5) / counts[one[0]], rank[one[0]])),
    )
    filled = [np.eye(len(groups))[[c for c, _ in way]].cumsum(axis=0) for way in ways]
    return np.stack(filled, axis=-1)


class Lag:
    """How far weights can lag behind the rotor, Om - w [rad/s], where they turn at w.

    Args:
        groups: all of them.
        drags: (c,) of each group [N s/m], positive.
        planes: number of the rotor's.
    """

    def __init__(self, groups: tuple[Group, ...], drags: Array, planes: int) -> None:
        self.groups, self.drags, self.plane_count = groups, drags, planes
        self.planes = np.array([one.plane for one in groups])
        self._resistance = drags * np.array([one.radius**2 for one in groups])

    def at(
        self,
        receptance: Receptance,
        frequency: Array,
        speed: float | Array,
        numbers: Array,
        phases: Array,
        planes: Complex | None = None,
    ) -> tuple[Array, Array]:
        """`solve` with the other weights turning with the rotor.

        Args:
            planes: `Receptance.of_planes` there, where it is known.
        """
        if planes is None:
            planes = receptance.of_planes(frequency, speed)
        g = receptance.between_planes(planes, *self.others(frequency, speed, numbers))
        return self.solve(frequency, g, numbers, phases)

    def others(
        self, frequency: Array, speed: float | Array, numbers: Array
    ) -> tuple[Complex, Complex]:
        """Force per displacement of a plane of weights that turn with the rotor, (b, p) [N/m].

        They swing in the rotor at w - Om (at -w - Om for the backward part of the motion) and are
        held by their drag alone.
        """
        found = np.zeros((2, len(frequency), self.plane_count), complex)
        relative = np.stack([frequency - speed, -frequency - speed])
        relative[relative == 0.0] = 1.0
        half = 0.5 * (frequency * frequency) ** 2 / relative
        for k, one in enumerate(self.groups):
            free = (one.count - numbers[:, k]) * (one.mass / one.kappa)
            if free.any():
                rate = self.drags[k] / (one.kappa * one.mass)
                found[:, :, one.plane] += free * half / (1j * rate - relative)
        return found[0], found[1]

    def moments(self, numbers: Array) -> Array:
        """Static moments (b, c) of bunched weights, by their numbers (b, c) [kg m]."""
        pairs = zip(self.groups, numbers.T, strict=True)
        return np.stack([group.bunched(column) for group, column in pairs], axis=1)

    def solve(
        self, frequency: Array, receptance: Complex, numbers: Array, phases: Array
    ) -> tuple[Array, Array]:
        """Lag (b,) and angles (b, c) at which the torques of all groups balance.

        Args:
            frequency: w (b,).
            receptance: g (b, p, p) there.
            numbers: (b, c) of weights left behind.
            phases: (b, c) from which Newton's method begins.

        Returns:
            NaN where there is no such motion near these angles.
        """
        at = receptance[:, self.planes[:, None], self.planes[None, :]]
        moment = self.moments(numbers)
        torque = 1j * ((frequency * frequency) ** 2)[:, None, None] * at
        torque = torque * (moment[:, :, None] * moment[:, None, :])
        pull = numbers * self._resistance
        if len(self.groups) == 1:
            return torque[:, 0, 0].real / pull[:, 0], phases
        if len(self.groups) == 2:
            return _balance_two(torque, pull, phases)
        return _balance(torque, pull, phases)


def _balance_two(torque: Complex, pull: Array, phases: Array) -> tuple[Array, Array]:
    """Of two groups in closed form: the first stays, of two angles that with the larger lag.

    Torques over pulls are equal where a + p cos d + q sin d = 0, d the angle between the groups.
    """
    first, second = torque[:, 0, 0].real, torque[:, 1, 1].real
    there, back = torque[:, 0, 1], torque[:, 1, 0]
    u, v = pull[:, 1], pull[:, 0]
    a = u * first - v * second
    p, q = u * there.real - v * back.real, -u * there.imag - v * back.imag
    size = np.hypot(p, q)
    with np.errstate(divide="ignore", invalid="ignore"):
        apart, middle = np.arccos(-a / size), np.arctan2(q, p)
        lags = [(first + (there * np.exp(1j * (middle + way * apart))).real) / v for way in (1, -1)]
        further = lags[1] > lags[0]
        lag, turned = np.where(further, lags[1], lags[0]), middle + np.where(further, -apart, apart)
        alone = np.where(u > 0.0, second / u, first / v)
    one = (u == 0.0) | (v == 0.0)
    angles = phases.copy()
    angles[:, 1] = np.where(one | np.isnan(turned), phases[:, 1], phases[:, 0] + turned)
    return np.where(one, alone, lag), angles


def _balance(torque: Complex, pull: Array, phases: Array) -> tuple[Array, Array]:
    """Newton's method for the lag and the angles between groups; the first present one stays."""
    rows, count = phases.shape
    present = pull > 0.0
    first = present.argmax(axis=1)
    every = np.arange(rows)
    angles = phases.copy()
    turned = torque * np.exp(1j * (angles[:, None, :] - angles[:, :, None]))
    lag = turned.real.sum(axis=(1, 2)) / pull.sum(axis=1)
    size = np.abs(torque).sum(axis=(1, 2)) / count
    for _ in range(_NEWTON_STEPS):
        turned = torque * np.exp(1j * (angles[:, None, :] - angles[:, :, None]))
        left = np.where(present, turned.real.sum(axis=2) - pull * lag[:, None], 0.0)
        if not (np.abs(left).max(axis=1) > _BALANCED * size).any():
            break
        slope = -turned.imag
        slope[:, range(count), range(count)] += turned.imag.sum(axis=2)
        slope = np.where(present[:, :, None] & present[:, None, :], slope, np.eye(count))
        slope[every, :, first] = -pull
        try:
            step = np.linalg.solve(slope, left[..., None])[..., 0]
        except np.linalg.LinAlgError:
            break
        lag = lag - step[every, first]
        step[every, first] = 0.0
        largest = np.abs(step).max(axis=1, keepdims=True)
        angles = angles - step * np.minimum(1.0, _LARGEST_TURN / np.maximum(largest, 1e-300))
    settled = np.abs(left).max(axis=1) <= 1e2 * _BALANCED * size
    return np.where(settled, lag, np.nan), angles
