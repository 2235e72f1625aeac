"""What the model descriptions of FMI 2.0 and 3.0 have in common."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from ...models.constants import FIRST_DERIVATIVE, FIRST_INDICATOR
from ..unit import SizedUnit, Unit
from ..variables import Variable
from .types import bounds, described, type_name

AUTHOR = "The autobalancer authors"
# a fixed date keeps builds reproducible; formal checkers want the Z
DATE = "2026-01-01T00:00:00Z"

_INITIAL = {
    "parameter": {"initial": "exact"},
    "input": {},
    "output": {"initial": "calculated"},
    "local": {"initial": "calculated"},
    "independent": {},
}
_PER_SECOND = {"m": "m/s", "m/s": "m/s2", "rad": "rad/s", "rad/s": "rad/s2"}


@dataclass(frozen=True)
class Capabilities:
    """What an implementation of a unit offers beyond stepping, saving and restoring its state.

    Attributes:
        interpolation: whether it takes derivatives of inputs by time, by FMI 2.0.
        time_derivatives: whether it gives those of outputs.
        directional_derivatives: whether it gives them.
        early_return: whether a step may end early (FMI 3.0).
        sources: names of the C files in `sources/` that make the library (FMI 2.0).
    """

    interpolation: bool = False
    time_derivatives: bool = False
    directional_derivatives: bool = False
    early_return: bool = False
    sources: tuple[str, ...] = ()


def header(unit: SizedUnit, name: str, release: str) -> dict[str, str]:
    """Attributes of the root, in both versions."""
    return {
        "modelName": name,
        "description": unit.unit.summary,
        "author": AUTHOR,
        "version": release,
        "copyright": AUTHOR,
        "license": "MIT, see documentation/licenses/license.txt",
        "generationTool": f"autobalancer {release}",
        "generationDateAndTime": DATE,
        "variableNamingConvention": "flat" if unit.flat else "structured",
    }


def interfaces(
    root: Element, unit: SizedUnit, name: str, can: Capabilities, fmi: int
) -> list[Element]:
    """ModelExchange, of a unit with states, and CoSimulation; what is not said is false."""
    state, plural = ("FMUstate", "") if fmi == 2 else ("FMUState", "s")
    shared = {
        "modelIdentifier": name,
        f"canGetAndSet{state}": "true",
        f"canSerialize{state}": "true",
        f"providesDirectionalDerivative{plural}": flag(can.directional_derivatives),
    }
    steps = {
        "canHandleVariableCommunicationStepSize": "true",
        "maxOutputDerivativeOrder": str(int(can.time_derivatives)),
    }
    if fmi == 2:
        steps["canInterpolateInputs"] = flag(can.interpolation)
    kinds = {"ModelExchange": shared, "CoSimulation": shared | steps}
    return [
        SubElement(root, kind, about)
        for kind, about in kinds.items()
        if unit.states or kind == "CoSimulation"
    ]


def scalar(variable: Variable, name: str, reference: str) -> dict[str, str]:
    """What a variable is, in both versions."""
    return {
        "name": name,
        "valueReference": reference,
        "description": described(variable),
        "causality": variable.causality,
        "variability": variable.variability,
        **_INITIAL[variable.causality],
    }


def value(variable: Variable, references: Mapping[str, str]) -> dict[str, str]:
    """Type, bounds and start value of a variable, in both versions; `references` by name."""
    if variable.boolean:
        return {} if variable.start is None else {"start": flag(bool(variable.start))}
    attributes = {"declaredType": type_name(variable), "unit": variable.unit, **bounds(variable)}
    if variable.start is not None:
        attributes["start"] = repr(float(variable.start))
    if variable.derivative_of in references:
        attributes["derivative"] = references[variable.derivative_of]
    return attributes


def derivatives(unit: SizedUnit) -> dict[str, Variable]:
    """Derivatives of the states of model exchange, by value reference in both versions."""
    variables = {v.name: v for v in unit.layout.variables}
    found = {}
    for k, state in enumerate(unit.states):
        of = variables[state]
        text = f"Time derivative: {of.description}"
        rate = replace(of, name=f"der({state})", causality="local", unit=_PER_SECOND[of.unit])
        rate = replace(rate, description=text, derivative_of=state)
        found[str(FIRST_DERIVATIVE + k)] = rate
    return found


def indicators(unit: SizedUnit) -> dict[str, Variable]:
    """Event indicators of model exchange by value reference; in FMI 2.0 they are no variables."""
    return {
        str(FIRST_INDICATOR + k): Variable(
            f"event_indicator[{k + 1}]", "local", "1", description=f"Falls through 0 where {text}"
        )
        for k, text in enumerate(unit.indicators)
    }


def unknown(
    unit: SizedUnit, variable: Variable, references: Mapping[str, str], initially: bool
) -> dict[str, str]:
    """Every dependency of an output, none left to a tool's guess.

    Under model exchange outputs depend on states, and without an attribute on all that is known.
    """
    names = {*variable.depends, *(variable.begins if initially else ())}
    if unit.states and not initially:
        state = variable.name in unit.states
        if not (state or variable.unit in ("m", "m/s", "rad")):  # inputs act on it at once
            return {}
        names = {variable.name} if state else {*unit.states}
    known = {references[name] for name in names & references.keys()}  # some are hidden
    kind = "dependent" if initially or unit.states else variable.kind
    return {
        "dependencies": " ".join(sorted(known, key=int)),
        "dependenciesKind": " ".join([kind] * len(known)),
    }


def log_categories(root: Element, prefix: str) -> None:
    """LogCategories; status names have the prefix of their version."""
    categories = SubElement(root, "LogCategories")
    for status in ("Warning", "Discard", "Error", "Fatal"):
        text = f"Log messages with {prefix}{status} status."
        SubElement(categories, "Category", {"name": f"logStatus{status}", "description": text})
    SubElement(categories, "Category", {"name": "logAll", "description": "Log all messages."})


def experiment(root: Element, unit: Unit) -> None:
    """DefaultExperiment."""
    times = {"startTime": 0.0, "stopTime": unit.stop, "stepSize": unit.step}
    SubElement(root, "DefaultExperiment", {key: f"{value:.15g}" for key, value in times.items()})


def built(parent: Element, unit: SizedUnit) -> None:
    """What the FMU was built as; `options_in` reads it."""
    options = {key: str(value) for key, value in unit.options.items()}
    SubElement(parent, "Built", {"unit": unit.name, **options})


def options_in(root: Element) -> dict[str, Any]:
    """Unit and build options that a model description of either version names; else nothing."""
    built = root.find(".//Built")
    if built is None:
        return {}
    return {key: int(v) if v.isdecimal() else v for key, v in built.attrib.items()}


def text_of(root: Element) -> bytes:
    """The file."""
    indent(root)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, "utf-8") + b"\n"


def flag(value: bool) -> str:
    """A Boolean in XML."""
    return str(value).lower()
