"""modelDescription.xml and buildDescription.xml of FMI 3.0, from a unit's declarations.

Value references are unique over all types: the Reals have those of FMI 2.0, the Booleans follow
them, and after those comes the independent variable `time`.
"""

from __future__ import annotations

from collections.abc import Iterable
from xml.etree.ElementTree import Element, SubElement

from ..unit import SizedUnit
from ..variables import Layout, Variable
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

TIME = "time"


def value_references(layout: Layout) -> dict[str, int]:
    """Name -> value reference, `time` included."""
    reals = len(layout.reals)
    references = dict(layout.index)
    references.update((name, reals + k) for name, k in layout.boolean_index.items())
    references[TIME] = len(references)
    return references


def model_description(
    unit: SizedUnit, name: str, token: str, release: str, can: Capabilities
) -> bytes:
    """The XML of the model description, UTF-8.

    Args:
        unit: with its sizes.
        name: model name and model identifier.
        token: instantiation token.
        release: version of autobalancer.
        can: what the implementation offers.
    """
    root = Element("fmiModelDescription", {"fmiVersion": "3.0", "instantiationToken": token})
    root.attrib.update(header(unit, name, release))
    SubElement(
        root,
        "CoSimulation",
        {
            "modelIdentifier": name,
            "needsExecutionTool": "false",
            "canBeInstantiatedOnlyOncePerProcess": "false",
            "canGetAndSetFMUState": "true",
            "canSerializeFMUState": "true",
            "providesDirectionalDerivatives": flag(can.directional_derivatives),
            "canHandleVariableCommunicationStepSize": "true",
            "maxOutputDerivativeOrder": str(can.output_derivatives),
            "canReturnEarlyAfterIntermediateUpdate": "false",
            "providesIntermediateUpdate": "false",
            "mightReturnEarlyFromDoStep": flag(can.early_return),
            "hasEventMode": "false",
        },
    )
    types = sorted({*type_names(unit.layout), "Time"})
    unit_definitions(root, types)
    definitions = SubElement(root, "TypeDefinitions")
    for kind in types:
        SubElement(definitions, "Float64Type", {"name": kind, **type_attributes(kind)})
    categories = SubElement(root, "LogCategories")
    for category, text in LOG_CATEGORIES.items():
        words = text.replace("fmi2", "fmi3")
        SubElement(categories, "Category", {"name": category, "description": words})
    experiment(root)
    references = {k: str(v) for k, v in value_references(unit.layout).items()}
    variables = SubElement(root, "ModelVariables")
    _time(variables, references[TIME])
    for variable in unit.layout.variables:
        _variable(variables, variable, references)
    structure = SubElement(root, "ModelStructure")
    outputs = [v for v in unit.layout.variables if v.causality == "output"]
    for v in outputs:
        _unknown(structure, "Output", references, v, v.depends, v.kind)
    for v in outputs:
        _unknown(structure, "InitialUnknown", references, v, {*v.depends, *v.begins}, "dependent")
    built(SubElement(SubElement(root, "Annotations"), "Annotation", {"type": "autobalancer"}), unit)
    return text_of(root)


def build_description(name: str, can: Capabilities) -> bytes:
    """sources/buildDescription.xml: the C files that make the library, C99."""
    root = Element("fmiBuildDescription", {"fmiVersion": "3.0"})
    build = SubElement(root, "BuildConfiguration", {"modelIdentifier": name})
    files = SubElement(build, "SourceFileSet", {"language": "C99"})
    for source in can.sources:
        SubElement(files, "SourceFile", {"name": source})
    return text_of(root)


def _time(parent: Element, reference: str) -> None:
    SubElement(
        parent,
        "Float64",
        {
            "name": TIME,
            "valueReference": reference,
            "description": "Simulation time",
            "causality": "independent",
            "variability": "continuous",
            "declaredType": "Time",
            "unit": "s",
        },
    )


def _variable(parent: Element, variable: Variable, references: dict[str, str]) -> None:
    attributes = {"name": variable.name, "valueReference": references[variable.name]}
    attributes.update(common(variable, described(variable)))
    if variable.boolean:
        SubElement(parent, "Boolean", {**attributes, "start": flag(bool(variable.start))})
        return
    attributes.update({"declaredType": type_name(variable), "unit": variable.unit})
    attributes.update(bounds(variable))
    if variable.start is not None:
        attributes["start"] = repr(float(variable.start))
    if variable.derivative_of:
        attributes["derivative"] = references[variable.derivative_of]
    SubElement(parent, "Float64", attributes)


def _unknown(
    parent: Element,
    tag: str,
    references: dict[str, str],
    unknown: Variable,
    known: Iterable[str],
    kind: str,
) -> None:
    """An unknown with every dependency, none left to a tool's guess."""
    numbers = sorted((references[name] for name in known), key=int)
    SubElement(
        parent,
        tag,
        {
            "valueReference": references[unknown.name],
            "dependencies": " ".join(numbers),
            "dependenciesKind": " ".join([kind] * len(numbers)),
        },
    )
