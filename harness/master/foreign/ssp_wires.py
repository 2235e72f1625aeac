"""Connections of an SSP file: from their sources on, followed through nested systems."""

from __future__ import annotations

from ...errors import UnitError
from ...scene.messages import did_you_mean
from .archive import read_description
from .ssp_structure import Element, Node, Structure, real, tag_of


def refuse_loose_ends(found: Structure) -> None:
    """Raise UnitError for connections to what is not there, or of what has a source already."""
    elements = {*found.components, *found.systems}
    ends: set[Node] = set()
    for start, end, _ in found.wires:
        for element, connector in (start, end):
            if element not in elements:
                raise UnitError(
                    f"{found.path}: connection of {connector!r}: no element {element!r}"
                    f"{did_you_mean(element, sorted(elements - {''}))}; elements: "
                    f"{', '.join(sorted(elements - {''}))}"
                )
            if element in found.systems and connector not in found.systems[element]:
                raise UnitError(
                    f"{found.path}: {element or 'the system'} has no connector {connector!r}; it "
                    f"has: {', '.join(found.systems[element]) or 'none'}"
                )
        if end in ends:
            raise UnitError(
                f"{found.path}: {'.'.join(filter(None, end))}: has two connections: an input has "
                "one source"
            )
        ends.add(end)
    for node in ends:
        if node[0] in found.components and not (traced(found, node) or _from_top(found, node)):
            raise UnitError(
                f"{found.path}: {'.'.join(node)}: is connected to a connector that nothing feeds"
            )


def _from_top(found: Structure, node: Node) -> bool:
    """Whether a node gets its value from an input of the whole system, which keeps its start."""
    sources = [start for start, end, _ in found.wires if end == node]
    return node[0] == "" if not sources else any(_from_top(found, one) for one in sources)


def sources_of(found: Structure) -> dict[Node, list[tuple[Node, float]]]:
    """Outputs of components with factors, by the input of a component that they feed."""
    inputs = dict.fromkeys(end for _, end, _ in found.wires if end[0] in found.components)
    feeding = {node: traced(found, node) for node in inputs}
    return {node: each for node, each in feeding.items() if each}


def traced(found: Structure, node: Node, depth: int = 0) -> list[tuple[Node, float]]:
    """Outputs of components that a node gets its value from, through connectors of systems."""
    if depth > len(found.wires):
        raise UnitError(f"{found.path}: connections of {'.'.join(node)} go round in a circle")
    feeding: list[tuple[Node, float]] = []
    for start, end, factor in found.wires:
        if end != node:
            continue
        if start[0] in found.components:
            feeding.append((start, factor))
        else:
            feeding += [(o, factor * own) for o, own in traced(found, start, depth + 1)]
    return feeding


def directed(found: Structure, start: Node, end: Node) -> tuple[Node, Node]:
    """A connection from its source on: the standard lets either end be written first."""
    is_input = [n[0] in found.components and _causality(found, n) == "input" for n in (start, end)]
    shows = [n[0] in found.components and _causality(found, n) == "output" for n in (start, end)]
    return (end, start) if (is_input[0] and not is_input[1]) or (shows[1] and not shows[0]) else (
        start, end)  # fmt: skip


def _causality(found: Structure, node: Node) -> str:
    """Of a variable of a component; empty where the FMU does not have it."""
    description = read_description(found.folder / found.components[node[0]])
    return next((v.causality or "" for v in description.modelVariables if v.name == node[1]), "")


def factor_of(found: Structure, connection: Element) -> float:
    for change in connection:
        name = ".".join([connection.get("endElement", ""), connection.get("endConnector", "")])
        if tag_of(change) == "ConnectionGeometry" or tag_of(change) == "Annotations":
            continue
        where = f"connection to {name}: "
        offset = real(found, change.get("offset", "0"), f"{where}offset")
        if tag_of(change) != "LinearTransformation" or offset:
            raise UnitError(
                f"{found.path}: connection to {name}: {tag_of(change)} with an offset or a table "
                "is not supported: factors are"
            )
        return real(found, change.get("factor", "1"), f"{where}factor")
    return 1.0
