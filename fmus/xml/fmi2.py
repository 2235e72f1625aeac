"""modelDescription.xml of FMI 2.0, from a unit's declarations."""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

from ..unit import SizedUnit
from . import description as common
from .description import Capabilities
from .types import type_attributes, type_names, unit_definitions

_UNKNOWN = {
    "Outputs": ("output",),
    "Derivatives": ("local",),
    "InitialUnknowns": ("output", "local"),
}


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
    root.attrib.update(common.header(unit, name, release))
    rates = common.derivatives(unit)
    if rates:
        root.set("numberOfEventIndicators", str(len(unit.indicators)))
    for interface in common.interfaces(root, unit, name, can, 2):
        interface.set("canNotUseMemoryManagementFunctions", "true")
        if can.sources:
            files = SubElement(interface, "SourceFiles")
            for source in can.sources:
                SubElement(files, "File", {"name": source})
    types = type_names((*unit.layout.reals, *rates.values()))
    unit_definitions(root, types)
    definitions = SubElement(root, "TypeDefinitions")
    for kind in types:
        simple = SubElement(definitions, "SimpleType", {"name": kind})
        SubElement(simple, "Real", type_attributes(kind))
    common.log_categories(root, "fmi2")
    common.experiment(root, unit.unit)
    tool = SubElement(SubElement(root, "VendorAnnotations"), "Tool", {"name": "autobalancer"})
    common.built(tool, unit)
    references = {**unit.layout.index, **unit.layout.boolean_index}
    references |= {v.name: int(k) for k, v in rates.items()}
    shown = (*unit.shown, *rates.values())
    position = {v.name: str(i) for i, v in enumerate(shown, 1)}
    variables = SubElement(root, "ModelVariables")
    for v in shown:
        about = common.scalar(v, unit.label(v.name), str(references[v.name]))
        element = SubElement(variables, "ScalarVariable", about)
        about = common.value(v, position)
        if v.causality == "output":  # OMSimulator takes such an output for a state's derivative
            about.pop("derivative", None)
        SubElement(element, "Boolean" if v.boolean else "Real", about)
    structure = SubElement(root, "ModelStructure")
    for tag in ("Outputs", "Derivatives", "InitialUnknowns"):
        unknowns = [v for v in shown if v.causality in _UNKNOWN[tag]]
        if unknowns or tag != "Derivatives":
            element = SubElement(structure, tag)
        for v in unknowns:
            found = common.unknown(unit, v, position, tag == "InitialUnknowns")
            SubElement(element, "Unknown", {"index": position[v.name], **found})
    return common.text_of(root)
