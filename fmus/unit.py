"""A unit as it is declared: its sizes, its variables, and what is said about it.

Nothing here needs more than the standard library: the C units take their variables from the same
declarations before NumPy or pythonfmu are installed.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, replace
from functools import cache
from typing import Any

from .variables import Layout, Variable, started

LONGEST_NAME = 63  # of MATLAB, whose Simulink imports FMUs


def one_of(*words: str, of: tuple[str, ...] = ()) -> Any:
    """A choice out of words, by default the first of them; `of` as for `count`."""
    return field(default=words[0], metadata={"words": words, "of": of})


def option() -> Any:
    """1 where the unit has it; 0 is the default, not written down, the only one of Python units."""
    return field(default=0, metadata={"words": (0, 1), "of": (), "silent": 0, "native": True})


def count(default: int, of: tuple[str, ...] = (), native: bool = True) -> Any:
    """A whole number, at least 1; when `of` is given, of these kinds of the unit only.

    With 0 for a default it may be 0: the unit has none, the option is not written down, and, where
    it is `native`, Python units take no other value.
    """
    known: dict[str, Any] = {"words": (), "of": of, "least": min(1, default)}
    optional = {"silent": 0} | ({"native": 1} if native else {})
    return field(default=default, metadata=known | ({} if default else optional))


@dataclass(frozen=True)
class Sizes:
    """What is fixed when a unit is instantiated: a field a build option, by `one_of` or `count`.

    Attributes:
        frame: axes of the signals: "rotor" (xi, eta, which turn with it) or "fixed" (x, y).

    Raises:
        ValueError: an option is not one of those allowed; the text names it.
    """

    frame: str = one_of("rotor", "fixed")

    def __post_init__(self) -> None:
        for name, value in self.options.items():
            words = self.words(name)
            if words and (value not in words or type(value) is not type(words[0])):
                raise ValueError(f"{name} = {value!r}: must be one of {alternatives(words)}")
            least = self.__dataclass_fields__[name].metadata.get("least", 1)
            if not words and (type(value) is not int or value < least):
                raise ValueError(f"{name} = {value!r}: must be a whole number, at least {least}")

    @classmethod
    def words(cls, name: str) -> tuple[Any, ...]:
        """What is allowed for an option; nothing for any number."""
        return next(f.metadata["words"] for f in fields(cls) if f.name == name)

    @property
    def options(self) -> dict[str, Any]:
        """Every option that concerns a unit of this kind, by name."""
        kind = getattr(self, "kind", "")
        concerned = [f for f in fields(self) if not f.metadata["of"] or kind in f.metadata["of"]]
        values = ((f, getattr(self, f.name)) for f in concerned)
        return {f.name: v for f, v in values if v != f.metadata.get("silent")}

    @property
    def axes(self) -> tuple[str, str]:
        """Names of the axes of the signals."""
        return ("xi", "eta") if self.frame == "rotor" else ("x", "y")


@dataclass(frozen=True)
class Unit:
    """A unit's record in the catalogue.

    Attributes:
        name: of the unit and of the class of its slave.
        summary: one line.
        sizes: its build options.
        variables: all variables of a unit of these sizes, in the order parameters, inputs,
            outputs, observed outputs; raises ValueError where there is no unit of these sizes.
        stop, step: of the run that a tool proposes [s]; by default 40 steps per revolution at the
            start value of the speed, 300 rad/s.
        native: whether it exists in C alone, without a slave in Python.
    """

    name: str
    summary: str
    sizes: type[Sizes]
    variables: Callable[[Any], list[Variable]]
    stop: float = 1.0
    step: float = 0.0005
    native: bool = False

    @property
    def folder(self) -> str:
        """Where its files are: `variables` (the declarations), `slave` (the equations in Python),
        `README.md` (the equations in words, and where they are valid).
        """
        return self.variables.__module__.split(".")[-2]

    def sized(self, options: Mapping[str, Any] | None = None) -> SizedUnit:
        """The unit with options, those left out at their defaults.

        Raises:
            ValueError: an option is not one of those allowed, or there is no unit of these sizes.
            TypeError: there is no such option.
        """
        return _sized(self, self.sizes(**(options or {})))


@dataclass(frozen=True)
class SizedUnit:
    """A unit of certain sizes, with its variables and their value references.

    Attributes:
        hidden: variables that descriptions leave out; the library has them all the same.
        flat: whether descriptions name variables by letters, digits and underscores alone.
        states: names of the outputs that are continuous states of model exchange, in their order;
            none: it has no model exchange.
        indicators: what the event indicators of model exchange tell, in their order.
    """

    unit: Unit
    sizes: Sizes
    layout: Layout = field(compare=False)
    hidden: frozenset[str] = frozenset()
    flat: bool = False
    states: tuple[str, ...] = ()
    indicators: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Of the unit."""
        return self.unit.name

    @property
    def shown(self) -> tuple[Variable, ...]:
        """Variables that descriptions have.

        Raises:
            ValueError: two of them have one flat name, or a name is longer than MATLAB allows.
        """
        shown = tuple(v for v in self.layout.variables if v.name not in self.hidden)
        labels = [self.label(v.name) for v in shown]
        labels += [self.label(f"der({state})") for state in self.states]
        if long := [label for label in labels if len(label) > LONGEST_NAME]:
            raise ValueError(
                f"{long[0]}: has {len(long[0])} characters, and MATLAB allows {LONGEST_NAME}: give "
                "the balancer a shorter name"
            )
        if self.flat and (twice := [label for label in labels if labels.count(label) > 1]):
            raise ValueError(f"{twice[0]}: is the flat name of two variables: rename the balancer")
        return shown

    def label(self, name: str) -> str:
        """Name of a variable in descriptions: rotor_plane_1_F_x for rotor.plane[1].F_x if flat.

        Else a part with a hyphen is quoted, as FMI's structured names ask: 'left-ring'.drag.
        """
        if self.flat:
            return re.sub(r"\W+", "_", name).strip("_")
        return re.sub(r"(^|\()(\w+-[\w-]*)\.", r"\1'\2'.", name)

    @property
    def returns_early(self) -> bool:
        """Whether a native step may end before the communication point asked for."""
        return "shortest_stopped_step" in self.layout.index

    @property
    def in_python(self) -> SizedUnit:
        """The same as a Python unit: without the outputs that native units alone compute.

        Raises:
            ValueError: the unit, or one of its options, exists in C alone.
        """
        if self.unit.native:
            raise ValueError(f"{self.name}: exists as a native unit only; build it without Python")
        for option in fields(self.sizes):
            value = getattr(self.sizes, option.name)
            if option.metadata.get("native") and value != option.default:
                raise ValueError(
                    f"{option.name} = {value!r}: must be {option.default!r} in a Python unit; "
                    "use the native unit"
                )
        kept = [
            replace(v, variability="fixed") if v.variability == "tunable" else v
            for v in self.layout.variables
            if not (v.native and v.causality == "output")
        ]
        return SizedUnit(self.unit, self.sizes, Layout(self.name, kept))

    def has(self, name: str) -> bool:
        """Whether it has a variable of this name."""
        return name in self.layout.index or name in self.layout.boolean_index

    def python_problems(self, start: Mapping[str, float | bool]) -> list[str]:
        """Why a Python unit cannot have these start values, one line a value."""
        given = ((v, start[v.name]) for v in self.layout.variables if v.name in start)
        return [text for variable, value in given if (text := variable.python_problem(value))]

    def started(self, start: Mapping[str, float | bool], about: Mapping[str, Any]) -> SizedUnit:
        """The same with start values of its own, and what a description says of the unit then.

        Args:
            start: of parameters and inputs, by name.
            about: any of `summary`, `stop` and `step` of `Unit`.
        """
        unit = replace(self.unit, **about)
        return SizedUnit(unit, self.sizes, Layout(self.name, started(self.layout.variables, start)))

    @property
    def options(self) -> dict[str, Any]:
        """Build options that make it, all that concern it, sorted by name."""
        return dict(sorted(self.sizes.options.items()))


@cache
def _sized(unit: Unit, sizes: Sizes) -> SizedUnit:
    return SizedUnit(unit, sizes, Layout(unit.name, unit.variables(sizes)))


def alternatives(words: Any) -> str:
    """Words to choose from, for a message."""
    return ", ".join(map(repr, words))
