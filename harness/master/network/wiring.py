"""Connections between units of any origin: what each input is made of, and how it can be given."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from ...scene.unit import split_port
from .order import loops_of


class Wire(NamedTuple):
    """An output and the input that it feeds; ports are `unit.variable`.

    Attributes:
        where: what messages call the connection.
    """

    source: str
    target: str
    factor: float
    where: str


@dataclass
class Inlet:
    """An input of real type.

    Attributes:
        terms: signals and their factors; the input is their sum.
        takes: order of the polynomial that it can be given over a step.
        by_call: whether derivatives are set by FMI's function, not by inputs `der(name)`.
        is_direct: whether a connected output depends on it at the same instant; None: not declared.
        shows_in: real outputs that depend on it at the same instant, declared or found by trial.
        is_tried: whether trial steps have found them.
        is_mixed: whether a unit both integrates it and shows it directly, which trial steps found.
    """

    variable: str
    terms: list[tuple[int, float]]
    takes: int
    by_call: bool
    is_direct: bool | None
    shows_in: set[str]
    is_tried: bool = False
    is_mixed: bool = False

    @property
    def holds_mean(self) -> bool:
        """Whether a held one stands at the mean of the signal over a step, not at its end."""
        return self.is_direct is False or self.is_mixed


class Copied(NamedTuple):
    """An input that takes a value from communication point to communication point."""

    source_unit: str
    source: str
    target: str
    factor: float


@dataclass
class Wiring:
    """What the connections of units come to.

    Attributes:
        signals: `unit.variable` of every real output that is connected.
        has_slope: of every signal, whether its unit gives its derivative.
        is_direct: of every signal, whether it depends on connected inputs at the same instant.
        inlets, copied: inputs by unit.
        depends: by unit and output, the inputs on which it is declared to depend.
    """

    signals: list[str] = field(default_factory=list)
    has_slope: list[bool] = field(default_factory=list)
    is_direct: list[bool] = field(default_factory=list)
    inlets: dict[str, list[Inlet]] = field(default_factory=dict)
    copied: dict[str, list[Copied]] = field(default_factory=dict)
    depends: dict[str, Mapping[str, frozenset[str] | None]] = field(default_factory=dict)

    def acts(self, inlet: Inlet, signal: str) -> bool:
        """Whether an output depends on an input of its unit at one instant, as far as is known."""
        unit, variable = split_port(signal)
        declared = self.depends[unit].get(variable)
        if declared is not None or inlet.is_tried:
            return inlet.variable in (declared or ()) or variable in inlet.shows_in
        return True

    def loops(self) -> list[list[str]]:
        """Signals that feed each other at one instant, unless that is declared or found not so."""
        feeds: dict[str, set[str]] = {signal: set() for signal in self.signals}
        for signal in self.signals:
            for inlet in self.inlets[split_port(signal)[0]]:
                if self.acts(inlet, signal):
                    for source, _ in inlet.terms:
                        feeds[self.signals[source]].add(signal)
        return loops_of(feeds)

    def edges(self) -> list[tuple[str, str, bool]]:
        """Every signal with the unit that sends it, one that takes it, and whether it is direct."""
        pairs = {
            (signal, unit)
            for unit, inlets in self.inlets.items()
            for inlet in inlets
            for signal, _ in inlet.terms
        }
        found = [
            (split_port(self.signals[signal])[0], unit, self.is_direct[signal])
            for signal, unit in sorted(pairs)
        ]
        copied = [(c.source_unit, unit, False) for unit, all_ in self.copied.items() for c in all_]
        return found + copied
