"""modelDescription.xml of FMI 3.0, from a unit's declarations.

Value references are unique over all types: the Reals have those of FMI 2.0, the Booleans follow
them, and after those comes the independent variable `time`.
"""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

from ..unit import SizedUnit
from ..variables import Layout, Variable
from . import description as common
from .description import Capabilities, flag
from .types import type_attributes, type_names, unit_definitions

_TIME = Variable("time", "independent", "s", None, "Simulation time", quantity="Time")
_UNKNOWN = {
    "Output": ("output",),
    "ContinuousStateDerivative": ("local",),
    "InitialUnknown": ("output", "local"),
}


def value_references(layout: Layout) -> dict[str, int]:
    """Name -> value reference, `time` included."""
    reals = len(layout.reals)
    references = dict(layout.index)
    references.update((name, reals + k) for name, k in layout.boolean_index.items())
    references[_TIME.name] = len(references)
    return references


def model_description(
    unit: SizedUnit, name: str, token: str, release: str, can: Capabilities
) -> bytes:
    """The XML of the model description, UTF-8.

    Arguments as of `fmi2.model_description`, with the instantiation token for the GUID.
    """
    root = Element("fmiModelDescription", {"fmiVersion": "3.0", "instantiationToken": token})
    root.attrib.update(common.header(unit, name, release))
    rates, indicators = common.derivatives(unit), common.indicators(unit)
    *_, steps = common.interfaces(root, unit, name, can, 3)
    steps.set("mightReturnEarlyFromDoStep", flag(can.early_return))
    types = type_names((_TIME, *unit.layout.reals, *rates.values(), *indicators.values()))
    unit_definitions(root, types)
    definitions = SubElement(root, "TypeDefinitions")
    for kind in types:
        SubElement(definitions, "Float64Type", {"name": kind, **type_attributes(kind)})
    common.log_categories(root, "fmi3")
    common.experiment(root, unit.unit)
    references = {
        k: str(v) for k, v in value_references(unit.layout).items() if k not in unit.hidden
    }
    references |= {v.name: k for k, v in (rates | indicators).items()}
    shown = (_TIME, *unit.shown, *rates.values(), *indicators.values())
    variables = SubElement(root, "ModelVariables")
    for v in shown:
        about = common.scalar(v, unit.label(v.name), references[v.name])
        about |= common.value(v, references)
        SubElement(variables, "Boolean" if v.boolean else "Float64", about)
    structure = SubElement(root, "ModelStructure")
    for tag, kinds in _UNKNOWN.items():
        for v in shown:
            if v.causality in kinds and v not in indicators.values():
                found = common.unknown(unit, v, references, tag == "InitialUnknown")
                SubElement(structure, tag, {"valueReference": references[v.name], **found})
    for reference in indicators:
        SubElement(structure, "EventIndicator", {"valueReference": reference})
    annotation = SubElement(SubElement(root, "Annotations"), "Annotation", {"type": "autobalancer"})
    common.built(annotation, unit)
    return common.text_of(root)
