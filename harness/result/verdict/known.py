"""What is known of a machine at one speed before its run: whether it can balance, and stay so."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ....models.arrays import Array
from ....models.assembly import Assembly
from ....models.linear.balanced import CannotBalance, balanced_angles, check_reach
from ....models.linear.growth import Growth
from ....models.linear.off_centre import centred
from ....models.linear.on_race import OnRace, main_motion, rounded
from .steady import Steady, size_of

_NEAR = 0.1  # rad: weights rest there
_TRIED = 8  # other positions of balance that are tried
SURELY_BEYOND = 1.5  # of the limit: least squares do not find the least of the largest


@dataclass(frozen=True, eq=False)
class Known(Steady):
    """Facts of a machine that turns at one speed: whether its weights can balance it, and whether
    that motion is stable."""

    @cached_property
    def balancing(self) -> Assembly:
        """The machine with round, centred tracks whose weights balance at the same angles, or near
        them.

        Raises:
            ArithmeticError, NoResponse: see `centred`.
        """
        return centred(rounded(self.assembly) if self.lobes else self.assembly, self.speed)

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
    def left_by_offsets(self) -> float:
        """Vibration that weights leave in balance on tracks off centre, or not round [m]."""
        if not (self.off_centre or self.lobes) or self.balanced_at is None:
            return 0.0
        return float(self.sizes(self.balanced_at)[0])

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
    def is_unstable(self) -> bool:
        """Whether a deviation from the balanced motion next to where the weights are grows."""
        return self.growth is not None and self.growth.state == "unstable"

    @cached_property
    def others_are_stable(self) -> bool:
        """Whether the weights balance in other positions too, of which one at least is stable.

        Three weights in a plane balance at many angles, which can differ in stability.
        """
        count = len(self.table.angle)
        if self.lobes or count <= 2 * len(np.unique(self.table.plane)):
            return False
        random = np.random.default_rng(0)
        tried = (replace(self, angles=random.uniform(0.0, math.tau, count)) for _ in range(_TRIED))
        return any(one.growth and one.growth.state == "stable" for one in tried)

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
