"""Weights at rest in the rotor on races with lobes, and small motions about that rest.

With P = e + rho e^{i theta} the place of a weight and q = (rho' + i rho) e^{i theta} the way it
goes, a weight rests in a rotor that turns at w where

    Re(q* (zeta + P)) = 0,

zeta the forward part of its plane's motion, by all unbalance, that of the weights with it.  So the
rotor does not rest: it whirls by what the race leaves.  Small motions about it are those of
`linearised` with m q for m R i e^{i theta}, and a spring that a race without lobes has not:

    kappa theta'' + (b/m) theta' = -Re(q* D^2 zeta)/l^2 - w^2 s theta,   l = |q|,
    s = -(l^2 + Re(q'* (zeta + P)))/l^2.

So turns of the weights that leave all moments as they are have rates of their own.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Complex
from ..assembly import Assembly, weights_of
from ..harmonic_balance import unbalance_response
from ..race import path
from .balanced import balanced_angles
from .creep import LONGEST_TURN, creep_balanced, creep_freely
from .creep import NoRest as NoRest
from .linearised import Linearised, linearise_at, system_of
from .off_centre import centred
from .small_motions import Couplings, RotorParts

Creeps = Literal["not", "freely", "balanced"]

_NEWTON = 60  # iterations
_SOLVED = 1e-11  # of the radius: what is left of the equations
_ANEW = 0.03  # of a speed at which weights crept to no rest: so much later they do once more


@dataclass(frozen=True, eq=False)
class Places:
    """Of K weights at given angles: P, q and q', each (K,) [m]."""

    place: Complex
    along: Complex
    bend: Complex


@dataclass(frozen=True, eq=False)
class OnRace:
    """A machine whose weights are on races with lobes, at one speed [rad/s].

    Raises:
        ValueError: the supports' axes differ, or slide.
    """

    assembly: Assembly
    speed: float

    def __post_init__(self) -> None:
        rotor = self.assembly.loaded_rotor
        rotor.refuse_sliders("weights at rest on a race with lobes")
        parts = RotorParts.of(rotor)
        halves = [parts.half_stiffness, parts.half_damping, *(parts.turning or ())[1::2]]
        if any(np.any(half) for half in halves):
            raise NoRest(
                "race: weights rest on lobes only where supports are alike along x and y; run the "
                "scene instead"
            )

    @cached_property
    def columns(self) -> tuple[NDArray[np.int_], Array, Array, Array]:
        """Of each weight (K,): its plane, mass [kg], kappa and drag over mass [1/s]."""
        rows = [
            (m.plane, one.mass, one.kappa, one.drag / one.mass)
            for m in self.assembly.weights
            for one in weights_of(m).each
        ]
        plane, *others = np.array(rows, float).reshape(-1, 4).T
        return plane.astype(int), others[0], others[1], others[2]

    @cached_property
    def sizes(self) -> Array:
        """Radius of the track of each weight (K,) [m]."""
        devices = [weights_of(m) for m in self.assembly.weights]
        return np.concatenate([np.full(d.count, d.track_radius) for d in devices])

    def places(self, angles: Array) -> Places:
        """Where weights at `angles` (K,) [rad] are, and where they go."""
        columns, first = [], 0
        for mounted in self.assembly.weights:
            device = weights_of(mounted)
            theta = angles[first : first + device.count]
            first += device.count
            rho, slope, bend, _ = path(device.track_radius, device.race, theta)
            turn = np.exp(1j * theta)
            columns.append((mounted.offset + rho * turn, (slope + 1j * rho) * turn,
                            (bend + 2j * slope - rho) * turn))  # fmt: skip
        place, along, curved = (np.concatenate(parts) for parts in zip(*columns, strict=True))
        return Places(place, along, curved)

    @cached_property
    def _stations(self) -> Complex:
        """Forward motion (n, n) of all stations by a unit of unbalance at each [m/(kg m)]."""
        rotor = replace(self.assembly.loaded_rotor, beside=())
        each = [
            unbalance_response(replace(rotor, unbalance=unit), [self.speed])[0]
            for unit in np.eye(rotor.stations, dtype=complex)
        ]
        return np.array([0.5 * (x + 1j * y) for x, y in each])

    @cached_property
    def _forward(self) -> Complex:
        """The same of the planes (p, n)."""
        found: Complex = self.assembly.loaded_rotor.planes @ self._stations.T
        return found

    def unbalance(self, places: Places) -> Complex:
        """Of rotor and weights at the stations (n,) [kg m]."""
        plane, mass, *_ = self.columns
        rotor = self.assembly.loaded_rotor
        return np.asarray(rotor.unbalance + (mass * places.place) @ rotor.planes[plane])

    @cached_property
    def alone(self) -> Complex:
        """Displacement (n,) of the stations by the rotor's own unbalance [m]."""
        return np.asarray(self.assembly.loaded_rotor.unbalance @ self._stations)

    def whirl(self, angles: Array) -> Complex:
        """Displacement (n,) of the stations in the rotor's axes [m]."""
        found: Complex = self.unbalance(self.places(angles)) @ self._stations
        return found

    def missing(self, angles: Array) -> Array:
        """Re(q* (zeta + P)) of each weight (K,) [m^2]."""
        at, plane = self.places(angles), self.columns[0]
        centre = (self._forward @ self.unbalance(at))[plane]
        return np.asarray((at.along.conj() * (centre + at.place)).real)

    def slopes(self, angles: Array) -> Array:
        """Derivatives (K, K) of `missing`."""
        at, (plane, mass, *_) = self.places(angles), self.columns
        rotor = self.assembly.loaded_rotor
        centre = (self._forward @ self.unbalance(at))[plane]
        moved = (self._forward @ rotor.planes.T)[np.ix_(plane, plane)] * (mass * at.along)
        found: Array = (at.along.conj()[:, None] * moved).real
        own = (at.bend.conj() * (centre + at.place)).real + np.abs(at.along) ** 2
        return found + np.diag(own)

    def rest_near(self, angles: Array, creeps: Creeps = "not") -> Array:
        """Angles (K,) of a rest next to `angles` [rad].

        Args:
            creeps: whether weights first creep along the race, as under a heavy drag: freely, to
                the rests that are stable above the critical speed; or balanced, by turns alone that
                leave the rotor nearly at rest.

        Raises:
            NoRest: none was found.
        """
        theta = angles.copy()
        if creeps != "not":
            theta = (creep_balanced if creeps == "balanced" else creep_freely)(self, angles)
        size = self.sizes.max()
        for _ in range(_NEWTON):
            left = self.missing(theta)
            if np.abs(left).max() <= _SOLVED * size * size:
                return theta
            turn = np.linalg.lstsq(self.slopes(theta), -left, rcond=1e-14)[0]
            theta = theta + turn * min(1.0, LONGEST_TURN / max(np.abs(turn).max(), 1e-300))
        raise NoRest(f"no rest of weights on their race was found at {self.speed:g} rad/s")

    def linearised(self, angles: Array) -> Linearised:
        """Small motions about the rest at these angles, at this speed alone."""
        rotor, at = self.assembly.loaded_rotor, self.places(angles)
        plane, mass, kappa, slowing = self.columns
        centre = (self._forward @ self.unbalance(at))[plane]
        square = np.abs(at.along) ** 2
        spring = -(square + (at.bend.conj() * (centre + at.place)).real) / (kappa * square)
        planes = rotor.planes[plane]
        tangent = np.hstack([at.along.real[:, None] * planes, at.along.imag[:, None] * planes])
        column = (mass[:, None] * tangent).T
        couplings = Couplings(
            pull_turn=column,
            pull_rate=column,
            feed=np.eye(len(angles)),
            drag=slowing / kappa,
            drive=tangent / (kappa * square)[:, None],
            spring=spring,
        )
        return system_of(rotor, couplings, angles)


def has_lobes(assembly: Assembly) -> bool:
    """Whether any race is not round."""
    return any(weights_of(mounted).race for mounted in assembly.weights)


def rounded(assembly: Assembly) -> Assembly:
    """The same with round races."""
    return replace(
        assembly,
        balancers=tuple(
            replace(m, device=replace(m.device, race=())) if m in assembly.weights else m  # type: ignore[arg-type]
            for m in assembly.balancers
        ),
    )


def main_motion(
    assembly: Assembly, speed: float, near: Array | None = None, creeps: bool = True
) -> tuple[OnRace, Array]:
    """The machine and the angles (K,) [rad] at which its weights rest where they nearly balance.

    Two weights of a plane have one such rest next to where they would balance on round races; of
    three and more it is one to which they creep from there.

    Args:
        near: a rest at a speed nearby (K,) [rad], which is followed.
        creeps: whether three and more weights creep to a rest, which takes most of the time.

    Raises:
        CannotBalance, ArithmeticError: see `balanced.balanced_angles` of round races in the centre.
        NoRest: none was found.
    """
    found = OnRace(assembly, speed)
    if near is not None:
        try:
            angles = found.rest_near(near)
            if np.abs(angles - near).max() < LONGEST_TURN:
                return found, angles
        except NoRest:
            pass
    at_rest = balanced_angles(centred(rounded(assembly), speed))
    planes = [m.plane for m in assembly.weights for _ in m.angles]
    several = max(planes.count(plane) for plane in set(planes)) > 2
    if several and creeps:
        try:
            return found, found.rest_near(at_rest, "balanced")
        except NoRest:
            crept = _better_than_none(found, at_rest)
            if crept is not None:
                return found, crept
    return found, found.rest_near(at_rest)


def _better_than_none(machine: OnRace, near: Array) -> Array | None:
    """Where weights creep to freely, if they leave less there than no weights do.

    Below the critical speed they creep to the heavy side, which is no balance.
    """
    try:
        angles = machine.rest_near(near, "freely")
    except NoRest:
        return None
    left, alone = (np.abs(whirl).max() for whirl in (machine.whirl(angles), machine.alone))
    return angles if left < alone else None


def systems_at(assembly: Assembly, speeds: NDArray) -> tuple[list[Linearised], NDArray[np.int_]]:
    """As `linearised.linearise_at`; with lobes about the rest at each speed.

    Raises:
        CannotBalance, ValueError: as there.
        NoRest: see `main_motion`.
    """
    systems, which = systems_at_rest(assembly, speeds)
    if (which < 0).any():
        least = float(speeds[which < 0].min())
        raise NoRest(f"no rest of weights on their race was found at {least:g} rad/s")
    return systems, which


def systems_at_rest(
    assembly: Assembly, speeds: NDArray
) -> tuple[list[Linearised], NDArray[np.int_]]:
    """As `systems_at`; a speed at which no rest was found has the number -1.

    Raises:
        CannotBalance, ValueError: as there.
    """
    if not has_lobes(assembly):
        return linearise_at(assembly, speeds)
    each, which = np.unique(speeds, return_inverse=True)
    systems: list[Linearised] = []
    numbers, angles, without = [], None, 0.0
    for speed in each.tolist():
        creeps = speed > (1.0 + _ANEW) * without
        try:
            machine, angles = main_motion(assembly.at_speed(speed), speed, angles, creeps)
        except NoRest:
            numbers.append(-1)
            without = speed if creeps else without
            continue
        numbers.append(len(systems))
        systems.append(machine.linearised(angles))
    return systems, np.array(numbers, int)[which.reshape(-1)]
