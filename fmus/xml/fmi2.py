"""modelDescription.xml of FMI 2.0, from a unit's declarations."""

from __future__ import annotations

from collections.abc import Iterable
from xml.etree.ElementTree import Element, SubElement

from ..unit import SizedUnit
from ..variables import Variable
from .description import (
    LOG_CATEGORIES,
    Capabilities,
    built,
    common,
    experiment,
    flag,
    header,
    text_of,
)
from .types import (
    bounds,
    described,
    type_attributes,
    type_name,
    type_names,
    unit_definitions,
)


def model_description(
    unit: SizedUnit, name: str, guid: str, release: str, can: Capabilities
) -> bytes:
    """The XML of the model description, UTF-8.

    Args:
        unit: with its sizes.
        name: model name and model identifier.
        guid: identity of the content.
        release: version of autobalancer.
        can: what the implementation offers.
    """
    root = Element("fmiModelDescription", {"fmiVersion": "2.0", "guid": guid})
    root.attrib.update(header(unit, name, release))
    _co_simulation(root, name, can)
    types = type_names(unit.layout)
    unit_definitions(root, types)
    definitions = SubElement(root, "TypeDefinitions")
    for kind in types:
        simple = SubElement(definitions, "SimpleType", {"name": kind})
        SubElement(simple, "Real", type_attributes(kind))
    categories = SubElement(root, "LogCategories")
    for category, text in LOG_CATEGORIES.items():
        SubElement(categories, "Category", {"name": category, "description": text})
    experiment(root)
    built(SubElement(SubElement(root, "VendorAnnotations"), "Tool", {"name": "autobalancer"}), unit)
    position = {v.name: str(i) for i, v in enumerate(unit.layout.variables, 1)}
    variables = SubElement(root, "ModelVariables")
    for variable in unit.layout.variables:
        _variable(variables, unit, variable, position)
    structure = SubElement(root, "ModelStructure")
    outputs = [v for v in unit.layout.variables if v.causality == "output"]
    during, initially = (SubElement(structure, tag) for tag in ("Outputs", "InitialUnknowns"))
    for v in outputs:
        _unknown(during, position, v, v.depends, v.kind)
        _unknown(initially, position, v, {*v.depends, *v.begins}, "dependent")
    return text_of(root)


def _co_simulation(root: Element, name: str, can: Capabilities) -> None:
    element = SubElement(
        root,
        "CoSimulation",
        {
            "modelIdentifier": name,
            "needsExecutionTool": "false",
            "canHandleVariableCommunicationStepSize": "true",
            "canInterpolateInputs": flag(can.input_derivatives),
            "maxOutputDerivativeOrder": str(can.output_derivatives),
            "canRunAsynchronuously": "false",
            "canBeInstantiatedOnlyOncePerProcess": "false",
            "canNotUseMemoryManagementFunctions": "true",
            "canGetAndSetFMUstate": "true",
            "canSerializeFMUstate": "true",
            "providesDirectionalDerivative": flag(can.directional_derivatives),
        },
    )
    if can.sources:
        files = SubElement(element, "SourceFiles")
        for source in can.sources:
            SubElement(files, "File", {"name": source})


def _variable(
    parent: Element, unit: SizedUnit, variable: Variable, position: dict[str, str]
) -> None:
    layout = unit.layout
    index = layout.boolean_index if variable.boolean else layout.index
    attributes = {"name": variable.name, "valueReference": str(index[variable.name])}
    attributes.update(common(variable, described(variable)))
    scalar = SubElement(parent, "ScalarVariable", attributes)
    if variable.boolean:
        SubElement(scalar, "Boolean", {"start": flag(bool(variable.start))})
        return
    real = {"declaredType": type_name(variable), "unit": variable.unit, **bounds(variable)}
    if variable.start is not None:
        real["start"] = repr(float(variable.start))
    if variable.derivative_of:
        real["derivative"] = position[variable.derivative_of]
    SubElement(scalar, "Real", real)


def _unknown(
    parent: Element, position: dict[str, str], unknown: Variable, known: Iterable[str], kind: str
) -> None:
    """An Unknown with every dependency, none left to a tool's guess."""
    indices = sorted((position[name] for name in known), key=int)
    SubElement(
        parent,
        "Unknown",
        {
            "index": position[unknown.name],
            "dependencies": " ".join(indices),
            "dependenciesKind": " ".join([kind] * len(indices)),
        },
    )
