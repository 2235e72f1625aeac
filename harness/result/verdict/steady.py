"""The steady vibration of a machine that turns at one speed, by what its weights leave."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ....models.arrays import Array, Complex
from ....models.assembly import Assembly, weights_of
from ....models.harmonic_balance import largest_displacement, unbalance_response
from ....models.linear.weight_table import WeightTable
from ....models.race import arms
from ....models.rotor import LinearRotor
from ...scene import Scene

BALANCED = 0.05  # of the vibration without balancers: a rotor that vibrates less is balanced


def vibration_alone(scene: Scene, speed: float, end: float) -> float:
    """Largest distance of a station of the rotor without balancers from the middle [m].

    Raises:
        NoResponse: see `unbalance_response`.
    """
    return size_of(unbalance_response(scene.assembly().at(end).rotor, [speed])[0])


def size_of(displacement: Complex) -> float:
    """Largest half axis of the stations' ellipses (2, n) [m]."""
    return float(largest_displacement(displacement[None]).max())


@dataclass(frozen=True, eq=False)
class Steady:
    """A machine that turns at one speed, and its vibration with the weights at any angles.

    Attributes:
        scene: the machine.
        time: of its unbalance, where that changes [s].
        speed: of the rotor [rad/s].
        angles: of all weights (K,) [rad], next to which the balanced motion is looked for; None:
            where they start.
    """

    scene: Scene
    time: float
    speed: float
    angles: Array | None = None

    @cached_property
    def assembly(self) -> Assembly:
        """With the weights where they are."""
        found = self.scene.assembly().at(self.time).at_speed(self.speed)
        if self.angles is None:
            return found
        left, balancers = self.angles.tolist(), []
        for mounted in found.balancers:
            own, left = left[: len(mounted.angles)], left[len(mounted.angles) :]
            balancers.append(replace(mounted, angles=tuple(own)) if own else mounted)
        return replace(found, balancers=tuple(balancers))

    @cached_property
    def table(self) -> WeightTable:
        """Every weight."""
        return WeightTable.of(self.assembly)

    @cached_property
    def lobes(self) -> float:
        """Largest amplitude of a race that is not round [m]; 0 where all are."""
        races = [weights_of(mounted).race for mounted in self.assembly.weights]
        return max((one.amplitude for race in races for one in race), default=0.0)

    @cached_property
    def off_centre(self) -> float:
        """Largest offset of the weights' tracks [m]."""
        return max((abs(mounted.offset) for mounted in self.assembly.weights), default=0.0)

    @cached_property
    def loaded(self) -> LinearRotor:
        """The rotor with the balancers' masses."""
        return self.assembly.loaded_rotor

    @cached_property
    def critical(self) -> float:
        """Lowest critical speed with the balancers' masses [rad/s]."""
        return float(np.abs(self.assembly.resting_rotor.at_bottom.free_rates(0.0)).min())

    @cached_property
    def natural(self) -> Array:
        """Natural frequencies of the loaded rotor at this speed, ascending [rad/s]."""
        found = np.abs(self.loaded.free_rates(self.speed).imag)
        found = np.sort(found[found > 0.0])
        apart = np.append(True, np.diff(found) > 1e-9 * found[1:]) if len(found) else found
        return found[apart.astype(bool)]

    @cached_property
    def alone(self) -> float:
        """Vibration of the rotor without balancers [m].

        Raises:
            NoResponse: it is not known.
        """
        return vibration_alone(self.scene, self.speed, self.time)

    @property
    def limit(self) -> float:
        """Vibration up to which the rotor is balanced [m]."""
        return BALANCED * self.alone

    @cached_property
    def _unit_responses(self) -> Complex:
        """Motion (n, 2, n) of all stations by a unit of unbalance at each [m/(kg m)]."""
        each, own = np.eye(self.loaded.stations, dtype=complex), self.assembly.rotor.stations
        return np.array(
            [
                unbalance_response(replace(self.loaded, unbalance=u, beside=()), [self.speed])[
                    0, :, :own
                ]
                for u in each[:own]  # behind them stand waves of liquid
            ]
        )

    def moments(self, angles: Array) -> Complex:
        """Unbalance (..., n) that weights at `angles` (..., K) leave at the stations [kg m]."""
        planes = self.assembly.rotor.planes
        pulls = planes[self.table.plane] * self.table.moment[:, None]
        turns = np.exp(1j * angles) * self._arms(angles) if self.lobes else np.exp(1j * angles)
        left = self.assembly.rotor.unbalance + turns @ pulls
        for mounted in self.assembly.weights:  # masses on tracks that are off centre
            mass = mounted.device.added_mass
            left = left + mass * mounted.offset * planes[mounted.plane]
        return np.asarray(left)

    def _arms(self, angles: Array) -> Array:
        """Distance of weights at `angles` (..., K) from their track's centre over the radius."""
        devices = [weights_of(mounted) for mounted in self.assembly.weights]
        ends = np.cumsum([device.count for device in devices])[:-1]
        parts = np.split(np.asarray(angles), ends, axis=-1)
        return np.concatenate(
            [arms(d, part) / d.track_radius for d, part in zip(devices, parts, strict=True)],
            axis=-1,
        )

    def response(self, moments: Complex) -> Complex:
        """Steady motion (2, n) of the loaded rotor by an unbalance (n,): x = Re(found e^{i beta}).

        Raises:
            NoResponse: see `unbalance_response`.
        """
        if self.loaded.sliders:
            own = self.assembly.rotor.stations
            there = np.zeros(self.loaded.stations, complex)
            there[:own] = moments
            rotor = replace(self.loaded, unbalance=there)
            return unbalance_response(rotor, [self.speed])[0, :, :own]
        return np.einsum("j,jan->an", moments, self._unit_responses)

    def sizes(self, angles: Array) -> Array:
        """Steady vibration (T,) by the unbalance that weights at `angles` (T, K) leave [m]."""
        moments = self.moments(np.atleast_2d(angles))
        if self.loaded.sliders:
            return np.array([size_of(self.response(each)) for each in moments])
        motion = np.einsum("tj,jan->tan", moments, self._unit_responses)
        return largest_displacement(motion).max(axis=1)

    def size_of_turns(self, turns: Sequence[float] | Array) -> float:
        """Steady vibration by turns of the weights (K,) [rad] away from balance, at most [m]."""
        planes = self.assembly.rotor.planes
        pulls = planes[self.table.plane] * (self.table.moment * np.abs(turns))[:, None]
        if self.loaded.sliders:
            return size_of(self.response(pulls.sum(axis=0).astype(complex)))
        each = np.einsum("kj,jan->kan", pulls, self._unit_responses)
        return float(largest_displacement(each).sum(axis=0).max())
