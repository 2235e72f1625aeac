"""What a system structure package says of a scene: elements, wires, start values; no XML yet."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
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
    """An output connected to an input; without a source unit to an input of the whole system."""

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
    """The system: the rotor first; `step` between communication points and `end` of the run [s]."""

    name: str
    title: str
    elements: tuple[Element, ...]
    wires: tuple[Wire, ...]
    step: float
    end: float


def separate(scene: Scene, slopes: bool = True) -> Structure:
    """The units of a scene and their connections, with slopes or the values alone.

    Raises:
        SceneError: an input takes the sum of several forces or torques, which a connection cannot
            express.
    """
    if scene.operation.motor:
        raise SceneError(
            f"{scene.name}: operation.motor: SSP: torques on its shaft add up, and a connection "
            "has one source: use --one-file --ssp"
        )
    if scene.operation.unbalance_changes:
        raise SceneError(
            f"{scene.name}: operation.unbalance_changes: SSP sets parameters at the start alone: "
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
    return _structure(scene, elements, [*wires, *_drive(scene, driven)])


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
    element = Element(scene.name, layout, start, tuple(recorded(scene)))
    return _structure(scene, [element], _drive(scene, [element.name]))


def _structure(scene: Scene, elements: list[Element], wires: list[Wire]) -> Structure:
    step, end = step_size(scene), end_time(scene)
    return Structure(scene.name, scene.title, tuple(elements), tuple(wires), step, end)


def _wires(scene: Scene, planned: Plan, slopes: bool) -> list[Wire]:
    """The plan's connections; a sum of added masses is a start value of the rotor instead."""
    found = []
    for target, sources in planned.inputs("signal").items():
        if len(sources) > 1:
            units = ", ".join(source.unit for source in sources)
            raise SceneError(
                f"{scene.name}: SSP: forces of {units} on one plane add up, and a connection has "
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
