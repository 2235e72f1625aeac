"""What runs of units of any origin have in common: a start by trial steps, and whole records."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import UnitError
from .coupled import Coupled
from .foreign.abilities import CUBIC, abilities
from .foreign.failures import EndAsked, UnitFailure
from .loop import QuasiNewton, consistent_start, rescaled, value_eigenvalues
from .network.member import Member
from .network.network import BRIEF
from .network.trials import Ahead, probe
from .network.wiring import Wiring
from .recorder import Recorder
from .schemes.explicit import Scheme
from .schemes.gauss_seidel import GaussSeidel
from .schemes.iterated_each import IteratedEach
from .schemes.jacobi import Jacobi

if TYPE_CHECKING:
    from ..output.workers import Progress

LINEAR_ORDER = 2  # of coupling by lines or means
AGREEMENT = 1e-9  # at the start: solvers inside units are no better
UNKNOWN_SIZE = 1e-3  # disturbance at the start of a signal that is zero, in its own unit
SETTLING = 1e-3  # of a step: what a short step at the start lasts
AHEAD_CORRECTIONS = 3  # of such a step that cannot be taken back
AT_ONCE = 1e-2  # loop gain from which explicit schemes make signals consistent
JUMP = 2.0  # change in a first brief step over that in a second one, of what jumps
NAMES = {Jacobi: "jacobi", GaussSeidel: "gauss-seidel", IteratedEach: "iterated"}


class NetworkRun(Coupled):
    """Units and their connections, some or all of them of any origin.

    Attributes:
        scene: what is run; its `coupling` has `scheme` and `corrections`.
        units: by name; `wiring` their connections.
        ended: which unit asked to end the last run before its end, as a sentence.
    """

    scene: Any
    system: Any
    units: dict[str, Any]
    wiring: Wiring
    scheme: Scheme
    ended = ""

    def refuse_stuck(self) -> None:
        """Raise UnitError where states are to be restored that a unit does not restore."""
        stuck, coupling = self.system.stuck, self.scene.coupling
        if stuck and self.system.coupled and coupling.scheme == "iterated":
            raise UnitError(
                f'{self.scene.label}: coupling.scheme = "iterated": {", ".join(stuck)} cannot '
                'restore a state (canGetAndSetFMUstate is false): use "gauss-seidel" or "auto"'
            )

    def prepare(self, step: float) -> None:
        """Bring units in initialisation mode to a consistent start, and make the scheme.

        Args:
            step: communication step to come [s].

        Raises:
            SimulationError: no consistent start exists, or a unit refuses its start values.
        """
        system, self._used = self.system, 0.0
        rows = len(system.forces.now)
        change = np.full(4 * rows, UNKNOWN_SIZE)
        slopes = consistent_start(system, step, 0.0, change, AGREEMENT)
        jacobian = slopes[: slopes.shape[1]]
        for unit in self.units.values():
            unit.start()
        system.refresh()
        self.scheme = self._chosen(rows, step)
        if system.can_restore and self.wiring.signals:
            probe(system, step)
        if system.coupled and system.is_free:
            jacobian = self._settle(rows, step)
        self.amplification = 0.0
        iterates = isinstance(self.scheme, IteratedEach)
        if system.coupled and (iterates or (system.can_restore and not system.is_free)):
            trial = IteratedEach(rows, step)
            trial.after_start(system, self.time, step)
            jacobian = trial.jacobian
        self.gain = max(map(abs, value_eigenvalues(jacobian)), default=0.0)
        if isinstance(self.scheme, IteratedEach):
            self.scheme.newton = QuasiNewton(jacobian, step)
        elif self.gain > AT_ONCE:  # below, a scheme is what its name says
            self.scheme.loop = QuasiNewton(jacobian, step)

    def _settle(self, rows: int, step: float) -> NDArray[np.float64]:
        """Bring signals of units that show nothing before a step into agreement at the start.

        By two brief steps, iterated; without them a first step would cost an order.  The first one
        brings the values together, the second one shows slopes without a jump.  They are taken back
        where units can be; else they are a part of the first step.

        Args:
            step: communication step to come [s].

        Returns:
            The loop's Jacobian, of what acts at once, for that step.
        """
        if not self.system.can_restore:
            return rescaled(self._settle_ahead(rows, BRIEF * step), 1.0 / BRIEF)
        brief = SETTLING * step
        scheme = IteratedEach(rows, brief)
        scheme.after_start(self.system, self.time, brief)
        self.system.save()
        states = self.system.exchange_states()  # of the start; steps keep their own
        for number in range(2):
            time = self.time + number * brief
            residual = scheme.step(self.system, time, brief)
            scheme.check_agreement(self.system, time, residual)
            self.system.drop_past()
        self.system.exchange_states(states)
        self.system.restore()
        return rescaled(scheme.jacobian, 1.0 / SETTLING)

    def _settle_ahead(self, rows: int, brief: float) -> NDArray[np.float64]:
        """The same by steps that are not taken back.

        Args:
            brief: their length [s].
        """
        ahead: Any = Ahead(self.system, self.time, brief)
        ahead.probe()
        jacobian = ahead.jacobian()
        scheme, last = IteratedEach(rows, brief, AHEAD_CORRECTIONS), GaussSeidel()
        scheme.newton, last.loop = (QuasiNewton(jacobian, brief) for _ in range(2))
        for _ in range(2):
            scheme.step(ahead, ahead.time, brief)
            ahead.drop_past()
        self._used, self._brief_step = ahead.time - self.time, partial(last.step, ahead)
        return jacobian

    def _cover(self, step: float) -> None:
        """A communication step; the first one less what has been used of it, after a jump.

        An explicit scheme without a past begins with a short step, from which it extrapolates.
        """
        begin = self.time
        self.time += self._used
        left = step - self._used
        self._used = 0.0
        left -= self._cross_jump(left)
        explicit = self.coupled and not isinstance(self.scheme, IteratedEach)
        if explicit and self.system.is_free and self.system.has_no_past:
            self._advance_part(SETTLING * left)
            left -= SETTLING * left
        self._advance_part(left)
        self.time = begin + step

    def _chosen(self, rows: int, step: float) -> Scheme:
        coupling = self.scene.coupling
        if coupling.scheme == "jacobi":
            return Jacobi()
        iterates = coupling.scheme in ("auto", "iterated") and self.system.can_restore
        if not iterates or not self.system.coupled:
            return GaussSeidel()
        return IteratedEach(rows, step, coupling.corrections)

    @property
    def scheme_name(self) -> str:
        """As it is called in a scene."""
        return NAMES[type(self.scheme)]

    @property
    def is_cubic(self) -> bool:
        """Whether all coupled signals are cubics from exact slopes, as between our own units."""
        inlets = [inlet for each in self.wiring.inlets.values() for inlet in each]
        return all(self.wiring.has_slope) and all(inlet.takes == CUBIC for inlet in inlets)

    def _unsettled(self) -> list[Member]:
        """Units in loops, whose outputs at the start need not know their inputs yet.

        What nobody listens to is in none.
        """
        if not (self.system.coupled and self.system.can_restore):
            return []
        return [m for m in self.system.members if m.is_free and m.inlets and m.sources]

    def record(self, recorder: Recorder, progress: Progress | None) -> None:
        """`Coupled.record`, with outputs as they are at each point, not at the mean of a step."""
        outputs: dict[str, set[str]] = {name: set() for name in self.units}
        for signal in recorder.signal_units:
            unit, _, variable = signal.partition(".")
            outputs[unit].add(variable)
        self._lagging = [m for m in self.system.members if _can_be_read(m, outputs[m.unit.name])]
        self.ended = ""
        try:
            super().record(recorder, progress)
        except EndAsked as error:
            self.ended = f"{error}: the run ends there"

    def _record_row(self, recorder: Recorder) -> None:
        brief = BRIEF * self._schedule[0][0] / self._parts
        if self.time > 0.0:
            values = self._ahead(recorder, self._lagging, self.time, brief)
        else:
            values = self._first_row(recorder, brief)
        if not np.isfinite(values).all():
            name = list(recorder.signal_units)[int(np.argmin(np.isfinite(values)))]
            unit = self.units[name.partition(".")[0]]
            raise UnitFailure(
                f"{name} is no finite number at t = {self.time:g} s: {unit.path.name} has failed "
                "without saying so; leave it out of run.record if that is meant"
            )
        recorder.append(self.time, values)

    def _ahead(
        self, recorder: Recorder, members: Sequence[Member], time: float, brief: float
    ) -> NDArray[np.float64]:
        """Values behind a brief step [s] of some units, which is taken back."""
        self.system.read_ahead(members, time, brief)
        found = recorder.values()
        self.system.go_back(members)
        return found

    def _first_row(self, recorder: Recorder, brief: float) -> NDArray[np.float64]:
        """Values at the start, some of which show their inputs in a step alone.

        Two brief steps tell where those were before them; what does not jump in the first one is
        as it is.
        """
        if self._used:  # units that cannot be rolled back have gone ahead
            one = recorder.values()
            self._brief_step(self.time + self._used, brief)
            self.system.drop_past()
            self._used += brief
            return np.asarray(one - (recorder.values() - one) * (self._used / brief - 1.0))
        now, members = recorder.values(), self._unsettled()
        if not members:
            return now
        one, two = (self._ahead(recorder, members, self.time, k * brief) for k in (1.0, 2.0))
        jumps = np.abs(one - now) > JUMP * np.abs(two - one)
        return np.asarray(np.where(jumps, 2.0 * one - two, now))


def _can_be_read(member: Member, outputs: set[str]) -> bool:
    """Whether outputs lag, and a brief step that is taken back shows where they are."""
    restores = abilities(member.unit.description).restores_state
    return restores and member.is_free and member.lags(outputs)
