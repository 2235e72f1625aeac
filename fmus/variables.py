"""Declarations of a unit's variables, and their layout as one list of numbers.

A unit declares its variables once, in the order parameters, inputs, outputs.  The index of a Real
in that order is its value reference, so a master exchanges a whole group as one contiguous slice.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain

_SIGNALS = {  # units of value and derivatives
    "acceleration": ("m/s2", "m/s3", "m/s4", "m/s5"),
    "force": ("N", "N/s", "N/s2", "N/s3"),
    "angular acceleration": ("rad/s2", "rad/s3", "rad/s4", "rad/s5"),
    "torque": ("N.m", "N.m/s", "N.m/s2", "N.m/s3"),
}


@dataclass(frozen=True)
class Variable:
    """One FMI variable.

    Attributes:
        name: structured FMI name.
        causality: parameter | input | output; of descriptions also local | independent.
        unit: name of an SI unit, empty for a Boolean.
        start: start value; None for outputs, which are calculated.
        description: one line.
        variability: fixed | tunable (native units alone: set between steps too) | continuous.
        minimum: smallest allowed value, or None.
        above: True when the minimum itself is not allowed.
        maximum: largest value that the equations accept, or None.
        depends: inputs an output depends on directly, at the same communication point.
        begins: parameters and inputs an output depends on at the start, besides `depends`.
        kind: how it depends on its inputs in FMI's words, "dependent" or "fixed" (linear).
        derivative_of: output, or input signal, this one is the time derivative of.
        observed: an output computed only when somebody reads it.
        quantity: what is measured, where the unit alone does not say it.
        native: what only the native units compute: a Python unit keeps a parameter or input at its
            start value, and has no such output.
    """

    name: str
    causality: str
    unit: str = ""
    start: float | bool | None = None
    description: str = ""
    variability: str = "continuous"
    minimum: float | None = None
    above: bool = False
    depends: tuple[str, ...] = ()
    begins: tuple[str, ...] = ()
    kind: str = "dependent"
    derivative_of: str = ""
    observed: bool = False
    maximum: float | None = None
    quantity: str = ""
    native: bool = False

    @property
    def boolean(self) -> bool:
        """True for a Boolean, False for a Real."""
        return not self.unit

    @property
    def allowed(self) -> str:
        """What values are allowed, in words."""
        unit = f" {self.unit}" if self.unit != "1" else ""
        if self.minimum is None:
            return "a finite number"
        return f"a finite number{' above' if self.above else ', at least'} {self.minimum:g}{unit}"

    def problem(self, value: float) -> str:
        """Why `value` is not allowed, or an empty string."""
        low = self.minimum
        if math.isfinite(value) and (
            low is None or value > low or (value == low and not self.above)
        ):
            return ""
        return f"{self.shown(value)}: must be {self.allowed}"

    def python_problem(self, value: float) -> str:
        """Why `value` is not allowed in a Python unit, or an empty string."""
        if not self.native or value == self.start:
            return ""
        unit = f" {self.unit}" if self.unit not in ("", "1") else ""
        return (
            f"{self.shown(value)}: must be {self.start}{unit} in a Python unit; use the native unit"
        )

    def shown(self, value: float) -> str:
        """Name, value and unit in words."""
        return f"{self.name} = {value!r}{'' if self.unit in ('', '1') else ' ' + self.unit}"


def started(variables: Iterable[Variable], start: Mapping[str, float | bool]) -> list[Variable]:
    """Variables with other start values, by name; those of others are left aside."""
    return [
        replace(v, start=start[v.name]) if v.name in start and v.causality != "output" else v
        for v in variables
    ]


def parameter(name: str, start: float | bool, unit: str, description: str, **more) -> Variable:
    """A parameter, free until initialisation ends."""
    return Variable(name, "parameter", unit, start, description, "fixed", **more)


def not_negative(*declared, **more) -> Variable:
    """A parameter of 0 or more."""
    return parameter(*declared, minimum=0.0, **more)


def positive(*declared, **more) -> Variable:
    """A parameter above 0."""
    return not_negative(*declared, above=True, **more)


def tunable(*declared, **more) -> Variable:
    """A parameter that may be set between steps too."""
    return replace(parameter(*declared, **more), variability="tunable")


def plain_input(name: str, start: float, unit: str, description: str, **more) -> Variable:
    """An input that is not a polynomial over the step."""
    return Variable(name, "input", unit, start, description, **more)


def derivative(name: str, order: int) -> str:
    """FMI's name of a derivative: der(a), der(a,2)."""
    return (name, f"der({name})", f"der({name},{order})")[min(order, 2)]


def signal_inputs(names: Sequence[str], quantity: str, description: str) -> list[Variable]:
    """Input signals (`_SIGNALS`): all values, then all first derivatives, and so on to the third.

    A master that holds its signals sets the leading part of this group only.
    """
    texts = [description, *(f"{description}, derivative of order {k}" for k in (1, 2, 3))]
    return [
        plain_input(
            derivative(name, order),
            0.0,
            unit,
            f"{texts[order]} at the start of the step",
            derivative_of=derivative(name, order - 1) if order else "",
        )
        for order, unit in enumerate(_SIGNALS[quantity])
        for name in names
    ]


SPIN = tuple(derivative("acceleration", k) for k in range(3))  # what outputs answer of it


def spin_inputs() -> list[Variable]:
    """How the rotor turns: its speed, and its angular acceleration as a cubic."""
    speed = plain_input("speed", 300.0, "rad/s", "Speed of the rotor at the start of the step")
    first, *changes = signal_inputs(
        ["acceleration"], "angular acceleration", "Angular acceleration of the rotor"
    )
    return [speed, first, *(replace(change, native=True) for change in changes)]


def output(name: str, unit: str, description: str, **more) -> Variable:
    """An output."""
    return Variable(name, "output", unit, None, description, **more)


def signal_outputs(
    names: Sequence[str],
    quantity: str,
    description: str,
    depends: Sequence[tuple[str, ...]],
    slopes_depend: Sequence[tuple[str, ...]],
    **more,
) -> list[Variable]:
    """Output signals, then the exact slope of each.

    What they depend on is in the order of `names`.
    """
    values = [
        output(name, _SIGNALS[quantity][0], description, depends=inputs, **more)
        for name, inputs in zip(names, depends, strict=True)
    ]
    slopes = [
        output(f"der({name})", _SIGNALS[quantity][1], f"Exact slope of {name}", depends=inputs,
               derivative_of=name, **more)
        for name, inputs in zip(names, slopes_depend, strict=True)
    ]  # fmt: skip
    return values + slopes


def observed(name: str, unit: str, description: str, begins: tuple[str, ...], **more) -> Variable:
    """An output for people and records, computed when it is read."""
    return output(name, unit, description, begins=begins, observed=True, **more)


def torque_outputs(
    depends: tuple[str, ...], slope_depends: tuple[str, ...], begins: tuple[str, ...], what: str
) -> list[Variable]:
    """Torque on the shaft and its slope, which a motor that is not ideal feels."""
    pair = signal_outputs(["torque"], "torque", what, [depends], [slope_depends], begins=begins)
    return [replace(variable, observed=True, native=True) for variable in pair]


class Layout:
    """Value references of a unit's variables: index in `reals` or in `booleans`.

    Raises:
        ValueError: the declarations are not in the order parameters, inputs, outputs.
    """

    def __init__(self, owner: str, variables: Iterable[Variable]) -> None:
        self.variables = tuple(variables)
        self.reals = tuple(v for v in self.variables if not v.boolean)
        self.booleans = tuple(v for v in self.variables if v.boolean)
        self.index = {v.name: i for i, v in enumerate(self.reals)}
        self.boolean_index = {v.name: i for i, v in enumerate(self.booleans)}
        self.starts = [0.0 if v.start is None else float(v.start) for v in self.reals]
        self.boolean_starts = [bool(v.start) for v in self.booleans]
        groups = ["parameter", "input", "output"]
        rank = [groups.index(v.causality) + v.observed for v in self.reals]
        if rank != sorted(rank):
            raise ValueError(f"{owner}: declare parameters, inputs, outputs, observed outputs")
        self.parameters = slice(0, sum(v.causality == "parameter" for v in self.reals))
        first = self.parameters.stop
        self.inputs = slice(first, first + sum(v.causality == "input" for v in self.reals))
        computed = sum(v.causality == "output" and not v.observed for v in self.reals)
        self.computed = slice(self.inputs.stop, self.inputs.stop + computed)
        self.observed = slice(self.computed.stop, len(self.reals))
        names = "\n".join(chain([owner], (v.name for v in self.variables)))
        self.signature = f"{owner} {hashlib.sha256(names.encode()).hexdigest()[:16]}"

    def at(self, first: str, count: int = 1) -> slice:
        """Slice of `count` Reals from the one named `first`."""
        start = self.index[first]
        return slice(start, start + count)
