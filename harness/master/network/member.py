"""A unit among others: its inputs, its outputs, and where their values are."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...scene.unit import split_port
from ..foreign.abilities import CUBIC, HELD, LINEAR, abilities, kind_of
from ..foreign.failures import UnitFailure
from ..names import derivatives
from .rows import Reals
from .wiring import Inlet, Wiring

INTEGRATED = 1e-9  # share of the answer by which two lengths of a step must differ
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
