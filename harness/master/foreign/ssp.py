"""An SSP file as the document of a system: components, connections and parameters, flattened.

SSP 1.0 and 2.0 (the same elements): nested systems, parameter sets in the description or in files,
with prefixes and mappings, linear transformations of connections without an offset.  Names of
units join those of the systems around them by `_`.
"""

from __future__ import annotations

import re
import shutil
import zipfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from tempfile import mkdtemp
from typing import Any
from xml.etree import ElementTree

from ...errors import UnitError
from ...scene.messages import did_you_mean
from .archive import read_description, refuse_dangerous

STRUCTURE = "SystemStructure.ssd"
DEFAULT_DURATION = 1.0  # s: where the file suggests none
LONGEST_NAME = 32  # of a unit
_FMU_TYPES = ("", "application/x-fmu-sharedlibrary")
_REALS = ("Real", "Float64", "Float32")
_WHOLE = ("Integer", "Enumeration", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64")
Node = tuple[str, str]  # element's path with dots, and connector
Element = ElementTree.Element


@dataclass
class Structure:
    """What is read of a file.

    Attributes:
        folder: where it is unpacked.
        components: by path with dots, the source of its FMU; `start` its parameters.
        systems: connectors by path with dots; the whole one's is empty.
        wires: from node to node, with a factor.
        outputs: connectors of the whole system.
    """

    path: Path
    folder: Path
    components: dict[str, str] = field(default_factory=dict)
    systems: dict[str, list[str]] = field(default_factory=dict)
    start: dict[str, dict[str, Any]] = field(default_factory=dict)
    wires: list[tuple[Node, Node, float]] = field(default_factory=list)
    outputs: list[Node] = field(default_factory=list)


def unpacked_system(path: Path) -> tuple[dict[str, Any], Path]:
    """Document of the system in an SSP file, and the folder that holds its FMUs.

    The folder is the caller's to remove.

    Raises:
        UnitError: it is no SSP that can be read, or has what is not supported.
    """
    folder = Path(mkdtemp(prefix="autobalancer-ssp-"))
    try:
        with zipfile.ZipFile(path) as archive:
            refuse_dangerous(path, archive)
            archive.extractall(folder)
        return _document(path, folder), folder
    except (zipfile.BadZipFile, EOFError, RuntimeError) as error:
        shutil.rmtree(folder, ignore_errors=True)
        raise UnitError(f"{path}: is not a sound SSP, which is a zip archive: {error}") from error
    except OSError as error:
        shutil.rmtree(folder, ignore_errors=True)
        raise UnitError(f"{path}: cannot be unpacked: {error.strerror or error}") from error
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise


def _document(path: Path, folder: Path) -> dict[str, Any]:
    root = _parsed(path, folder, STRUCTURE)
    system = _child(root, "System")
    if system is None:
        raise UnitError(f"{path}: {STRUCTURE} has no System: is not an SSP")
    found = Structure(path, folder)
    _read_system(found, system, "")
    stop = _duration(found, _child(root, "DefaultExperiment"))
    _refuse_loose_ends(found)
    sources = _sources(found)
    names = _unit_names(found.components)
    connections = []
    for (unit, variable), feeding in sources.items():
        for number, ((source, output), factor) in enumerate(feeding):
            table: dict[str, Any] = {
                "from": f"{names[source]}.{output}",
                "to": f"{names[unit]}.{variable}",
            }
            table |= {"factor": factor} if factor != 1.0 else {}
            connections.append(table | ({"add": True} if number else {}))
    shown = [_traced(found, node) for node in found.outputs]
    run: dict[str, Any] = {"duration": stop}
    if record := [f"{names[u]}.{v}" for each in shown for (u, v), _ in each]:
        run["record"] = list(dict.fromkeys(record))
    return {
        "title": system.get("description") or root.get("name") or "",
        "unit": [
            {"name": names[one], "fmu": source, "start": found.start.get(one, {})}
            for one, source in found.components.items()
        ],
        "connection": connections,
        "run": run,
    }


def _duration(found: Structure, experiment: Element | None) -> float:
    """How long to run [s]."""
    if experiment is None:
        return DEFAULT_DURATION
    start, stop = (
        _real(found, experiment.get(key) or default, f"DefaultExperiment.{key}")
        for key, default in (("startTime", "0"), ("stopTime", repr(DEFAULT_DURATION)))
    )
    if start:
        raise UnitError(
            f"{found.path}: DefaultExperiment.startTime = {start:g}: systems start at 0 s here: "
            "set it to 0, and stopTime to how long the run is"
        )
    return stop


def _unit_names(components: Iterable[str]) -> dict[str, str]:
    """Names of units by paths of components: letters, digits, _ and - of them, each once."""
    found: dict[str, str] = {}
    for path in components:
        name = re.sub(r"^(?=[\d-])|[^\w-]", "_", path, flags=re.ASCII)[-LONGEST_NAME:]
        name = re.sub(r"^[\d-]", "_", name)
        number = 2
        while name in found.values():
            name, number = f"{name[: LONGEST_NAME - 4].rstrip('_')}_{number}", number + 1
        found[path] = name
    return found


def _real(found: Structure, text: str, where: str) -> float:
    """A number of the file."""
    try:
        return float(text)
    except ValueError:
        raise UnitError(f"{found.path}: {where} = {text!r}: must be a number") from None


def _refuse_loose_ends(found: Structure) -> None:
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
        if node[0] in found.components and not (_traced(found, node) or _from_top(found, node)):
            raise UnitError(
                f"{found.path}: {'.'.join(node)}: is connected to a connector that nothing feeds"
            )


def _from_top(found: Structure, node: Node) -> bool:
    """Whether a node gets its value from an input of the whole system, which keeps its start."""
    sources = [start for start, end, _ in found.wires if end == node]
    return node[0] == "" if not sources else any(_from_top(found, one) for one in sources)


def _read_system(found: Structure, system: Element, prefix: str) -> None:
    """A system and those within it; `prefix` its path with a dot at the end, empty at the top."""
    own = prefix.rstrip(".")
    found.systems[own] = [c.get("name", "") for c in _connectors(system)]
    if not own:
        found.outputs = [
            (own, c.get("name", "")) for c in _connectors(system) if c.get("kind") == "output"
        ]
    for one in _children(_child(system, "Elements")):
        name, tag = prefix + one.get("name", ""), _tag(one)
        if name in found.components or name in found.systems:
            raise UnitError(f"{found.path}: {name}: two elements have this name")
        if tag == "System":
            _read_system(found, one, f"{name}.")
        elif tag == "Component":
            _read_component(found, one, name)
        else:
            raise UnitError(f"{found.path}: {name}: {tag} is not supported: FMUs and systems are")
    for one in _children(_child(system, "Connections")):
        if _tag(one) != "Connection":
            continue
        ends = [
            ((prefix + one.get(f"{end}Element", "")).rstrip("."), one.get(f"{end}Connector", ""))
            for end in ("start", "end")
        ]
        found.wires.append((*_directed(found, ends[0], ends[1]), _factor(found, one)))
    for name, value in _bound(found, system):  # of whole systems they go before those of parts
        _set(found, prefix + name, value)


def _directed(found: Structure, start: Node, end: Node) -> tuple[Node, Node]:
    """A connection from its source on: the standard lets either end be written first."""
    is_input = [n[0] in found.components and _causality(found, n) == "input" for n in (start, end)]
    shows = [n[0] in found.components and _causality(found, n) == "output" for n in (start, end)]
    return (end, start) if (is_input[0] and not is_input[1]) or (shows[1] and not shows[0]) else (
        start, end)  # fmt: skip


def _causality(found: Structure, node: Node) -> str:
    """Of a variable of a component; empty where the FMU does not have it."""
    description = read_description(found.folder / found.components[node[0]])
    return next((v.causality or "" for v in description.modelVariables if v.name == node[1]), "")


def _read_component(found: Structure, one: Element, name: str) -> None:
    source = one.get("source", "")
    if source.endswith((".ssd", ".ssp")) or one.get("type", "") not in _FMU_TYPES:
        raise UnitError(
            f"{found.path}: {name}: source {source!r} of type {one.get('type', '')!r} is not "
            "supported: components are FMUs"
        )
    inside = _inside(found, source)
    if not (found.folder / inside).is_file():
        raise UnitError(
            f"{found.path}: {name}: the archive has no {source!r}: pack the FMU into it"
        )
    found.components[name] = str(inside)
    for parameter, value in _bound(found, one):
        found.start.setdefault(name, {})[parameter] = value


def _set(found: Structure, path: str, value: Any) -> None:
    """A parameter of a system: of the component in whose path it begins, or one fed by it."""
    for name in found.components:
        if path.startswith(f"{name}."):
            found.start.setdefault(name, {})[path[len(name) + 1 :]] = value
            return
    owner, _, connector = path.rpartition(".")
    if connector not in found.systems.get(owner, ()):
        raise UnitError(
            f"{found.path}: parameter {path!r}: is of no component and no connector; components: "
            f"{', '.join(found.components)}"
        )
    for (element, output), (target, variable), factor in found.wires:
        if (element, output) == (owner, connector) and target in found.components:
            scaled = value * factor if isinstance(value, float) else value
            found.start.setdefault(target, {})[variable] = scaled


def _bound(found: Structure, owner: Element) -> Iterator[tuple[str, Any]]:
    """Names and values of the parameters that are bound to a system or a component."""
    for binding in _children(_child(owner, "ParameterBindings")):
        prefix = binding.get("prefix", "")
        if source := binding.get("source"):
            sets = [_parsed(found.path, found.folder, source)]
        else:
            sets = list(_children(_child(binding, "ParameterValues")))
        mapping = _child(binding, "ParameterMapping")
        if mapping is not None and mapping.get("source"):
            entries = list(_parsed(found.path, found.folder, mapping.get("source", "")))
        else:
            entries = [
                e for m in _children(mapping) for e in (m if _tag(m) != "MappingEntry" else [m])
            ]
        for one in sets:
            for name, value in _values(found, one):
                yield from _mapped(found, prefix + name, value, entries)


def _mapped(
    found: Structure, name: str, value: Any, entries: list[Element]
) -> Iterator[tuple[str, Any]]:
    """A parameter by the names that a mapping gives it; by its own where there is none."""
    own = [e for e in entries if e.get("source") == name]
    if not own:
        yield name, value
    for entry in own:
        change = _child(entry, "LinearTransformation")
        if change is not None and isinstance(value, float):
            factor, offset = (
                _real(found, change.get(key, default), f"mapping of {name}: {key}")
                for key, default in (("factor", "1"), ("offset", "0"))
            )
            yield entry.get("target", ""), value * factor + offset
        elif len(list(entry)) and change is None:
            raise UnitError(
                f"{found.path}: mapping of {name}: {_tag(entry[0])} is not supported: linear ones "
                "of real parameters are"
            )
        else:
            yield entry.get("target", ""), value


def _values(found: Structure, parameter_set: Element) -> Iterator[tuple[str, Any]]:
    for parameter in _children(_child(parameter_set, "Parameters")):
        name = parameter.get("name", "")
        for value in parameter:
            text, tag = value.get("value", ""), _tag(value)
            if tag in _REALS:
                yield name, _real(found, text, f"parameter {name}")
            elif tag in _WHOLE:
                whole = _real(found, text, f"parameter {name}")
                if whole != round(whole):
                    raise UnitError(f"{found.path}: parameter {name} = {text}: must be whole")
                yield name, int(whole)
            elif tag == "Boolean":
                yield name, text in ("true", "1")
            elif tag == "String":
                yield name, text


def _sources(found: Structure) -> dict[Node, list[tuple[Node, float]]]:
    """Outputs of components with factors, by the input of a component that they feed."""
    inputs = dict.fromkeys(end for _, end, _ in found.wires if end[0] in found.components)
    traced = {node: _traced(found, node) for node in inputs}
    return {node: each for node, each in traced.items() if each}


def _traced(found: Structure, node: Node, depth: int = 0) -> list[tuple[Node, float]]:
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
            feeding += [(o, factor * own) for o, own in _traced(found, start, depth + 1)]
    return feeding


def _factor(found: Structure, connection: Element) -> float:
    for change in connection:
        name = ".".join([connection.get("endElement", ""), connection.get("endConnector", "")])
        if _tag(change) == "ConnectionGeometry" or _tag(change) == "Annotations":
            continue
        where = f"connection to {name}: "
        offset = _real(found, change.get("offset", "0"), f"{where}offset")
        if _tag(change) != "LinearTransformation" or offset:
            raise UnitError(
                f"{found.path}: connection to {name}: {_tag(change)} with an offset or a table is "
                "not supported: factors are"
            )
        return _real(found, change.get("factor", "1"), f"{where}factor")
    return 1.0


def _inside(found: Structure, source: str) -> PurePosixPath:
    """A path within the archive."""
    path = PurePosixPath(source)
    if ":" in source or path.is_absolute() or ".." in path.parts:
        raise UnitError(f"{found.path}: source {source!r}: must be a path within the SSP")
    return path


def _parsed(path: Path, folder: Path, name: str) -> Element:
    file = folder / name
    if ":" in name or not file.resolve().is_relative_to(folder.resolve()) or not file.is_file():
        raise UnitError(f"{path}: has no {name}: is not an SSP, or is not complete")
    text = file.read_bytes()
    if b"<!DOCTYPE" in text or b"<!ENTITY" in text:
        raise UnitError(f"{path}: {name} defines entities: no SSP needs that")
    try:
        return ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError) as error:
        raise UnitError(f"{path}: {name} is not XML: {error}") from error


def _tag(element: Element) -> str:
    return element.tag.rpartition("}")[2]


def _children(element: Element | None) -> list[Element]:
    return [] if element is None else list(element)


def _child(element: Element, tag: str) -> Element | None:
    return next((each for each in element if _tag(each) == tag), None)


def _connectors(element: Element) -> list[Element]:
    return _children(_child(element, "Connectors"))
