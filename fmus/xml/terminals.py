"""The icon of an FMU, and the terminals of FMI 3.0: one for each plane of a rotor."""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

from ..unit import SizedUnit
from .description import text_of

_PLANE = re.compile(r"^(?:der\()?(?:\w+\.)?plane\[(\d+)\]\.(\w+)(?:(?:,(\d))?\))?$")
_EXTENT = {"x1": "-100", "y1": "-100", "x2": "100", "y2": "100"}


def icon(unit: SizedUnit, fmi: int) -> dict[str, bytes]:
    """Files of the icon where each version of FMI has them; in FMI 3.0 with the terminals."""
    folder = Path(__file__).parent
    picture, drawing = ((folder / f"icon.{kind}").read_bytes() for kind in ("png", "svg"))
    if fmi == 2:
        return {"model.png": picture, "documentation/icon.svg": drawing.replace(b"\r\n", b"\n")}
    return {
        "terminalsAndIcons/icon.png": picture,
        "terminalsAndIcons/icon.svg": drawing.replace(b"\r\n", b"\n"),
        "terminalsAndIcons/terminalsAndIcons.xml": _terminals(unit),
    }


def _terminals(unit: SizedUnit) -> bytes:
    """terminalsAndIcons.xml: inputs and outputs of a plane together."""
    root = Element("fmiTerminalsAndIcons", {"fmiVersion": "3.0"})
    graphic = SubElement(root, "GraphicalRepresentation")
    across = {**_EXTENT, "suggestedScalingFactorTo_mm": "0.1"}
    SubElement(graphic, "CoordinateSystem", across)
    SubElement(graphic, "Icon", _EXTENT)
    planes: dict[str, list[tuple[str, str]]] = {}
    for v in unit.shown:
        found = _PLANE.match(v.name)
        if found and v.causality != "parameter":
            member = re.sub(r"(^|\()(?:\w+\.)?plane\[\d+\]\.", r"\1", v.name)
            planes.setdefault(found[1], []).append((member, unit.label(v.name)))
    terminals = SubElement(root, "Terminals") if planes else root
    for number, members in planes.items():
        about = {"name": f"plane{number}", "matchingRule": "bus"}
        about["description"] = f"Motion of plane {number} of the rotor and forces on it"
        terminal = SubElement(terminals, "Terminal", about)
        for member, name in members:
            of = {"variableKind": "signal", "memberName": member, "variableName": name}
            SubElement(terminal, "TerminalMemberVariable", of)
        place = {"x1": "90", "x2": "110", "iconBaseName": "icon"}
        height = 100 - 200 * int(number) // (len(planes) + 1)
        corners = {"y1": str(height - 10), "y2": str(height + 10)}
        look = {"defaultConnectionColor": "31 59 87"}
        SubElement(terminal, "TerminalGraphicalRepresentation", {**look, **place, **corners})
    return text_of(root)
