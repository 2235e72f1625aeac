"""What the model descriptions of FMI 2.0 and 3.0 have in common."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from ..unit import SizedUnit
from ..variables import Variable

AUTHOR = "The autobalancer authors"
# a fixed date keeps builds reproducible; formal checkers want the Z
DATE = "2026-01-01T00:00:00Z"

INITIAL = {"parameter": {"initial": "exact"}, "input": {}, "output": {"initial": "calculated"}}

# of pythonfmu, and of the C units as well
LOG_CATEGORIES = {
    "logStatusWarning": "Log messages with fmi2Warning status.",
    "logStatusDiscard": "Log messages with fmi2Discard status.",
    "logStatusError": "Log messages with fmi2Error status.",
    "logStatusFatal": "Log messages with fmi2Fatal status.",
    "logAll": "Log all messages.",
}


@dataclass(frozen=True)
class Capabilities:
    """What an implementation of a unit offers beyond stepping, saving and restoring its state.

    Attributes:
        input_derivatives: whether it takes the derivatives of inputs FMI's own way.
        output_derivatives: highest order of those that it gives FMI's own way.
        directional_derivatives: whether it gives them.
        early_return: whether a step may end early (FMI 3.0).
        sources: names of the C files in `sources/` that make the library.
    """

    input_derivatives: bool = False
    output_derivatives: int = 0
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
        "variableNamingConvention": "structured",
    }


def common(variable: Variable, description: str) -> dict[str, str]:
    """Attributes of a variable, in both versions; name and value reference come first."""
    return {
        "description": description,
        "causality": variable.causality,
        "variability": variable.variability,
        **INITIAL[variable.causality],
    }


def experiment(root: Element) -> None:
    """DefaultExperiment: 40 steps a revolution at the start value of the speed, 300 rad/s."""
    SubElement(root, "DefaultExperiment", {"startTime": "0", "stopTime": "1", "stepSize": "0.0005"})


def built(parent: Element, unit: SizedUnit) -> None:
    """What the FMU was built as; `options_in` reads it."""
    options = {key: str(value) for key, value in unit.options.items()}
    SubElement(parent, "Built", {"unit": unit.name, **options})


def options_in(root: Element) -> dict[str, Any]:
    """Unit and build options that a model description of either version names; else nothing."""
    found = root.find(".//Built")
    if found is None:
        return {}
    return {key: int(v) if v.isdecimal() else v for key, v in found.attrib.items()}


def text_of(root: Element) -> bytes:
    """The file."""
    indent(root)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, "utf-8") + b"\n"


def flag(value: bool) -> str:
    """A Boolean in XML."""
    return str(value).lower()
