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

import math
from dataclasses import dataclass

import numpy as np

from ..arrays import Array, Complex
from ..assembly import Assembly, Mounted, weights_of
from ..spacing import half_angle
from .balance import balance, balance_two
from .receptance import Receptance


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

    Attributes:
        used: (p,) planes of the rotor that have weights.
        planes: (c,) of each group, an index among these.
        turned_over: w/Om from which on a weight without drag that turns with the rotor pulls its
            plane the other way than its mass does: 1 = w^2/(2 kappa v^2) of the force above.
    """

    def __init__(self, groups: tuple[Group, ...], drags: Array) -> None:
        self.groups, self.drags = groups, drags
        self.used, self.planes = np.unique([one.plane for one in groups], return_inverse=True)
        self._resistance = drags * np.array([one.radius**2 for one in groups])
        self._counts = np.array([one.count for one in groups])
        self._moments = np.array([one.moment for one in groups])
        self._have_size = any(one.half_angle for one in groups)
        self._shares = np.array([one.mass / one.kappa for one in groups])
        rates = drags / np.array([one.kappa * one.mass for one in groups])
        root = math.sqrt(2.0 * min(one.kappa for one in groups))
        self.turned_over = root / (1.0 + root)
        place = np.eye(len(self.used))[self.planes]
        self._rates = [(rate, place * (rates == rate)[:, None]) for rate in set(rates.tolist())]

    def at(
        self,
        receptance: Receptance,
        frequency: Array,
        speed: float | Array,
        numbers: Array,
        phases: Array,
        factors: float | Array = 1.0,
    ) -> tuple[Array, Array]:
        """Lag (r, j) and angles (r, j, c) at which the torques of all groups balance.

        Args:
            frequency: w (r, j).
            speed: of the rotor, one or (r,).
            numbers: (r, c) of weights left behind; the others turn with the rotor.
            phases: (r, c) from which Newton's method begins.
            factors: of all drags, one or (r,).

        Returns:
            NaN where there is no such motion near these angles.
        """
        others = self.others(frequency, speed, numbers, receptance.parts, factors)
        g = receptance.between_planes(receptance.of_planes(frequency, speed), others)
        pull = numbers * self._resistance * np.reshape(factors, (-1, 1))
        moments = self.moments(numbers)
        size = (frequency * frequency) ** 2
        if len(self.groups) == 1:
            lag = size * -g[0, 0].imag * (moments**2 / pull)
            return lag, np.broadcast_to(phases[:, None], (*lag.shape, 1))
        at = g[self.planes[:, None], self.planes]
        if len(self.groups) == 2:
            lag, turned = balance_two(at, moments.T[..., None], pull.T[..., None])
            angles = np.empty((*lag.shape, 2))
            angles[..., 0] = phases[:, :1]
            angles[..., 1] = np.where(np.isnan(turned), phases[:, 1:], phases[:, :1] + turned)
            return size * lag, angles
        torque = 1j * size * at * (moments.T[:, None] * moments.T)[..., None]
        torque = np.moveaxis(torque.reshape(*torque.shape[:2], frequency.size), -1, 0)
        points = frequency.shape[1]
        lag, angles = balance(torque, *(np.repeat(x, points, axis=0) for x in (pull, phases)))
        return lag.reshape(frequency.shape), angles.reshape(*frequency.shape, len(self.groups))

    def others(
        self,
        frequency: Array,
        speed: float | Array,
        numbers: Array,
        parts: int,
        factors: float | Array = 1.0,
    ) -> Complex:
        """Force per displacement of a plane of weights that turn with the rotor [N/m].

        They swing in the rotor at w - Om (at -w - Om for the backward part of the motion) and are
        held by their drag alone.

        Args:
            parts: 1: of the forward part of the motion; 2: then of the backward part.

        Returns:
            (p, r, j) or (2p, r, j).
        """
        om, squared = np.reshape(speed, (-1, 1)), frequency * frequency
        half, count = -0.5 * squared * squared, len(self.used)
        found = np.zeros((parts * count, *frequency.shape), complex)
        free = (self._counts - numbers) * self._shares
        for rate, which in self._rates:
            masses = (free @ which).T[..., None]
            if masses.any():
                damped = rate * np.reshape(factors, (-1, 1))
                # the force of the backward part acts on its conjugate
                for part, sign in enumerate((1.0, -1.0)[:parts]):
                    relative = sign * frequency - om
                    relative += relative == 0.0
                    # half/(v^2 - i sign v d), in its real and its imaginary part
                    force = half / (relative * relative + damped * damped)
                    there = found[part * count : (part + 1) * count]
                    there.real += masses * force
                    there.imag += masses * (sign * damped * force / relative)
        return found

    def moments(self, numbers: Array) -> Array:
        """Static moments (b, c) of bunched weights [kg m] from their counts (b, c)."""
        if not self._have_size:
            return numbers * self._moments
        pairs = zip(self.groups, numbers.T, strict=True)
        return np.stack([group.bunched(column) for group, column in pairs], axis=1)
