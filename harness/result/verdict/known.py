"""What is known of a machine at one speed before its run is looked at."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ....models.arrays import Array, Complex
from ....models.assembly import Assembly, weights_of
from ....models.harmonic_balance import NoResponse, largest_displacement, unbalance_response
from ....models.linear.balanced import CannotBalance, WeightTable, balanced_angles, check_reach
from ....models.linear.growth import Growth
from ....models.linear.off_centre import centred
from ....models.linear.on_race import OnRace, main_motion, rounded
from ....models.race import arms
from ....models.rotor import LinearRotor
from ...scene import Scene

BALANCED = 0.05  # of the vibration without balancers: a rotor that vibrates less is balanced
_NEAR = 0.1  # rad: weights rest there
SURELY_BEYOND = 1.5  # of the limit: least squares do not find the least of the largest


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
class Known:
    """Facts of a machine that turns at one speed.

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
    def balancing(self) -> Assembly:
        """The machine with round, centred tracks whose weights balance at the same angles, or near
        them.

        Raises:
            ArithmeticError, NoResponse: see `centred`.
        """
        return centred(rounded(self.assembly) if self.lobes else self.assembly, self.speed)

    @cached_property
    def lobes(self) -> float:
        """Largest amplitude of a race that is not round [m]; 0 where all are."""
        races = [weights_of(mounted).race for mounted in self.assembly.weights]
        return max((one.amplitude for race in races for one in race), default=0.0)

    @cached_property
    def _rest(self) -> tuple[OnRace, Array]:
        """On races with lobes, where weights rest next to where they are.

        Raises:
            ValueError, ArithmeticError: see `main_motion`.
        """
        found = main_motion(self.assembly, self.speed)
        if self.angles is None:
            return found
        machine, angles = found
        try:  # where the weights are there may be another rest, as good
            here = machine.rest_near(self.angles)
        except ArithmeticError:
            return found
        near = np.abs(here - self.angles).max() < _NEAR
        rates = np.linalg.eigvals(machine.linearised(here).at_speed(self.speed)).real
        better = np.abs(machine.whirl(here)).max() <= np.abs(machine.whirl(angles)).max()
        return (machine, here) if near and better and rates.max() < 0.0 else found

    @cached_property
    def off_centre(self) -> float:
        """Largest offset of the weights' tracks [m]."""
        return max((abs(mounted.offset) for mounted in self.assembly.weights), default=0.0)

    @cached_property
    def left_by_offsets(self) -> float:
        """Vibration that weights leave in balance on tracks off centre, or not round [m]."""
        if not (self.off_centre or self.lobes) or self.balanced_at is None:
            return 0.0
        return float(self.sizes(self.balanced_at)[0])

    @cached_property
    def loaded(self) -> LinearRotor:
        """The rotor with the balancers' masses."""
        return self.assembly.loaded_rotor

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

    @cached_property
    def reach(self) -> CannotBalance | None:
        """Why the weights cannot undo the unbalance; None where they can, or there are none."""
        if not len(self.table.angle):
            return None
        try:
            check_reach(self.balancing, self.table)
        except CannotBalance as error:
            return error
        except ArithmeticError:
            return None
        return None

    @property
    def exceeds_capacity(self) -> bool:
        """Whether it is the weights' moment that does not suffice."""
        return self.reach is not None and self.reach.needed > self.reach.capacity

    @cached_property
    def left_by_too_much(self) -> float:
        """Vibration by the least moment of a plane's weights beyond what is to balance [m]; 0
        where they can make less, as two alike do opposite each other."""
        found = self.reach
        if found is None or found.plane is None or not found.least > found.needed:
            return 0.0
        pull = self.assembly.rotor.planes[found.plane] * (found.least - found.needed)
        return size_of(self.response(pull.astype(complex)))

    @cached_property
    def least(self) -> float:
        """About the least steady vibration that moments in the weights' planes leave [m]."""
        used = self.assembly.rotor.planes[np.unique(self.table.plane)]
        by_plane = np.einsum("pj,jan->anp", used, self._unit_responses).reshape(-1, len(used))
        own = self.response(np.asarray(self.assembly.rotor.unbalance, complex))
        found, *_ = np.linalg.lstsq(by_plane, -own.ravel(), rcond=None)
        return size_of(own + (by_plane @ found).reshape(own.shape))

    @property
    def is_out_of_reach(self) -> bool:
        """Whether no moments in the weights' planes bring the vibration below the limit."""
        return self.reach is not None and self.least > SURELY_BEYOND * self.limit

    @cached_property
    def growth(self) -> Growth | None:
        """Of a small deviation from the balanced motion, rigid motions of a machine that nothing
        holds apart; None where it is not known."""
        from ....models.linear.rigid import growth_beside_rigid
        from ....models.stability import find_growth  # loads SciPy

        try:
            if self.scene.rotor.is_free:
                return growth_beside_rigid(self.balancing, self.speed)
            return find_growth(self.assembly if self.lobes else self.balancing, self.speed)
        except (ValueError, ArithmeticError):
            return None

    @property
    def is_damped(self) -> bool:
        """Whether anything damps the machine, however little."""
        from ....models.boundaries import unknown_word  # loads SciPy

        return unknown_word(self.assembly) == "undecided"

    @property
    def time_constant(self) -> float:
        """After which a deviation from the balanced motion has fallen to 1/e [s]; or infinite."""
        if self.growth is None or self.growth.state != "stable":
            return math.inf
        return -1.0 / self.growth.rate

    @cached_property
    def balanced_at(self) -> Array | None:
        """Angles of the weights (K,) in the balanced motion next to where they are [rad]."""
        try:
            if self.lobes:
                return self._rest[1]
            return balanced_angles(self.balancing)
        except (ValueError, ArithmeticError):
            return None

    @cached_property
    def slow_rate(self) -> float:
        """About |lambda| of the slowest small motion about balance [1/s]: of its average over a
        revolution, where supports are not alike."""
        from ....models.linear.linearised import linearise

        system, w = linearise(self.balancing) if not self.lobes else None, self.speed
        if system is None:
            machine, angles = self._rest
            system = machine.linearised(angles)
        values = np.linalg.eigvals(system.at_speed(w))
        slowest = values[values.real.argmax()] if len(values) else complex(-math.inf)
        return float(abs(slowest))

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


__all__ = ["BALANCED", "Known", "NoResponse", "vibration_alone"]
