"""The machine of a scene as the models take it: assembly, drive, rest under gravity."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

from ...models.arrays import Numbers
from ...models.assembly import Assembly, SpeedProfile
from ...models.rotor import LinearRotor
from .refusals import Refusals
from .run import FEWEST_REVOLUTIONS

if TYPE_CHECKING:
    from .rotor import Rotor
    from .run import Run


class Machine(Refusals):
    """A scene whose tables are made into what the models compute with."""

    if TYPE_CHECKING:  # a key of the scene
        run: Run

    @cached_property
    def _linear_rotor(self) -> LinearRotor:
        return replace(self.rotor.build(), gravity=self.operation.field)

    @cached_property
    def _assembly(self) -> Assembly:
        field, times = self.operation.field, [c.time for c in self.operation.unbalance_changes]
        later = [replace(rotor.build(), gravity=field) for rotor in self._rotors[1:]]
        balancers = tuple(b.build() for b in self.balancer)
        return Assembly(self._linear_rotor, balancers, tuple(zip(times, later, strict=True)))

    @cached_property
    def _rotors(self) -> list[Rotor]:
        """The rotor's table at the start, and after every change of its unbalance."""
        found = [self.rotor]
        for c in self.operation.unbalance_changes:
            found.append(found[-1].with_unbalance(c.number, c.amount, c.angle))
        return found

    def rotor_at(self, time: float) -> Rotor:
        """The rotor's table with the unbalance that it has from `time` [s] on."""
        passed = sum(change.time <= time for change in self.operation.unbalance_changes)
        return self._rotors[passed]

    @cached_property
    def _profile(self) -> SpeedProfile:
        return self.operation.speeds()

    def assembly(self) -> Assembly:
        """The rotor with its balancers, for the models; what is not linear in its supports as it
        acts on small motions about rest: stops and dampers with a free stroke not at all, cubic
        springs by the sag.

        >>> len(ab.load("two_balls").assembly().weights)
        1
        """
        if not (self.rotor.is_restrained or self.rotor.has_free_strokes):
            return self._assembly
        return self._about_rest

    @cached_property
    def _about_rest(self) -> Assembly:
        from ...models.restraints import about_rest  # loads SciPy, which few scenes need

        return about_rest(self._assembly, self.profile().end)

    def restrained_assembly(self) -> Assembly:
        """The same with cubic springs, stops and free strokes."""
        return self._assembly

    def touched_at_rest(self) -> tuple[int, ...]:
        """Numbers of the stops, from 0, that the sag under gravity reaches."""
        if not (self.rotor.stops and self.operation.gravity):
            return ()
        from ...models.restraints import at_rest

        return at_rest(self._assembly.loaded_rotor, self.profile().end).touching

    def rest_at(self, speed: float) -> Numbers:
        """x and y (2, n) of every station of the loaded rotor at rest under gravity [m].

        Args:
            speed: of the rotor [rad/s].
        """
        rotor = self._assembly.loaded_rotor
        if not rotor.cubics:
            return rotor.rest_position(speed)
        from ...models.restraints import at_rest

        return at_rest(rotor, speed).sag

    def profile(self) -> SpeedProfile:
        """Speed against time; of a motor its no-load speed, which scales and steps go by.

        >>> ab.load("run_up").profile().end
        150.0
        """
        return self._profile

    @property
    def runs_its_profile(self) -> bool:
        """Whether the run ends where its profile does, as its length is left open."""
        given = "revolutions" in self.run.model_fields_set or self.run.duration is not None
        return bool(self.operation.profile) and not given

    @property
    def revolutions(self) -> float:
        """Of the whole run; with a motor as many as its no-load speed would make."""
        if self.run.duration is not None:
            turned = self.profile().angle(self.run.duration) / math.tau
            return max(FEWEST_REVOLUTIONS, turned)
        if not self.runs_its_profile:
            return self.run.revolutions
        return self.profile().angle(self.profile().seconds) / math.tau
