"""The XML of a system structure package: SystemStructure.ssd and the parameter set.

SSP 1.0 for FMUs of FMI 2.0; for those of FMI 3.0 it is SSP 2.0, which has the namespaces of 1.0 and
the types of FMI 3.0.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import NamedTuple
from xml.etree.ElementTree import Element as Xml
from xml.etree.ElementTree import SubElement

from ....fmus.variables import Variable
from ....fmus.xml.description import flag, text_of
from ....fmus.xml.types import SI_UNITS
from .structure import Element, Structure

_SSP = "http://ssp-standard.org/SSP1/SystemStructure"
_SPACES = {
    "ssd": f"{_SSP}Description",
    "ssc": f"{_SSP}Common",
    "ssv": f"{_SSP}ParameterValues",
    "oms": "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd",
}


class Form(NamedTuple):
    """What a version of SSP writes: its number, and its word for a Real."""

    version: str
    real: str


FORMS = {2: Form("1.0", "Real"), 3: Form("2.0", "Float64")}  # by the FMUs' version of FMI
WITH_OUTPUTS = "SystemOutputs.ssd"
PARAMETERS = "resources/parameters.ssv"
SET_NAME = "start"  # some tools choose parameter sets by name
WIDTH, APART = 120.0, 80.0  # of elements in a tool's diagram, which stand in a row


def resource(element: Element) -> str:
    """Where the FMU of an element is in the package."""
    return f"resources/{element.name}.fmu"


def parameter_file(structure: Structure, form: Form) -> bytes:
    """Parameters and start values of all elements under `element.variable`, for PARAMETERS."""
    root = _parameter_set([(f"{e.name}.", e) for e in structure.elements], form)
    root.attrib.update(_spaces("ssv", "ssc"))
    _units(SubElement(root, "ssv:Units"), structure)
    return text_of(root)


def description(structure: Structure, form: Form) -> bytes:
    """SystemStructure.ssd: libcosim reads no package in which the system itself has outputs."""
    return _description(replace(structure, outputs=()), form)


def with_outputs(structure: Structure, form: Form) -> bytes:
    """The same with outputs of the system, for WITH_OUTPUTS, a variant as SSP allows it."""
    return _description(replace(structure, name=f"{structure.name}, with outputs"), form)


def _description(structure: Structure, form: Form) -> bytes:
    root = Xml(
        "ssd:SystemStructureDescription",
        {**_spaces(*_SPACES), "version": form.version, "name": structure.name},
    )
    system = SubElement(root, "ssd:System", {"name": "system", "description": structure.title})
    _ports_of_system(system, structure, form)
    bindings = SubElement(system, "ssd:ParameterBindings")
    SubElement(bindings, "ssd:ParameterBinding", {"source": PARAMETERS})
    elements = SubElement(system, "ssd:Elements")
    for number, element in enumerate(structure.elements):
        _component(elements, structure, element, number * (WIDTH + APART), form)
    wires = (*structure.wires, *structure.outputs)
    if wires:
        connections = SubElement(system, "ssd:Connections")
    for source, target in wires:
        ends = {"startElement": source.unit, "startConnector": source.variable}
        ends |= {"endElement": target.unit, "endConnector": target.variable}
        SubElement(connections, "ssd:Connection", {k: v for k, v in ends.items() if v})
    _step_for_omsimulator(system, structure.step)
    _units(SubElement(root, "ssd:Units"), structure)
    run = {"startTime": "0", "stopTime": repr(structure.end)}
    SubElement(root, "ssd:DefaultExperiment", run)
    return text_of(root)


def _spaces(*names: str) -> dict[str, str]:
    return {f"xmlns:{name}": _SPACES[name] for name in names}


def _units(parent: Xml, structure: Structure) -> None:
    used = {v.unit for e in structure.elements for v in e.layout.reals}
    for name in sorted(used):
        unit = SubElement(parent, "ssc:Unit", {"name": name})
        SubElement(unit, "ssc:BaseUnit", {k: str(v) for k, v in SI_UNITS[name].items()})


def _ports_of_system(system: Xml, structure: Structure, form: Form) -> None:
    """Inputs from outside, each once, and outputs."""
    layouts = {element.name: element.layout for element in structure.elements}
    inputs = {w.source.variable: w.target for w in structure.wires if not w.source.unit}
    outputs = {w.target.variable: w.source for w in structure.outputs}
    connectors = SubElement(system, "ssd:Connectors") if inputs or outputs else system
    for kind, ports in (("input", inputs), ("output", outputs)):
        for name, port in ports.items():
            layout = layouts[port.unit]
            variable = next(v for v in layout.variables if v.name == port.variable)
            _connector(connectors, replace(variable, name=name), kind, form)


def _component(
    parent: Xml, structure: Structure, element: Element, left: float, form: Form
) -> None:
    about = {"name": element.name, "source": resource(element), "implementation": "CoSimulation"}
    component = SubElement(parent, "ssd:Component", about)
    connectors = SubElement(component, "ssd:Connectors")
    ports = [port for wire in structure.wires for port in wire if port.unit == element.name]
    connected = {*element.shown, *(port.variable for port in ports)}
    for variable in element.layout.variables:
        name, kind = variable.name, variable.causality
        if name in connected or (kind == "parameter" and name in element.start):
            _connector(connectors, variable, kind, form)
    corners = {"x1": left, "y1": 0.0, "x2": left + WIDTH, "y2": WIDTH}
    SubElement(component, "ssd:ElementGeometry", {k: repr(v) for k, v in corners.items()})
    bindings = SubElement(component, "ssd:ParameterBindings")
    values = SubElement(SubElement(bindings, "ssd:ParameterBinding"), "ssd:ParameterValues")
    values.append(_parameter_set([("", element)], form))


def _connector(parent: Xml, variable: Variable, kind: str, form: Form) -> None:
    connector = SubElement(parent, "ssd:Connector", {"name": variable.name, "kind": kind})
    if variable.boolean:
        SubElement(connector, "ssc:Boolean")
    else:
        SubElement(connector, f"ssc:{form.real}", {"unit": variable.unit})


def _parameter_set(elements: Iterable[tuple[str, Element]], form: Form) -> Xml:
    """Start values of elements, each with a prefix."""
    root = Xml("ssv:ParameterSet", {"version": form.version, "name": SET_NAME})
    parameters = SubElement(root, "ssv:Parameters")
    for prefix, element in elements:
        units: Mapping[str, str] = {v.name: v.unit for v in element.layout.variables}
        for name, value in element.start.items():
            if value is False:  # the units' own start; FMPy 0.3 takes a written false for true
                continue
            parameter = SubElement(parameters, "ssv:Parameter", {"name": prefix + name})
            if value is True:
                SubElement(parameter, "ssv:Boolean", {"value": flag(value)})
            else:
                about = {"value": repr(float(value)), "unit": units[name]}
                SubElement(parameter, f"ssv:{form.real}", about)
    return root


def _step_for_omsimulator(system: Xml, step: float) -> None:
    """OMSimulator takes its communication step from here, and runs no system without it."""
    annotations = SubElement(system, "ssd:Annotations")
    annotation = SubElement(annotations, "ssc:Annotation", {"type": "org.openmodelica"})
    own = SubElement(SubElement(annotation, "oms:Annotations"), "oms:SimulationInformation")
    about = {"description": "oms-ma", "stepSize": repr(step), "relativeTolerance": "0.0001"}
    SubElement(own, "oms:FixedStepMaster", about)
