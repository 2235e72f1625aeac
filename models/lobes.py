"""Races that are not round: where weights come to rest, and what vibration they leave.

The path rho e^{i th} of a weight's centre is that of `race`.  With zeta the displacement
of the middle in axes that turn with the rotor at constant w, and q = (rho' + i rho) e^{i th},

    m Re(q* a) + (kappa - 1) m |q| (|q| th')' + b |q|^2 th' = 0,
    a = zeta'' + q th'' + q' th'^2 + 2 i w (zeta' + q th') - w^2 (zeta + rho e^{i th})

for each weight, and the rotor receives -sum m a.  At rest in the rotor

    (K - M w^2 + i c w) zeta - w^2 sum m (zeta + rho e^{i th}) = U w^2,
    rho' Re(zeta e^{-i th}) + rho Im(zeta e^{-i th}) + rho rho' = 0.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from .arrays import Array
from .assembly import Assembly
from .linear.on_race import NoRest, OnRace
from .race import path
from .weights import Lobes, Weights

_STARTS = 60
_MANY, _CREEPS = 3, 8  # weights from which on starts creep, and how many do
_NEAR = 1e-6  # rad: the same motion


@dataclass(frozen=True)
class Rest:
    """A motion in which weights rest in the rotor.

    Attributes:
        displacement: of the rotor in its own axes, whose modulus is the vibration left [m].
        angles: (N,) of the weights [rad].
        growth: largest growth rate of a small deviation [1/s].
    """

    displacement: complex
    angles: tuple[float, ...]
    growth: float


class Race:
    """One balancer with weights on a race with lobes, on a planar rotor alike in x and y.

    Raises:
        ValueError: the assembly is another one; the message says in what.
    """

    def __init__(self, assembly: Assembly, speed: float, lobes: Sequence[Lobes]) -> None:
        rotor = assembly.rotor
        if len(assembly.balancers) != 1 or not assembly.weights:
            raise ValueError("a race with lobes: only with exactly one balancer, of weights")
        if rotor.stations != 1 or not rotor.isotropic or rotor.gravity:
            raise ValueError(
                "a race with lobes: only on a planar rotor without bodies, alike in x and y"
            )
        device = assembly.weights[0].device
        assert isinstance(device, Weights)
        device.refuse_unequal("a race with lobes")
        self.weights, self.speed, self.lobes = device, speed, tuple(lobes)
        self.half_angle = assembly.weights[0].half_angle
        self.mass, self.stiffness = float(rotor.mass[0, 0]), float(rotor.stiffness_x[0, 0])
        self.damping = float(rotor.damping_x[0, 0])
        self.internal = float(rotor.internal_damping[0, 0])
        self.unbalance = complex(rotor.unbalance[0])
        mounted = assembly.weights[0]
        on_race = replace(mounted, device=replace(device, race=self.lobes))
        self.assembly = replace(assembly, balancers=(on_race,))

    def path(self, angles: Array) -> tuple[Array, Array, Array]:
        """rho and its first two derivatives (N,) [m]."""
        return path(self.weights.track_radius, self.lobes, angles)[:3]

    @property
    def alone(self) -> float:
        """Vibration without the weights [m]."""
        w = self.speed
        rotor = complex(self.stiffness - self.mass * w * w, self.damping * w)
        return abs(self.unbalance * w * w / rotor)

    def rates(self, state: Array) -> Array:
        """Derivative of (zeta, zeta', th, th') in the rotor, (4 + 2 N,)."""
        w, one, n = self.speed, self.weights, self.weights.count
        zeta, rate = complex(*state[:2]), complex(*state[2:4])
        angles, turning = state[4 : 4 + n], state[4 + n :]
        rho, slope, bend = self.path(angles)
        turn = np.exp(1j * angles)
        q, curved = (slope + 1j * rho) * turn, (bend + 2j * slope - rho) * turn
        rest = curved * turning**2 + 2j * w * (rate + q * turning) - w * w * (zeta + rho * turn)
        matrix, right = np.zeros((2 + n, 2 + n)), np.zeros(2 + n)
        matrix[0, 0] = matrix[1, 1] = self.mass + n * one.mass
        push = (
            self.unbalance * w * w - self.stiffness * zeta - self.damping * (rate + 1j * w * zeta)
        )
        push -= self.internal * rate + self.mass * (2j * w * rate - w * w * zeta)
        push -= one.mass * complex(rest.sum())
        right[0], right[1] = push.real, push.imag
        at = np.arange(2, 2 + n)
        matrix[0, at] = matrix[at, 0] = one.mass * q.real
        matrix[1, at] = matrix[at, 1] = one.mass * q.imag
        matrix[at, at] = one.kappa * one.mass * np.abs(q) ** 2
        right[at] = -one.mass * (rest * q.conj()).real - one.drag * np.abs(q) ** 2 * turning
        right[at] -= (one.kappa - 1.0) * one.mass * slope * (bend + rho) * turning**2
        found = np.linalg.solve(matrix, right)
        return np.concatenate([state[2:4], found[:2], turning, found[2:]])

    def rests(self, seed: int = 0) -> list[Rest]:
        """Motions at rest in the rotor that leave less vibration than there is without weights,
        the least vibration first.

        They are those to which weights creep under a heavy drag from random angles, and, of one or
        two weights, those that Newton's method finds too, among them unstable ones.  Weights of a
        size do not overlap in them, and their contacts are not counted.
        """
        rng, found = np.random.default_rng(seed), dict[tuple[int, ...], Rest]()
        n = self.weights.count
        drawn = rng.uniform(0.0, math.tau, (_STARTS, n))
        machine = OnRace(self.assembly, self.speed)
        for start in drawn if n < _MANY else drawn[:_CREEPS]:
            try:
                angles = machine.rest_near(start, "freely" if n >= _MANY else "not")
            except NoRest:
                continue
            angles = np.sort(angles % math.tau)
            zeta = complex(machine.whirl(angles)[0])
            if abs(zeta) > self.alone or self._overlap(angles):
                continue
            key = tuple((angles / _NEAR / 10.0).round().astype(int).tolist())
            if key not in found:
                system = machine.linearised(angles).at_speed(self.speed)
                growth = float(np.linalg.eigvals(system).real.max())
                found[key] = Rest(zeta, tuple(angles.tolist()), growth)
        return sorted(found.values(), key=lambda rest: abs(rest.displacement))

    def _overlap(self, angles: Array) -> bool:
        """Whether weights of a size would be in one another's place."""
        apart = np.diff(np.append(angles, angles[0] + math.tau))
        return len(angles) > 1 and bool(apart.min() < 2.0 * self.half_angle * (1.0 - 1e-9))


def swing(speed: float, lobes: Lobes, radius: float, kappa: float) -> float:
    """Angular frequency at which a weight swings about a lobe of a balanced heavy rotor [rad/s], to
    first order in the amplitude over the radius."""
    return speed * math.sqrt(lobes.order**2 * lobes.amplitude / (kappa * radius))
