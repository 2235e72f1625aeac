"""Units of any origin, coupled: to the schemes what `System` is, rotor and balancers.

The units step in an order.  A signal to a unit that steps before its source is assumed over the
step (`forces`); any other is known at its end (`accelerations`).  With Jacobi all are assumed.  The
names are those of a rotor with balancers, which is the network that most runs are of.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from ctypes import c_void_p
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import SimulationError
from ...scene.unit import split_port
from ..foreign.abilities import CUBIC, HELD, LINEAR, abilities, kind_of
from ..foreign.instance import UnitFailure
from ..names import derivatives
from ..signals import Cubics, Knots
from .order import order_of
from .rows import MixedSignals, Reals, Rows
from .wiring import Inlet, Wiring

MOST_GROWING_STEPS = 60  # one after the other, each by GROWTH: 300 times as much as before
GROWTH = 1.1
PROBE = 1e-3  # of an input's value, or in its unit: a disturbance that shows what depends on it
PROBE_SHARE = 1.0 / 8.0  # of a step: what integrates an input answers that much less
INTEGRATED = 1e-9  # share of the answer by which two lengths of a step must differ
BRIEF = 1e-6  # of a step: what a step that is taken back may last
DIRECT = 0.5  # share of the answer that must be left for the output to depend on it directly


class Member:
    """A unit among others: its inputs, its outputs, and where their values are.

    Attributes:
        sources: numbers of the signals that it sends.
        torn, through: (inlets, signals) factors of assumed signals and of known ones.
    """

    def __init__(self, unit: Any, wiring: Wiring) -> None:
        self.unit = unit
        self.inlets: list[Inlet] = wiring.inlets[unit.name]
        slots: list[str] = []
        for inlet in self.inlets:
            count = {HELD: 0, LINEAR: 1, CUBIC: 0 if inlet.by_call else 3}[inlet.takes]
            slots += derivatives(inlet.variable, count)
        self._inputs = unit.group(slots)
        self._slots = slots
        self._called = [k for k, inlet in enumerate(self.inlets) if inlet.by_call]
        self.sources = [k for k, s in enumerate(wiring.signals) if split_port(s)[0] == unit.name]
        outputs = [split_port(wiring.signals[k])[1] for k in self.sources]
        gives_ports = [f"der({name})" in unit.variables for name in outputs]
        slopes = [f"der({n})" for n, is_port in zip(outputs, gives_ports, strict=True) if is_port]
        self._outputs = unit.group([*outputs, *slopes])
        self._names = [wiring.signals[k] for k in self.sources]
        self._ports = [k for k, is_port in enumerate(gives_ports) if is_port]
        has = [wiring.has_slope[k] for k in self.sources]
        self._asked = [k for k in range(len(outputs)) if has[k] and not gives_ports[k]]
        self._asked_names = [outputs[k] for k in self._asked]
        self._every = [
            v.name
            for v in unit.description.modelVariables
            if v.causality == "output" and kind_of(v.type) == "real" and not v.dimensions
        ]
        self._all_outputs = unit.group(self._every)
        self.copied = wiring.copied[unit.name]
        own_abilities = abilities(unit.description)
        self.is_free = own_abilities.varies_step and not own_abilities.fixed_step
        self.torn = self.through = np.zeros((len(self.inlets), 0))

    def send(self, polynomials: Reals, step: float) -> None:
        """Set the inputs for a step [s]: (inlets, 4), value and derivatives at its start."""
        values: list[float] = []
        for inlet, polynomial in zip(self.inlets, polynomials.tolist(), strict=True):
            values += given(inlet, polynomial, step)
        if values:
            self.unit.set(self._inputs, values)
        if self._called and step:
            names = [self.inlets[k].variable for k in self._called for _ in range(3)]
            found = [d for k in self._called for d in polynomials[k, 1:].tolist()]
            self.unit.set_derivatives(names, [1, 2, 3] * len(self._called), found)

    def lags(self, recorded: Collection[str]) -> bool:
        """Whether one of some outputs shows a held input, which stands at the mean of the step."""
        return any(
            inlet.takes == HELD and inlet.holds_mean and inlet.shows_in & set(recorded)
            for inlet in self.inlets
        )

    def every_output(self) -> NDArray[np.float64]:
        """Values of all real outputs."""
        self.unit.fetch(self._all_outputs)
        return np.array(self._all_outputs.reals)

    def learn(self, inlet: Inlet, long: NDArray[np.float64], short: NDArray[np.float64]) -> None:
        """What changes of all real outputs in a step and in a shorter one say of an input."""
        size = np.abs(long)
        direct = (np.abs(short) > DIRECT * size) & (size > 0.0)
        inlet.shows_in |= {n for n, shown in zip(self._every, direct, strict=True) if shown}
        own = {split_port(name)[1] for name in self._names}
        inlet.is_direct, inlet.is_tried = bool(inlet.shows_in & own), True
        changed = np.abs(long - short).max(initial=0.0) > INTEGRATED * size.max(initial=0.0)
        inlet.is_mixed = inlet.is_direct and bool(changed) and self.is_free

    def fetch(self) -> Reals:
        """(sources, 2) values and slopes of the outputs as they are now; 0 for unknown slopes.

        Raises:
            SimulationError: one is no number.
        """
        knots = np.zeros((len(self.sources), 2))
        if not self.sources:
            return knots
        self.unit.fetch(self._outputs)
        values = np.asarray(self._outputs.reals)
        knots[:, 0] = values[: len(self.sources)]
        knots[self._ports, 1] = values[len(self.sources) :]
        if self._asked and self.unit.time > 0.0:
            knots[self._asked, 1] = self.unit.derivatives(self._asked_names)
        if not np.isfinite(knots).all():
            bad = self._names[int(np.argmin(np.isfinite(knots).all(axis=1)))]
            raise UnitFailure(
                f"{bad} is no finite number at t = {self.unit.time:g} s: {self.unit.path.name} "
                "has failed without saying so, or steps are too long for the coupling"
            )
        return knots


def given(inlet: Inlet, polynomial: Sequence[float], step: float) -> list[float]:
    """What an input is set to for a signal over a step [s], by value and derivatives at its start.

    A held input takes the signal's mean over the step, so that what is integrated errs by the
    square of the step; one that is only shown directly takes the end, where it is read.
    """
    value, first, second, third = polynomial
    if inlet.takes == CUBIC:
        return [value] if inlet.by_call else list(polynomial)
    end = value + step * (first + step * (second / 2.0 + step * third / 6.0))
    if inlet.takes == LINEAR:
        return [value, (end - value) / step if step else first]
    if inlet.holds_mean:
        return [value + step * (first / 2.0 + step * (second / 6.0 + step * third / 24.0))]
    return [end]


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
            member.unit.step(time, step)
            ends[member.sources] = self._shown(member, assumed, through, time, step)
            for row in self._rows_of(member):
                end = ends[self._known[row]]
                through[row] = _path(start[row], end, step, self._orders[self._known[row]])
        self._answers = self._torn_rows.rows(ends[self._assumed])
        return self._through_rows.rows(ends[self._known])

    def _shown(
        self, member: Member, assumed: Reals, through: Reals, time: float, step: float
    ) -> Reals:
        """Outputs of a unit that has stepped.

        One that integrates a held input and shows it too is read after a brief step with the
        input's end, which is taken back: it has stepped under the mean.
        """
        if not any(inlet.is_mixed for inlet in member.inlets):
            return member.fetch()
        state = self._brief.setdefault(member.unit.name, c_void_p())
        member.unit.save(state)
        ends = (member.torn @ assumed + member.through @ through) @ _to_end(step)
        member.send(ends, 0.0)
        member.unit.step(time + step, BRIEF * step)
        found = member.fetch()
        member.unit.restore(state)
        return found

    def balancer_pass(self, _accelerations: Cubics, _time: float, _step: float) -> Knots:
        """What the assumed signals have become in `rotor_pass`, where all units have stepped."""
        return self._answers

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
        self._answers = self._torn_rows.rows(now[self._assumed])
        self.accelerations.now = self._through_rows.rows(now[self._known])
        return self.accelerations.now

    def balancer_answer(self, _accelerations: Cubics) -> Knots:
        """What the assumed signals have become in `rotor_answer`."""
        return self._answers

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

    def probe(self, step: float) -> None:
        """Find by trial steps what is not declared: which held inputs act on outputs directly.

        An input that is integrated changes an output by less in a shorter step; one that acts
        directly changes it by as much.  Needs units that can be rolled back; of others every input
        counts as direct.
        """
        if not self.can_restore:
            return
        for member in self.members:
            unknown = [i for i in member.inlets if i.takes == HELD and i.is_direct is not False]
            if not unknown:
                continue
            answers = [_answers(member, unknown, length) for length in (step, PROBE_SHARE * step)]
            for inlet, long, short in zip(unknown, *answers, strict=True):
                member.learn(inlet, long, short)


def _answers(member: Member, inlets: Sequence[Inlet], step: float) -> list[NDArray[np.float64]]:
    """How a unit's outputs change in a step when each of some inputs is changed; taken back."""
    unit, state = member.unit, c_void_p()
    unit.save(state)
    try:

        def after() -> NDArray[np.float64]:
            unit.step(unit.time, step)
            found = member.every_output()
            unit.restore(state)
            return found

        before, found = after(), []
        for inlet in inlets:
            group = unit.group([inlet.variable])
            value = unit.get(group)[0]
            unit.set(group, [value + PROBE * max(1.0, abs(value))])
            found.append(after() - before)
            unit.set(group, [value])
    finally:
        unit.restore(state)
        unit.free(state)
    return found


def _to_end(step: float) -> NDArray[np.float64]:
    """What makes a polynomial over a step [s] a constant, its value at the end."""
    matrix = np.zeros((4, 4))
    matrix[:, 0] = [step**k / math.factorial(k) for k in range(4)]
    return matrix


def _path(start: Reals, end: Reals, step: float, order: int) -> Reals:
    """(4,) value and derivatives at the start of a step [s] of a signal between two knots."""
    if order == 0:
        return np.array([end[0], 0.0, 0.0, 0.0])
    slope = (end[0] - start[0]) / step
    if order == 1:
        return np.array([start[0], slope, 0.0, 0.0])
    second = (6.0 * slope - 4.0 * start[1] - 2.0 * end[1]) / step
    third = (6.0 * (start[1] + end[1]) - 12.0 * slope) / step**2
    return np.array([start[0], start[1], second, third])


def is_number(kind: str) -> bool:
    """Whether a variable of this type can be recorded."""
    return kind_of(kind) in ("real", "integer", "boolean")
