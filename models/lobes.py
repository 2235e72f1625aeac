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

import contextlib
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from .arrays import Array
from .assembly import Assembly, weights_of
from .linear.on_race import NoRest, OnRace, main_motion
from .race import path
from .weights import Lobes, Weights

_STARTS = 60
_MANY, _CREEPS = 3, 8  # weights from which on starts creep, and how many do
_NEAR = 1e-6  # rad: the same motion
_TURNS, _BETWEEN = 12, 10  # angles at which weights creep, and steps from each to the next
_TURNED_CREEPS = 6  # random starts at each of them
# of the speed: growth that rounding gives a neutral motion, such as that of a race off centre
_NEUTRAL = 1e-7
_SAME_SIZE = 1e-6  # of the vibration without weights: the same motion


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
        """Motions at rest in the rotor, the least vibration first.

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
            if _overlap(angles, self.half_angle):
                continue
            key = tuple((angles / _NEAR / 10.0).round().astype(int).tolist())
            if key not in found:
                system = machine.linearised(angles).at_speed(self.speed)
                growth = float(np.linalg.eigvals(system).real.max())
                found[key] = Rest(zeta, tuple(angles.tolist()), growth)
        return sorted(found.values(), key=lambda rest: abs(rest.displacement))


def _overlap(angles: Array, half_angle: float) -> bool:
    """Whether weights of a size would be in one another's place."""
    ordered = np.sort(angles % math.tau)
    apart = np.diff(np.append(ordered, ordered[0] + math.tau))
    return len(angles) > 1 and bool(apart.min() < 2.0 * half_angle * (1.0 - 1e-9))


def _any_overlap(assembly: Assembly, angles: Array) -> bool:
    first = 0
    for mounted in assembly.weights:
        own = angles[first : first + len(mounted.angles)]
        first += len(own)
        if _overlap(own, mounted.half_angle):
            return True
    return False


def swing(speed: float, lobes: Lobes, radius: float, kappa: float) -> float:
    """Angular frequency at which a weight swings about a lobe of a balanced heavy rotor [rad/s], to
    first order in the amplitude over the radius."""
    return speed * math.sqrt(lobes.order**2 * lobes.amplitude / (kappa * radius))


@dataclass(frozen=True)
class Held:
    """A stable motion in which all weights of a machine rest on their races.

    Attributes:
        size: largest vibration of a station [m].
        angles: (K,) of the weights [rad].
    """

    size: float
    angles: tuple[float, ...]


def rests_over_turns(assembly: Assembly, speed: float, seed: int = 0) -> list[list[Held]]:
    """Stable motions at rest, all races turned against the unbalance; the least vibration first.

    Weights creep to them from random angles at 12 angles of the races over the period of the lobes,
    and each is followed from there, both ways, to where it ends.

    Returns:
        one list for each of 120 angles, the races as they are first.

    Raises:
        ValueError, NoRest: see `OnRace`.
        CannotBalance: the weights cannot undo the unbalance on round races.
    """
    rng, count = np.random.default_rng(seed), _TURNS * _BETWEEN
    weights = sum(len(m.angles) for m in assembly.weights)
    turns = period([one for m in assembly.weights for one in weights_of(m).race]) / count
    machines = [OnRace(turned_races(assembly, k * turns), speed) for k in range(count)]
    found: list[list[Held]] = [[] for _ in machines]
    for k in range(0, count, _BETWEEN):
        starts: list[Array] = []
        with contextlib.suppress(NoRest):
            starts.append(main_motion(machines[k].assembly, speed)[1])
        for start in rng.uniform(0.0, math.tau, (_TURNED_CREEPS, weights)):
            try:
                starts.append(machines[k].rest_near(start, "freely"))
            except NoRest:
                continue
        for angles in starts:
            _add(found[k], machines[k], angles)
    for way in (1, -1):
        for k in range(0, 2 * count * way, way):  # twice: what is found late goes on too
            here, after = k % count, (k + way) % count
            shift = way * turns
            for held in list(found[here]):
                _follow(found[after], machines[after], np.array(held.angles), shift)
    return [sorted(rests, key=lambda held: held.size) for rests in found]


def _follow(found: list[Held], machine: OnRace, angles: Array, turn: float) -> None:
    """Add the rest next to `angles`, in which weights keep their place or turn with the races; or
    the one to which they creep from there."""
    for start in (angles, angles + turn):
        try:
            rest = machine.rest_near(start)
        except NoRest:
            continue
        if np.abs(rest - start).max() < 2.0 * abs(turn) and _add(found, machine, rest):
            return
    with contextlib.suppress(NoRest):
        _add(found, machine, machine.rest_near(angles, "freely"))


def _add(found: list[Held], machine: OnRace, angles: Array) -> bool:
    """Add a rest unless it is known.

    Returns:
        False where it is unstable, or where weights overlap.
    """
    alone = float(np.abs(machine.alone).max())
    size = float(np.abs(machine.whirl(angles)).max())
    if any(abs(size - held.size) <= _SAME_SIZE * alone for held in found):
        return True
    rates = np.linalg.eigvals(machine.linearised(angles).at_speed(machine.speed)).real
    if not rates.max() < _NEUTRAL * machine.speed or _any_overlap(machine.assembly, angles):
        return False
    found.append(Held(size, tuple(angles.tolist())))
    return True


def period(race: Sequence[Lobes]) -> float:
    """Angle by which a race is turned onto itself [rad]."""
    return math.tau / math.gcd(*(one.order for one in race))


def turned_races(assembly: Assembly, by: float) -> Assembly:
    """The same with all races turned by an angle [rad]."""
    return replace(
        assembly,
        balancers=tuple(
            replace(m, device=replace(m.device, race=turned(m.device.race, by)))
            if isinstance(m.device, Weights)
            else m
            for m in assembly.balancers
        ),
    )


def turned(race: Sequence[Lobes], by: float) -> tuple[Lobes, ...]:
    """The same lobes on a race that is turned by an angle [rad]."""
    return tuple(replace(one, angle=one.angle + by) for one in race)
