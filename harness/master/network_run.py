"""What runs of units of any origin have in common: a start by trial steps, and whole records."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import UnitError
from .coupled import Coupled
from .foreign.abilities import CUBIC, abilities
from .loop import consistent_start, value_eigenvalues
from .network.network import BRIEF, Member
from .network.wiring import Wiring
from .recorder import Recorder
from .schemes.explicit import Scheme
from .schemes.gauss_seidel import GaussSeidel
from .schemes.iterated_each import IteratedEach
from .schemes.jacobi import Jacobi

if TYPE_CHECKING:
    from ..output.workers import Progress

AGREEMENT = 1e-9  # at the start: solvers inside units are no better
UNKNOWN_SIZE = 1e-3  # disturbance at the start of a signal that is zero, in its own unit
SETTLING = 1e-3  # of a step: what a brief step at the start lasts
NAMES = {Jacobi: "jacobi", GaussSeidel: "gauss-seidel", IteratedEach: "iterated"}


class NetworkRun(Coupled):
    """Units and their connections, some or all of them of any origin.

    Attributes:
        scene: what is run; its `coupling` has `scheme` and `corrections`.
        units: by name; `wiring` their connections.
    """

    scene: Any
    system: Any
    units: dict[str, Any]
    wiring: Wiring
    scheme: Scheme

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
        system = self.system
        rows = len(system.forces.now)
        change = np.full(4 * rows, UNKNOWN_SIZE)
        slopes = consistent_start(system, step, 0.0, change, AGREEMENT)
        for unit in self.units.values():
            unit.start()
        system.refresh()
        eigenvalues = value_eigenvalues(slopes[: slopes.shape[1]])
        self.scheme = self._chosen(rows, step)
        if self.wiring.signals:
            system.probe(step)
        if system.coupled and system.can_restore:
            self._settle(rows, SETTLING * step)
            trial = IteratedEach(rows, step)
            trial.after_start(system, self.time, step)
            eigenvalues = value_eigenvalues(trial.jacobian)
            if isinstance(self.scheme, IteratedEach):
                self.scheme.newton = trial.newton
        self.gain = max(map(abs, eigenvalues), default=0.0)
        explicit = system.coupled and not isinstance(self.scheme, IteratedEach)
        self.amplification = self.gain if explicit else 0.0

    def _settle(self, rows: int, brief: float) -> None:
        """Bring signals of units that show nothing before a step into agreement at the start.

        By two brief steps, iterated and taken back; without them a first step would cost an order.
        The first one brings the values together, the second one shows slopes without a jump.

        Args:
            brief: their length [s].
        """
        system = self.system
        scheme = IteratedEach(rows, brief)
        scheme.after_start(system, self.time, brief)
        system.save()
        states = system.exchange_states()  # of the start; steps keep their own
        for number in range(2):
            time = self.time + number * brief
            residual = scheme.step(system, time, brief)
            scheme.check_agreement(system, time, residual)
            system.drop_past()
        system.exchange_states(states)
        system.restore()

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
        super().record(recorder, progress)

    def _record_row(self, recorder: Recorder) -> None:
        step = BRIEF * self._schedule[0][0] / self._parts
        lagging = self._lagging if self.time > 0.0 else self._unsettled()
        self.system.read_ahead(lagging, self.time, step)
        super()._record_row(recorder)
        self.system.go_back(lagging)


def _can_be_read(member: Member, outputs: set[str]) -> bool:
    """Whether outputs lag, and a brief step that is taken back shows where they are."""
    own = abilities(member.unit.description)
    free = own.restores_state and own.varies_step and not own.fixed_step
    return free and member.lags(outputs)
