"""Units of any origin, coupled: to the schemes what `System` is, rotor and balancers.

The units step in an order.  A signal to a unit that steps before its source is assumed over the
step (`forces`); any other is known at its end (`accelerations`).  With Jacobi all are assumed.  The
names are those of a rotor with balancers, which is the network that most runs are of.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from ctypes import c_void_p
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....models.cubic import hermite
from ...errors import SimulationError
from ...scene.unit import split_port
from ..foreign.abilities import abilities, kind_of
from ..signals import Cubics, Knots
from .member import Member
from .order import order_of
from .rows import MixedSignals, Reals, Rows
from .wiring import Wiring

MOST_GROWING_STEPS = 60  # one after the other, each by GROWTH: 300 times as much as before
GROWTH = 1.1
BRIEF = 1e-6  # of a step: what a step that is taken back may last


class Network:
    """Loaded units with their wiring.

    Args:
        units: by name, in the order of the scene.
        wiring: of them.
        parallel: all signals are assumed (Jacobi).
        order: highest of any signal over a step: 0 held, 1 linear, 3 cubic.

    Attributes:
        force_names: signals that are assumed over a step.
        can_restore: whether all units can be rolled back; `stuck` are those that cannot.
        is_free: whether all units take steps of any length.
        answers: what the assumed signals became in the last pass.
    """

    order = 3  # of the schemes; rows have their own

    def __init__(
        self, units: Mapping[str, Any], wiring: Wiring, parallel: bool = False, order: int = 3
    ) -> None:
        self.units, self.wiring, self.most = dict(units), wiring, math.inf
        self.sequence = list(units) if parallel else order_of(list(units), wiring.edges())
        place = {name: k for k, name in enumerate(self.sequence)}
        self.members = [Member(units[name], wiring) for name in self.sequence]
        owner = [place[split_port(signal)[0]] for signal in wiring.signals]
        assumed: set[int] = set()
        known: set[int] = set()
        for name, inlets in wiring.inlets.items():
            for signal, _ in (term for inlet in inlets for term in inlet.terms):
                back = parallel or owner[signal] >= place[name]
                (assumed if back else known).add(signal)
        self._assumed, self._known = sorted(assumed), sorted(known)
        orders = [min(order, 3 if slope else 1) for slope in wiring.has_slope]
        self._torn_rows = Rows([orders[k] for k in self._assumed])
        self._through_rows = Rows([orders[k] for k in self._known])
        self.forces = MixedSignals(self._torn_rows)
        self.accelerations = MixedSignals(self._through_rows)
        self.force_names = [wiring.signals[k] for k in self._assumed]
        self._orders = np.array(orders, int)
        for member in self.members:
            self._factors(member, place[member.unit.name], owner, parallel)
        self._states = [c_void_p() for _ in self.members]  # null: not saved yet
        self._brief: dict[str, c_void_p] = {}
        self.stuck = [
            m.unit.name for m in self.members if not abilities(m.unit.description).restores_state
        ]
        self.is_free = all(member.is_free for member in self.members)
        self._growing, self._largest = 0, 0.0

    def _factors(self, member: Member, own: int, owner: Sequence[int], parallel: bool) -> None:
        member.torn = np.zeros((len(member.inlets), len(self._assumed)))
        member.through = np.zeros((len(member.inlets), len(self._known)))
        for row, inlet in enumerate(member.inlets):
            for signal, factor in inlet.terms:
                if parallel or owner[signal] >= own:
                    member.torn[row, self._assumed.index(signal)] += factor
                else:
                    member.through[row, self._known.index(signal)] += factor

    @property
    def can_restore(self) -> bool:
        """Whether all units can be rolled back."""
        return not self.stuck

    @property
    def coupled(self) -> bool:
        """Whether there is a loop: something is assumed for a step and answered at its end."""
        return bool(self._assumed)

    @property
    def has_no_past(self) -> bool:
        """Whether no step has been taken since the start or the last jump of a drive."""
        return not self.forces.last_step

    def rotor_pass(self, forces: Cubics, time: float, step: float) -> Knots:
        """Step all units under assumed signals; ends of the known ones."""
        assumed = self._torn_rows.reals(forces)
        through = np.zeros((len(self._known), 4))
        start = self._through_rows.reals(self.accelerations.now)
        ends = np.zeros((len(self.wiring.signals), 2))
        for member in self.members:
            self._copy(member)
            member.send(member.torn @ assumed + member.through @ through, step)
            ends[member.sources] = self._stepped(member, assumed, through, time, step)
            for row in self._rows_of(member):
                end = ends[self._known[row]]
                through[row] = _path(start[row], end, step, self._orders[self._known[row]])
        self.answers = self._torn_rows.rows(ends[self._assumed])
        return self._through_rows.rows(ends[self._known])

    def _stepped(
        self, member: Member, assumed: Reals, through: Reals, time: float, step: float
    ) -> Reals:
        """Outputs of a unit that steps, its inputs set.

        One that integrates a held input and shows it too steps under the mean, and is read after a
        brief step with the input's end.  That is taken back, or, where it cannot be, the last part
        of the step.
        """
        unit = member.unit
        if not any(inlet.is_mixed for inlet in member.inlets):
            unit.step(time, step)
            return member.fetch()
        restores, brief = unit.name not in self.stuck, BRIEF * step
        left = step if restores else step - brief
        unit.step(time, left)
        state = self._brief.setdefault(unit.name, c_void_p())
        if restores:
            unit.save(state)
        member.send((member.torn @ assumed + member.through @ through) @ _to_end(step), 0.0)
        unit.step(time + left, brief)
        found = member.fetch()
        if restores:
            unit.restore(state)
        return found

    def balancer_pass(self, _accelerations: Cubics, _time: float, _step: float) -> Knots:
        """What the assumed signals have become in `rotor_pass`, where all units have stepped."""
        return self.answers

    def rotor_answer(self, forces: Cubics) -> Knots:
        """Known signals of units in initialisation mode under assumed ones."""
        assumed = self._torn_rows.reals(forces)
        through = np.zeros((len(self._known), 4))
        now = np.zeros((len(self.wiring.signals), 2))
        for member in self.members:
            self._copy(member)
            member.send(member.torn @ assumed + member.through @ through, 0.0)
            now[member.sources] = member.fetch()
            for row in self._rows_of(member):
                through[row, :2] = now[self._known[row]]
        self.answers = self._torn_rows.rows(now[self._assumed])
        self.accelerations.now = self._through_rows.rows(now[self._known])
        return self.accelerations.now

    def balancer_answer(self, _accelerations: Cubics) -> Knots:
        """What the assumed signals have become in `rotor_answer`."""
        return self.answers

    def refresh(self) -> None:
        """Take the signals as they are now, once all units have left initialisation mode.

        Units that compute nothing before then show their outputs here first.
        """
        now = np.zeros((len(self.wiring.signals), 2))
        for member in self.members:
            now[member.sources] = member.fetch()
        self.forces.now = self._torn_rows.rows(now[self._assumed])
        self.accelerations.now = self._through_rows.rows(now[self._known])
        self.drop_past()

    def _rows_of(self, member: Member) -> list[int]:
        return [row for row, signal in enumerate(self._known) if signal in member.sources]

    def _copy(self, member: Member) -> None:
        """Hand on whole numbers and Booleans as they are now."""
        for one in member.copied:
            sender = self.units[one.source_unit]
            value = sender.get(sender.group([one.source]))[0]
            member.unit.set(member.unit.group([one.target]), [one.factor * value])

    def save(self) -> None:
        """Keep the states of all units, for `restore`."""
        for member, state in zip(self.members, self._states, strict=True):
            member.unit.save(state)

    def restore(self) -> None:
        """Roll all units back to the states kept last."""
        for member, state in zip(self.members, self._states, strict=True):
            member.unit.restore(state)

    def exchange_states(self, states: list[c_void_p] | None = None) -> list[c_void_p]:
        """Take out the states kept last, and put others in their place, by default none.

        Those in whose place kept ones are put back are freed.
        """
        kept = self._states
        if states is None:
            self._states = [c_void_p() for _ in self.members]
            return kept
        for member, state in zip(self.members, kept, strict=True):
            member.unit.free(state)
        self._states = states
        return states

    def free_states(self) -> None:
        """Give back the memory of the states."""
        for member, state in zip(self.members, self._states, strict=True):
            member.unit.free(state)
        for name, state in self._brief.items():
            self.units[name].free(state)

    def accept(self, accelerations: Knots, forces: Knots, time: float, step: float) -> None:
        """Take over the ends of the signals of a finished step.

        Raises:
            SimulationError: they grow and grow: a step repeats its own error.
        """
        largest = float(np.abs(forces[:, 0]).max(initial=0.0))
        self._growing = self._growing + 1 if largest > GROWTH * self._largest > 0.0 else 0
        self._largest = max(largest, self._largest)
        if self._growing >= MOST_GROWING_STEPS or not largest <= self.most:
            raise SimulationError(
                f"{', '.join(self.force_names[:4])} grow without bound: {largest:.3g} at "
                f"t = {time:g} s, by 10 % or more in each of {self._growing} steps of {step:.3g} "
                'seconds: the coupling diverges; use scheme = "iterated", or smaller steps'
            )
        self.accelerations.accept(accelerations, step)
        self.forces.accept(forces, step)

    def drop_past(self) -> None:
        """Drop what the signals did before now: it says nothing of what comes."""
        self.accelerations.drop_past()
        self.forces.drop_past()
        self._growing, self._largest = 0, 0.0

    def follow(self, time: float, step: float) -> None:
        """Nothing: every unit takes part in every step."""

    def each(self, values: Reals, padding: float = 0.0) -> Reals:
        """(2 rows,) of the parts of all assumed rows, from (m,) of the assumed signals."""
        return self._torn_rows.each(values, padding)

    def read_ahead(self, members: Sequence[Member], time: float, step: float) -> None:
        """Have outputs follow held inputs to the end of a step: by a brief step, to be taken back.

        Args:
            members: units that `lag`; `go_back` takes them back.
            step: the brief one [s].
        """
        assumed, through = self.forces.now, self.accelerations.now
        ends = np.zeros((2, max(len(self._assumed), len(self._known)), 4))
        torn, known = ends[0, : len(self._assumed)], ends[1, : len(self._known)]
        torn[:, 0] = self._torn_rows.reals(assumed)[:, 0]
        known[:, 0] = self._through_rows.reals(through)[:, 0]
        for member in members:
            member.unit.save(self._states[self.members.index(member)])
            member.send(member.torn @ torn + member.through @ known, 0.0)
            member.unit.step(time, step)

    def go_back(self, members: Sequence[Member]) -> None:
        """Take back what `read_ahead` has done."""
        for member in members:
            member.unit.restore(self._states[self.members.index(member)])


def _to_end(step: float) -> NDArray[np.float64]:
    """What makes a polynomial over a step [s] a constant, its value at the end."""
    matrix = np.zeros((4, 4))
    matrix[:, 0] = [step**k / math.factorial(k) for k in range(4)]
    return matrix


def _path(start: Reals, end: Reals, step: float, order: int) -> Reals:
    """(4,) value and derivatives at the start of a step [s] of a signal between two knots."""
    if order == 0:
        return np.array([end[0], 0.0, 0.0, 0.0])
    if order == 1:
        return np.array([start[0], (end[0] - start[0]) / step, 0.0, 0.0])
    (value, slope), (after, slope_after) = start.tolist(), end.tolist()
    return np.array([value, slope, *hermite(value, slope, after, slope_after, step)])


def is_number(kind: str) -> bool:
    """Whether a variable of this type can be recorded."""
    return kind_of(kind) in ("real", "integer", "boolean")
