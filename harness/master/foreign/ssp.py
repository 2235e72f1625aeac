"""An SSP file as the document of a system: components, connections and parameters, flattened.

SSP 1.0 and 2.0 (the same elements): nested systems, parameter sets in the description or in files,
with prefixes and mappings, linear transformations of connections without an offset.  Names of
units join those of the systems around them by `_`.
"""

from __future__ import annotations

import os
import re
import zipfile
import zlib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from ...errors import UnitError
from ...scene.patterns import LONGEST_NAME, legal_characters
from .archive import FETCH_AGAIN, new_folder, read_description, refuse_dangerous
from .ssp_parameters import bound, set_parameter
from .ssp_structure import (
    Element,
    Structure,
    child,
    children,
    connectors,
    inside,
    parsed,
    real,
    tag_of,
)
from .ssp_wires import directed, factor_of, refuse_loose_ends, sources_of, traced

STRUCTURE = "SystemStructure.ssd"
DEFAULT_DURATION = 1.0  # s: where the file suggests none
_FMU_TYPES = ("", "application/x-fmu-sharedlibrary")


def unpacked_system(path: Path) -> tuple[dict[str, Any], Path]:
    """Document of the system in an SSP file, and the folder that holds its FMUs.

    The folder is the caller's to remove.

    Raises:
        UnitError: it is no SSP that can be read, or has what is not supported.
    """
    with new_folder("autobalancer-ssp-") as folder:
        try:
            with zipfile.ZipFile(path) as archive:
                refuse_dangerous(path, archive)
                archive.extractall(folder)
            document = _document(path, folder)
            for unit in document["unit"]:
                read_description(folder / unit["fmu"])
            return document, folder
        except UnitError as error:  # of a file that is gone when the message is read
            raise UnitError(str(error).replace(f"{folder}{os.sep}", f"{path}: ")) from error
        except (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError) as error:
            why = f"is not a sound SSP, which is a zip archive: {error}"
            raise UnitError(f"{path}: {why}; {FETCH_AGAIN}") from error
        except OSError as error:
            why = f"cannot be unpacked into {folder}: {error.strerror or error}"
            raise UnitError(f"{path}: {why}; free some room, or set TMPDIR") from error


def _document(path: Path, folder: Path) -> dict[str, Any]:
    root = parsed(path, folder, STRUCTURE)
    system = child(root, "System")
    if system is None:
        raise UnitError(f"{path}: {STRUCTURE} has no System: is not an SSP")
    found = Structure(path, folder)
    _read_system(found, system, "")
    stop = _duration(found, child(root, "DefaultExperiment"))
    refuse_loose_ends(found)
    sources = sources_of(found)
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
    shown = [traced(found, node) for node in found.outputs]
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
        real(found, experiment.get(key) or default, f"DefaultExperiment.{key}")
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
        name = legal_characters(path)[-LONGEST_NAME:]
        name = re.sub(r"^[\d-]", "_", name)
        number = 2
        while name in found.values():
            name, number = f"{name[: LONGEST_NAME - 4].rstrip('_')}_{number}", number + 1
        found[path] = name
    return found


def _read_system(found: Structure, system: Element, prefix: str) -> None:
    """A system and those within it; `prefix` its path with a dot at the end, empty at the top."""
    own = prefix.rstrip(".")
    found.systems[own] = [c.get("name", "") for c in connectors(system)]
    if not own:
        found.outputs = [
            (own, c.get("name", "")) for c in connectors(system) if c.get("kind") == "output"
        ]
    for one in children(child(system, "Elements")):
        name, tag = prefix + one.get("name", ""), tag_of(one)
        if name in found.components or name in found.systems:
            raise UnitError(f"{found.path}: {name}: two elements have this name")
        if tag == "System":
            _read_system(found, one, f"{name}.")
        elif tag == "Component":
            _read_component(found, one, name)
        else:
            raise UnitError(f"{found.path}: {name}: {tag} is not supported: FMUs and systems are")
    for one in children(child(system, "Connections")):
        if tag_of(one) != "Connection":
            continue
        ends = [
            ((prefix + one.get(f"{end}Element", "")).rstrip("."), one.get(f"{end}Connector", ""))
            for end in ("start", "end")
        ]
        found.wires.append((*directed(found, ends[0], ends[1]), factor_of(found, one)))
    for name, value in bound(found, system):  # of whole systems they go before those of parts
        set_parameter(found, prefix + name, value)


def _read_component(found: Structure, one: Element, name: str) -> None:
    source = one.get("source", "")
    if source.endswith((".ssd", ".ssp")) or one.get("type", "") not in _FMU_TYPES:
        raise UnitError(
            f"{found.path}: {name}: source {source!r} of type {one.get('type', '')!r} is not "
            "supported: components are FMUs"
        )
    place = inside(found, source)
    if not (found.folder / place).is_file():
        raise UnitError(
            f"{found.path}: {name}: the archive has no {source!r}: pack the FMU into it"
        )
    found.components[name] = str(place)
    for parameter, value in bound(found, one):
        found.start.setdefault(name, {})[parameter] = value
