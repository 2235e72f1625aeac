"""Where forces along fixed axes act on the rotor: `rotor.support[2].F_x` in a connection."""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import NamedTuple

from .rotor_table import RotorTable
from .unit import Connection

FORMS = "rotor.F_x, rotor.station[1].F_x, rotor.support[1].F_x or rotor.plane[1].F_x, and F_y"
_PORT = r"rotor\.(?:(?P<kind>station|support|plane)\[(?P<number>\d+)\]\.)?F_(?P<axis>[xy])"
_SUPPORT = r"rotor\.support\[(\d+)\]\.(?=v?[xy]$)"


class Push(NamedTuple):
    """A place that a force acts on.

    Attributes:
        kind: station, support, or plane of the rotor's unit.
        number: of it, from 1.
        axis: x or y.
    """

    kind: str
    number: int
    axis: str


def push_of(port: str) -> Push | None:
    """What a port of the rotor such as `rotor.support[1].F_x` means; None: another port."""
    found = re.fullmatch(_PORT, port)
    return found and Push(found["kind"] or "station", int(found["number"] or 1), found["axis"])


def pushes(connections: Iterable[Connection]) -> list[Push]:
    """All places that connections push on."""
    return [push for one in connections if (push := push_of(one.to))]


def push_problems(rotor: RotorTable, connections: Iterable[Connection]) -> list[str]:
    """Places that the rotor does not have, a line each; planes are those of its unit."""
    counts = {"station": len(rotor.stations), "support": len(rotor.supports)}
    lines = []
    for number, one in enumerate(connections, start=1):
        push = push_of(one.to)
        where = f'connection[{number}].to = "{one.to}"'
        if push and push.kind in counts and not 1 <= push.number <= counts[push.kind]:
            lines.append(
                f"{where}: the rotor has {counts[push.kind]} {push.kind}s; forces act at {FORMS}"
            )
        elif push and one.to.startswith("rotor.F_") and counts["station"] > 1:
            lines.append(f"{where}: the rotor has {counts['station']} stations: name one: {FORMS}")
    return lines


def read_port(port: str, rotor: RotorTable) -> str:
    """A port of the rotor by the names of its unit: `rotor.support[1].x` is that of its station."""
    found = re.match(_SUPPORT, port)
    if found is None or not 1 <= int(found[1]) <= len(rotor.supports):
        return port
    station = rotor.supports[int(found[1]) - 1]
    prefix = f"station[{station}]." if len(rotor.points) > 1 else ""
    return f"rotor.{prefix}{port[found.end() :]}"
