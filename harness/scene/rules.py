"""Problems between the tables of a scene, found in its document."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from .messages import Place, show, statement
from .rotor import Rotor

if TYPE_CHECKING:
    from pydantic import TypeAdapter

TABLES = ("rotor", "operation", "coupling", "run")


@cache
def _rotor() -> TypeAdapter[Any]:
    from pydantic import TypeAdapter  # a right scene never asks

    return TypeAdapter(Rotor)


def plane_count(rotor: Any) -> int | None:
    """Planes of a rotor's table; None where the table is wrong itself."""
    try:
        return int(_rotor().validate_python(rotor).plane_count)
    except ValidationError:
        return None


def across(document: Mapping[str, Any], planes: int | None) -> list[str]:
    """Problems between tables, found in the document even when single values are wrong."""
    balancers = document.get("balancer", [])
    if not isinstance(balancers, list):
        return []
    entries = [(i, b) for i, b in enumerate(balancers, start=1) if isinstance(b, dict)]
    lines = []
    owners = {name: f"the table [{name}]" for name in (*TABLES, "balancing")}
    operation = document.get("operation")
    if isinstance(operation, dict) and operation.get("motor") is not None:
        owners["motor"] = "operation.motor"
    for i, entry in entries:
        name = entry.get("name", entry.get("kind"))
        if not isinstance(name, str):
            continue
        if name in owners:
            lines.append(
                f"balancer[{i}].name = {show(name)}: taken by {owners[name]}; give every balancer "
                "a name of its own"
            )
        owners.setdefault(name, f"balancer[{i}]")
    allowed = {None: "", 0: "the rotor has no planes", 1: "must be 1, the rotor's only plane"}.get(
        planes, f"must be 1 to {planes}, the rotor's planes"
    )
    for i, entry in entries:
        at = entry.get("at", 1)
        if planes is not None and type(at) is int and at > planes:
            lines.append(statement(Place(f"balancer[{i}].at", at, "", None), allowed))
    return lines
