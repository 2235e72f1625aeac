"""A system of units of any origin, coupled in Python as a scene's separate units are.

The same loop, schemes and control of errors; what is not known of the units is found from their
descriptions and, where they can be rolled back, by trial steps at the start.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import UnitError
from ..scene.file import COMMANDS_OF
from ..scene.system import System
from ..scene.unit import fmu_path
from .compared import NEVER_HELD, Compared
from .coupled import FINER_FIRST
from .expectation import Expectation
from .facts import RunFacts
from .foreign.abilities import check_start
from .foreign.instance import ForeignUnit
from .foreign.versions import foreign_unit
from .network.network import Network, is_number
from .network.undriven import refuse_undriven
from .network.wired import wired
from .network.wiring import Wire
from .network.words import notes
from .network_run import LINEAR_ORDER, NetworkRun
from .recorder import Recorder

FIRST_STEPS = 100  # of a first run with a tolerance, at least
MOST_FIRST_STEPS = 20_000  # at most, however short the steps are that units suggest
RELATIVE_LEAST = 1e-9  # of what is measured in the same unit: below it a signal is cancellation
CUBIC_ORDER = 4  # of coupling by cubics from exact slopes
WHOLE = 1e-9  # relative: a number of steps so near to a whole one is one


class UnitRun(NetworkRun):
    """The units of a system, loaded and connected; restarted and stepped any number of times.

    Args:
        system: what to simulate; `scene` as an attribute.

    Raises:
        UnitError: an FMU is missing or wrong, or a connection does not fit.
    """

    def __init__(self, system: System) -> None:
        self.scene = system
        with ExitStack() as stack:
            self.units: dict[str, Any] = {}
            for number, unit in enumerate(system.unit, start=1):
                is_scene = Path(system.label).suffix not in COMMANDS_OF  # the file is named there
                key = f"{system.label}: unit[{number}].fmu" if is_scene else ""
                loaded = foreign_unit(fmu_path(unit.fmu, system.path), unit.name, key)
                self.units[unit.name] = stack.enter_context(loaded)
                check_start(loaded, unit.start)
            wires = [
                Wire(c.source, c.to, c.factor, f"{system.label}: connection[{number}]")
                for number, c in enumerate(system.connection, start=1)
            ]
            self.wiring = wired(self.units, wires)
            coupling = system.coupling
            parallel = coupling.scheme == "jacobi"
            self.system: Any = Network(self.units, self.wiring, parallel, coupling.order)
            stack.callback(self.system.free_states)
            self.refuse_stuck()
            self._stack = stack.pop_all()
        self.coupled = self.system.coupled
        self.gain = self.amplification = self.worst_residual = self.time = 0.0

    def start(
        self,
        changes: Mapping[str, Mapping[str, Any]] | None = None,
        attempt: int | None = None,
        parts: int = 1,
    ) -> None:
        """Restart all units from their start values, `changes` by unit name on top.

        Args:
            attempt: at a first run with a tolerance; each has more steps than the one before.
            parts: of every step of the first run, which this one repeats.

        Raises:
            SimulationError: a unit refuses its start values, or no consistent start exists.
            UnitError: a rotor speeds up, and nothing drives it.
        """
        self.time = self.worst_residual = 0.0
        self.steps = self.unconverged = 0
        self._parts = parts
        self._schedule = [self._first_schedule(attempt or 0)]
        step = self._schedule[0][0] / self._parts
        self._refuse_odd(step)
        self.system.free_states()
        starts = {u.name: {**u.start, **(changes or {}).get(u.name, {})} for u in self.scene.unit}
        refuse_undriven(self.scene.label, self.units, self.wiring, starts)
        for name, own in starts.items():
            self.units[name].restart(own)
        self.prepare(step)

    def _first_schedule(self, attempt: int) -> tuple[float, int]:
        """Length and number of the steps, before they are divided."""
        duration, step = self.scene.run.duration, self.scene.coupling.step
        if step is None:
            asked = [u.abilities.first_step for u in self.units.values() if u.abilities.first_step]
            most = duration / min(asked) if asked else 0.0
            step = duration / min(MOST_FIRST_STEPS, max(FIRST_STEPS, most)) / FINER_FIRST**attempt
            if base := self._fixed_step():
                doublings = max(0, math.floor(math.log2(step / base)) if step > base else 0)
                step = base * 2.0**doublings
        count = max(1, math.ceil(duration / step * (1.0 - WHOLE)))
        return duration / count, count

    def _fixed_step(self) -> float:
        return max((unit.abilities.fixed_step for unit in self.units.values()), default=0.0)

    def _refuse_odd(self, step: float) -> None:
        """Raise UnitError where a unit with a step of its own could not take such steps."""
        for unit in self.units.values():
            own = unit.abilities.fixed_step
            if own and abs(step / own - max(1, round(step / own))) > WHOLE * step / own:
                raise UnitError(
                    f"{unit.name}: {unit.path.name} has a fixed internal step of {own:g} s, and a "
                    f"communication step of {step:g} s is no multiple of it: give coupling.step "
                    "and run.duration as multiples"
                )

    def _bounds(self) -> list[float]:
        return [self.scene.run.duration]

    def recorded(self) -> list[str]:
        """Signals that the system asks for; by default all outputs."""
        if self.scene.run.record is not None:
            return list(self.scene.run.record)
        return [
            f"{name}.{v.name}"
            for name, unit in self.units.items()
            for v in unit.description.modelVariables
            if v.causality == "output" and is_number(v.type) and not v.dimensions
            and not v.name.startswith("der(")
        ]  # fmt: skip

    def compared(self) -> Compared:
        """What the runs of this motion are compared by: all real outputs that are connected."""
        expected = Expectation(
            order=CUBIC_ORDER if self.is_cubic else LINEAR_ORDER,
            steepest_order=math.inf,
            caution=1,
            ends_at_events=False,
            can_collide=False,
            fastest=0.0,
        )
        return Compared(expected, list(self.wiring.signals), _least, NEVER_HELD)

    def facts(self) -> RunFacts:
        """What the run since the last start did."""
        units: list[ForeignUnit] = list(self.units.values())
        kinds = units[0].calls
        return RunFacts(
            files=tuple(dict.fromkeys(unit.path.name for unit in units)),
            note="",
            messages=tuple(notes(self)),
            calls={kind: sum(unit.calls[kind] for unit in units) for kind in kinds},
            passes=units[0].calls["step"],
            steps=self.steps,
            unconverged=self.unconverged,
            worst_residual=self.worst_residual,
        )


def _least(recorder: Recorder) -> dict[str, float]:
    """By signal what its largest value is taken to be at least: a share of its kin's."""
    _, signals = recorder.columns()
    by_unit: dict[str, float] = {}
    for name, unit in recorder.signal_units.items():
        by_unit[unit] = max(by_unit.get(unit, 0.0), float(np.abs(signals[name]).max()))
    return {n: RELATIVE_LEAST * by_unit[unit] for n, unit in recorder.signal_units.items()}
