"""What a system structure package says of a scene: elements, wires, start values; no XML yet."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

from ....fmus.catalogue import sized_unit
from ....fmus.variables import Layout, derivative
from ...errors import SceneError
from ...master.names import by_unit
from ...master.one_file import composition
from ...master.plan import Plan, Port, plan
from ...master.recorder import recorded
from ...master.schedule import end_time, step_size
from ...scene import Scene
from ..start import start_values

DRIVE = ("speed", "acceleration")


class Wire(NamedTuple):
    """A connection; a port without a unit is an input or output of the whole system."""

    source: Port
    target: Port


@dataclass(frozen=True)
class Element:
    """One FMU instance.

    Attributes:
        layout: its variables.
        start: values of parameters, and of inputs at the start.
        shown: outputs for records, whether something is connected to them or not.
    """

    name: str
    layout: Layout
    start: Mapping[str, float | bool]
    shown: tuple[str, ...]


@dataclass(frozen=True)
class Structure:
    """The system: the rotor first; `step` between communication points and `end` of the run [s].

    Attributes:
        outputs: wires from what elements show to outputs of the system, such as `rotor_x`.
    """

    name: str
    title: str
    elements: tuple[Element, ...]
    wires: tuple[Wire, ...]
    step: float
    end: float
    outputs: tuple[Wire, ...] = ()


def separate(scene: Scene, slopes: bool = True) -> Structure:
    """The units of a scene and their connections, with slopes or the values alone.

    Raises:
        SceneError: an input takes the sum of several forces or torques, which a connection cannot
            express.
    """
    if scene.operation.motor:
        raise SceneError(
            f"{scene.label}: operation.motor: SSP: torques on its shaft add up, and a connection "
            "has one source: use --one-file --ssp"
        )
    if scene.operation.unbalance_changes:
        raise SceneError(
            f"{scene.label}: operation.unbalance_changes: SSP sets parameters at the start alone: "
            "--one-file --ssp has the changes"
        )
    planned, shown = plan(scene), by_unit(recorded(scene))
    start = start_values(scene)
    wires = _wires(scene, planned, slopes)
    elements = [
        Element(
            unit.name,
            sized_unit(unit.model, **unit.sizes).layout,
            start[unit.name],
            tuple(shown.get(unit.name, ())),
        )
        for unit in planned.units
    ]
    driven = [unit.name for unit in planned.units if unit.driven]
    drive = _drive(scene, driven)
    return _structure(scene, elements, [*wires, *drive], lambda element: f"{element.name}.")


def coupled(scene: Scene) -> Structure:
    """The composite FMU of a scene as the only element.

    Raises:
        SceneError: as `composition`.
    """
    made = composition(scene)
    layout = made.layout
    given = {f"{part.name}.{k}": v for part in made.parts for k, v in part.start.items()}
    settable = {v.name for v in made.described(scene.name).shown if v.causality != "output"}
    start = {k: v for k, v in {**given, **made.start}.items() if k in settable}
    said = made.described(scene.name)
    named = Layout(scene.name, [replace(v, name=said.label(v.name)) for v in layout.variables])
    start = {said.label(k): v for k, v in start.items()}
    shown = tuple(map(said.label, recorded(scene)))
    element = Element(scene.name, named, start, shown)
    return _structure(scene, [element], _drive(scene, [element.name]), lambda _: "")


def _structure(
    scene: Scene, elements: list[Element], wires: list[Wire], of_unit: Callable[[Element], str]
) -> Structure:
    """`of_unit`: what a signal's name begins with before the name of a variable."""
    step, end = step_size(scene), end_time(scene)
    outputs = tuple(
        Wire(Port(element.name, variable), Port("", _flat(f"{of_unit(element)}{variable}")))
        for element in elements
        for variable in element.shown
    )
    named = scene.name, scene.title
    return Structure(*named, tuple(elements), tuple(wires), step, end, outputs)


def _flat(signal: str) -> str:
    """Name of an output of the system."""
    return re.sub(r"\W+", "_", signal).strip("_")


def _wires(scene: Scene, planned: Plan, slopes: bool) -> list[Wire]:
    """The plan's connections; a sum of added masses is a start value of the rotor instead."""
    found = []
    for target, sources in planned.inputs("signal").items():
        if len(sources) > 1:
            units = ", ".join(source.unit for source in sources)
            raise SceneError(
                f"{scene.label}: SSP: forces of {units} on one plane add up, and a connection has "
                "one source: use --one-file --ssp"
            )
        for order in (0, 1) if slopes else (0,):
            ends = [Port(p.unit, derivative(p.variable, order)) for p in (sources[0], target)]
            found.append(Wire(*ends))
    plain = planned.inputs("value", "mass").items()
    return found + [Wire(sources[0], target) for target, sources in plain if len(sources) == 1]


def _drive(scene: Scene, driven: list[str]) -> list[Wire]:
    """Speed and acceleration from outside where they change; a constant speed is a start value."""
    if not scene.profile().changes:
        return []
    return [Wire(Port("", name), Port(unit, name)) for name in DRIVE for unit in driven]
