"""Where elements and connectors are in a tool's diagram: the rotor left, the balancers right of it.

Both ends of a wire have one height, so that wires are level lines that do not cross.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from ..names import by_unit
from .structure import Element, Structure, Wire

ROW = 10.0  # between two connectors; as in most tools an element is some tens wide
WIDTH, APART = 120.0, 80.0
LEFT, RIGHT = 0.0, 1.0


@dataclass(frozen=True)
class Box:
    """An element: its corners, and its connectors' places as parts of width and height."""

    x: float
    bottom: float
    top: float
    places: dict[str, tuple[float, float]] = field(default_factory=dict)

    @property
    def across(self) -> tuple[float, float]:
        """Left and right edge."""
        return self.x, self.x + WIDTH

    def place_connector(self, connector: str, side: float, height: float) -> None:
        """Place a connector; one that has a place keeps it."""
        part = (height - self.bottom) / (self.top - self.bottom)
        self.places.setdefault(connector, (side, part))


def placed(structure: Structure) -> dict[str, Box]:
    """The boxes of all elements, by name, from the top of the diagram at 0 downwards."""
    first, *others = structure.elements
    inner = {other.name: _between(structure, other) for other in others}
    free = {element.name: _free(structure, element) for element in structure.elements}
    boxes, top = {}, 0.0
    for other in others:
        rows = max(len(inner[other.name]), len(free[other.name])) + 1
        boxes[other.name] = Box(WIDTH + APART, top - ROW * rows, top)
        top -= ROW * (rows + 1)
    bottom = min(top + ROW, -ROW * (len(free[first.name]) + 1))
    boxes = {first.name: Box(0.0, bottom, 0.0), **boxes}
    for other in others:
        box = boxes[other.name]
        for row, wire in enumerate(inner[other.name], start=1):
            for port in wire:
                side = RIGHT if port.unit == first.name else LEFT
                boxes[port.unit].place_connector(port.variable, side, box.top - ROW * row)
    for name, connectors in free.items():
        side = LEFT if others and name == first.name else RIGHT
        for row, connector in enumerate(connectors, start=1):
            boxes[name].place_connector(connector, side, boxes[name].top - ROW * row)
    return boxes


def _between(structure: Structure, element: Element) -> list[Wire]:
    """Wires of an element with the rotor."""
    return [w for w in structure.wires if w.source.unit and element.name in (w[0].unit, w[1].unit)]


def _free(structure: Structure, element: Element) -> list[str]:
    """Connectors of an element that no other element is wired to."""
    driven = [w.target for w in structure.wires if not w.source.unit]
    inputs = by_unit(f"{p.unit}.{p.variable}" for p in driven).get(element.name, [])
    wired = {p.variable for w in structure.wires for p in w if p.unit == element.name}
    return inputs + [name for name in element.shown if name not in wired]
