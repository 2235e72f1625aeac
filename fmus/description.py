"""modelDescription.xml of a unit, written from its declarations."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from ._pythonfmu import Fmi2Slave
from .slave import Unit
from .variables import Variable

AUTHOR = "The autobalancer authors"
# a fixed date keeps builds reproducible; formal checkers want the Z
DATE = "2026-01-01T00:00:00Z"

# exponents of kg, m, s, rad
UNITS: dict[str, dict[str, int]] = {
    "1": {},
    "kg": {"kg": 1},
    "m": {"m": 1},
    "rad": {"rad": 1},
    "kg.m": {"kg": 1, "m": 1},
    "kg.m2": {"kg": 1, "m": 2},
    "kg/m3": {"kg": 1, "m": -3},
    "rad/s": {"rad": 1, "s": -1},
    "rad/s2": {"rad": 1, "s": -2},
    "m/N": {"kg": -1, "s": 2},
    "N.m2": {"kg": 1, "m": 3, "s": -2},
    "N/m": {"kg": 1, "s": -2},
    "N.s/m": {"kg": 1, "s": -1},
    **{f"m/s{k if k > 1 else ''}": {"m": 1, "s": -k} for k in range(1, 6)},
    "N": {"kg": 1, "m": 1, "s": -2},
    **{f"N/s{k if k > 1 else ''}": {"kg": 1, "m": 1, "s": -2 - k} for k in range(1, 4)},
}

_INITIAL = {"parameter": "exact", "output": "calculated"}


def model_description(
    unit: type[Unit], name: str, guid: str, version: str, sources: Sequence[str] = ()
) -> bytes:
    """The XML of the model description, UTF-8.

    Args:
        unit: a configured unit.
        name: model name and model identifier.
        guid: identity of the content.
        version: version of autobalancer.
        sources: C files in sources/, of a native unit.
    """
    root = Element(
        "fmiModelDescription",
        {
            "fmiVersion": "2.0",
            "modelName": name,
            "guid": guid,
            "description": (unit.__doc__ or "").splitlines()[0],
            "author": AUTHOR,
            "version": version,
            "copyright": AUTHOR,
            "license": "MIT, see documentation/licenses/license.txt",
            "generationTool": f"autobalancer {version}",
            "generationDateAndTime": DATE,
            "variableNamingConvention": "structured",
        },
    )
    simulation = SubElement(
        root,
        "CoSimulation",
        {
            "modelIdentifier": name,
            "needsExecutionTool": "false",
            "canHandleVariableCommunicationStepSize": "true",
            "canInterpolateInputs": "false",
            "maxOutputDerivativeOrder": "0",
            "canRunAsynchronuously": "false",
            "canBeInstantiatedOnlyOncePerProcess": "false",
            "canNotUseMemoryManagementFunctions": "true",
            "canGetAndSetFMUstate": "true",
            "canSerializeFMUstate": "true",
            "providesDirectionalDerivative": "false",
        },
    )
    if sources:
        files = SubElement(simulation, "SourceFiles")
        for source in sources:
            SubElement(files, "File", {"name": source})
    _units(root, unit)
    categories = SubElement(root, "LogCategories")
    for category, text in Fmi2Slave.log_categories.items():
        SubElement(categories, "Category", {"name": category, "description": text})
    SubElement(root, "DefaultExperiment", {"startTime": "0", "stopTime": "1", "stepSize": "0.0005"})
    tool = SubElement(SubElement(root, "VendorAnnotations"), "Tool", {"name": "autobalancer"})
    options = {key: str(value) for key, value in sorted(unit.options.items())}
    SubElement(tool, "Unit", {"class": unit.__name__, **options})
    variables = SubElement(root, "ModelVariables")
    for variable in unit.layout.variables:
        _variable(variables, unit, variable)
    _structure(root, unit)
    indent(root)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, "utf-8") + b"\n"


def _units(root: Element, unit: type[Unit]) -> None:
    definitions = SubElement(root, "UnitDefinitions")
    for name in sorted({v.unit for v in unit.layout.reals}):
        exponents = {key: str(power) for key, power in UNITS[name].items()}
        SubElement(SubElement(definitions, "Unit", {"name": name}), "BaseUnit", exponents)


def _position(unit: type[Unit]) -> dict[str, int]:
    """Index of each variable in ModelVariables, from 1."""
    return {v.name: i for i, v in enumerate(unit.layout.variables, 1)}


def _variable(parent: Element, unit: type[Unit], variable: Variable) -> None:
    layout = unit.layout
    index = layout.boolean_index if variable.boolean else layout.index
    attributes = {
        "name": variable.name,
        "valueReference": str(index[variable.name]),
        "description": variable.description,
        "causality": variable.causality,
        "variability": variable.variability,
    }
    if variable.causality in _INITIAL:
        attributes["initial"] = _INITIAL[variable.causality]
    scalar = SubElement(parent, "ScalarVariable", attributes)
    if variable.boolean:
        SubElement(scalar, "Boolean", {"start": str(variable.start).lower()})
        return
    real = {"unit": variable.unit}
    if variable.minimum is not None:
        real["min"] = repr(variable.minimum)
    if variable.start is not None:
        real["start"] = repr(float(variable.start))
    if variable.derivative_of:
        real["derivative"] = str(_position(unit)[variable.derivative_of])
    SubElement(scalar, "Real", real)


def _structure(root: Element, unit: type[Unit]) -> None:
    position = _position(unit)
    outputs = [v for v in unit.layout.variables if v.causality == "output"]
    structure = SubElement(root, "ModelStructure")
    during, initially = Element("Outputs"), Element("InitialUnknowns")
    for variable in outputs:
        _unknown(during, position, variable, variable.depends, variable.kind)
        known = {*variable.depends, *variable.begins}
        _unknown(initially, position, variable, known, "dependent")
    structure.extend([during, initially])


def _unknown(parent: Element, position: dict[str, int], unknown: Variable, known, kind) -> None:
    """An Unknown with every dependency, none left to a tool's guess."""
    indices = sorted(position[name] for name in known)
    SubElement(
        parent,
        "Unknown",
        {
            "index": str(position[unknown.name]),
            "dependencies": " ".join(map(str, indices)),
            "dependenciesKind": " ".join([kind] * len(indices)),
        },
    )
