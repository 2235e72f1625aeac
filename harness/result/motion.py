"""What pictures see of a run: its scene, and signals by name."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from ...models.arrays import Array
from ..errors import UserError
from ..master.names import along_axes
from ..output.picture import PlotAxis
from ..scene import Scene
from ..scene.balancer import WeightBalancer
from .sag import FROM_SAG, sag_of

Place = tuple[float, str, Array]


class Signals(Protocol):
    """Recorded values by name; an unknown name is an error that says what there is."""

    def __getitem__(self, name: str) -> Array: ...


@dataclass(frozen=True, eq=False)
class Motion:
    """A run of a scene.

    Attributes:
        time: (T,) [s].
        recorded: (T,) each, by name.
    """

    scene: Scene
    time: Array
    recorded: Signals

    @cached_property
    def speed(self) -> Array:
        """Of the rotor, (T,) [rad/s].

        Raises:
            UnknownSignalError: a motor makes it, and it was not recorded.
        """
        if self.scene.operation.motor:
            return self.recorded["motor.speed"]
        return self.scene.profile().speeds_at(self.time)

    @cached_property
    def angle(self) -> Array:
        """Of the rotor, (T,) [rad]; what a motor makes of it by its speed."""
        begin = self.scene.run.initial.angle
        if self.scene.operation.motor:
            return begin + CubicSpline(self.time, self.speed).antiderivative()(self.time)
        turned = self.scene.profile().angle
        return begin + np.array([turned(t) for t in self.time.tolist()])

    @property
    def changes(self) -> bool:
        """Whether the speed does, as prescribed: that of a motor may be caught."""
        return self.scene.profile().changes

    @cached_property
    def sweep(self) -> Motion:
        """The part in which the speed rises, or falls, by most; all where it is constant."""
        if not self.changes:
            return self
        begin, end = self.scene.profile().sweep
        part = (self.time >= begin * (1.0 - 1e-12)) & (self.time <= end * (1.0 + 1e-12))
        return Motion(self.scene, self.time[part], _Part(self.recorded, part))

    @property
    def swept(self) -> str:
        """What `sweep` is a part of: for a title, such as ": run-down from 16 s to 19 s only".

        Empty where it is all of the run.
        """
        if not self.changes:
            return ""
        profile = self.scene.profile()
        begin, end = profile.sweep
        if begin <= self.time[0] and end >= self.time[-1]:
            return ""
        low, high = np.interp((begin, end), profile.times, profile.speeds)
        name = "run-up" if high > low else "run-down"
        return f": {name} from {begin:.4g} s to {end:.4g} s only"

    @property
    def across(self) -> tuple[PlotAxis, Array]:
        """Speed (T,) where it changes, else time."""
        if self.changes:
            return PlotAxis("speed", "rad/s"), self.speed
        return PlotAxis("time", "s"), self.time

    @cached_property
    def displacement(self) -> Array:
        """x and y of every station, under gravity from the sag, (T, 2, n) [m].

        Raises:
            UnknownSignalError: one was not recorded.
        """
        names = along_axes(len(self.scene.rotor.points))
        both = np.array([[self.recorded[name] for name in row] for row in names])
        if sag := self._sag:
            both -= np.array([[sag[name] for name in row] for row in names])
        return np.moveaxis(both, 2, 0)

    @property
    def called(self) -> str:
        """What `displacement` is, for an axis."""
        return FROM_SAG if self.scene.operation.gravity else "displacement"

    @property
    def _sag(self) -> dict[str, Array]:
        turned_by_shaft = self.scene.operation.motor and self.scene.operation.gravity
        speed = self.speed if turned_by_shaft and self._has_internal_damping else None
        return sag_of(self.scene, self.time, speed)

    @property
    def _has_internal_damping(self) -> bool:
        return bool(self.scene.assembly().rotor.internal_damping.any())

    def weights(self) -> Iterator[tuple[WeightBalancer, Array]]:
        """Every balancer with weights, and their angles in the rotor (N, T) [rad].

        Raises:
            UserError: the scene has no weights.
            UnknownSignalError: an angle was not recorded.
        """
        for b in with_weights(self.scene):
            names = (f"{b.label}.weight[{k}].angle" for k in range(1, b.count + 1))
            yield b, np.array([self.recorded[name] for name in names])

    def light_side(self, times: Array) -> Array:
        """Opposite of a disc's unbalance at times (T,) [rad]; NaN where it has no one direction."""
        assembly = self.scene.assembly()
        rotors = [assembly.rotor, *(rotor for _, rotor in assembly.later)]
        passed = np.searchsorted([start for start, _ in assembly.later], times, side="right")
        moments = np.array([rotor.unbalance for rotor in rotors])[passed]
        alone = (moments.shape[1] == 1) & (moments[:, 0] != 0.0)
        return np.where(alone, np.angle(-moments[:, 0]), np.nan)


def with_weights(scene: Scene) -> Sequence[WeightBalancer]:
    """Balancers that have them.

    Raises:
        UserError: there is none.
    """
    carriers = [b for b in scene.balancer if isinstance(b, WeightBalancer)]
    if not carriers:
        raise UserError(f"{scene.heading}: has no balancer with weights to show")
    return carriers


def places(scene: Scene) -> list[Place]:
    """Places along the shaft that move: position [m], name, and row over the stations (n,)."""
    rotor, planes = scene.rotor, scene.assembly().rotor.planes
    along = list(zip(rotor.points, station_names(scene), np.eye(len(rotor.points)), strict=True))
    for number, (z, row) in enumerate(zip(rotor.planes, planes, strict=True), start=1):
        if z not in rotor.stations:
            along.append((z, f"plane {number}", row))
    return sorted(along, key=lambda place: place[0])


def station_names(scene: Scene) -> list[str]:
    """Of a rotor's stations, for people."""
    count = len(scene.rotor.points)
    discs, beyond = len(scene.rotor.stations), scene.rotor.beyond
    named = [f"station {j}" for j in range(1, discs + 1)] if count > 1 else ["rotor"]
    return [*named, *beyond]


@dataclass(frozen=True)
class _Part:
    whole: Signals
    shown: NDArray[np.bool_]

    def __getitem__(self, name: str) -> Array:
        return self.whole[name][self.shown]
