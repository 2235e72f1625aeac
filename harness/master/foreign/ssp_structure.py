"""What is read of an SSP file, and its XML."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any
from xml.etree import ElementTree

from ...errors import UnitError
from .archive import FETCH_AGAIN

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


def real(found: Structure, text: str, where: str) -> float:
    """A number of the file.

    Raises:
        UnitError: it is none, or not finite.
    """
    with suppress(ValueError):
        if math.isfinite(value := float(text)):
            return value
    raise UnitError(f"{found.path}: {where} = {text!r}: must be a finite number")


def inside(found: Structure, source: str) -> PurePosixPath:
    """A path within the archive."""
    path = PurePosixPath(source)
    if ":" in source or path.is_absolute() or ".." in path.parts:
        raise UnitError(f"{found.path}: source {source!r}: must be a path within the SSP")
    return path


def parsed(path: Path, folder: Path, name: str) -> Element:
    file = folder / name
    if ":" in name or not file.resolve().is_relative_to(folder.resolve()) or not file.is_file():
        raise UnitError(f"{path}: has no {name}: is not an SSP, or is not complete; {FETCH_AGAIN}")
    text = file.read_bytes()
    if b"<!DOCTYPE" in text or b"<!ENTITY" in text:
        raise UnitError(f"{path}: {name} defines entities: no SSP needs that")
    try:
        return ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError) as error:
        raise UnitError(f"{path}: {name} is not XML: {error}") from error


def tag_of(element: Element) -> str:
    return element.tag.rpartition("}")[2]


def children(element: Element | None) -> list[Element]:
    return [] if element is None else list(element)


def child(element: Element, tag: str) -> Element | None:
    return next((each for each in element if tag_of(each) == tag), None)


def connectors(element: Element) -> list[Element]:
    return children(child(element, "Connectors"))
