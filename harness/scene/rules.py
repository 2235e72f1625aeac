"""What the tables of a scene demand of each other."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from ...models.rotor import LinearRotor
from .messages import Place, show, statement
from .rotor import Rotor

if TYPE_CHECKING:
    from .scene import Scene

TABLES = ("rotor", "operation", "coupling", "run")
_ROTOR: TypeAdapter[Any] = TypeAdapter(Rotor)
# keys of a balancer by what is then true of it
_WITHOUT_SECOND_DERIVATIVES = {
    "weight_radius": "can_meet",
    "rolling_resistance": "can_stick",
    "track_offset": "offset",
}


def plane_count(rotor: Any) -> int | None:
    """Planes of a rotor's table; None where the table is wrong itself."""
    try:
        return int(_ROTOR.validate_python(rotor).plane_count)
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


def refused_together(scene: Scene, rotor: LinearRotor) -> list[str]:
    """Problems of a scene whose tables are right, each for itself."""
    lines = _refused_under_a_motor(scene, rotor) + _refused_with_quintics(scene)
    lines += scene.balancing.problems(scene.rotor) if scene.balancing else []
    one_liquid = [b.kind for b in scene.balancer] == ["liquid"]
    fits = one_liquid and rotor.isotropic and scene.rotor.kind == "planar"
    lines += [
        f'check[{i}].kind = "liquid_window": needs a planar rotor with equal stiffness '
        "and damping in x and y, and one balancer of kind liquid"
        for i, check in enumerate(scene.check, start=1)
        if check.kind == "liquid_window" and not fits
    ]
    return lines


def without_second_derivatives(scene: Scene) -> list[str]:
    """Keys of what has no second derivatives of its signals."""
    drives = ("run_up", "motor")
    wrong = [f"operation.{what}" for what in drives if getattr(scene.operation, what)]
    wrong += ["rotor.friction"] if scene.rotor.friction else []
    wrong += [
        f"balancer[{i}].{key}"
        for i, balancer in enumerate(scene.balancer, start=1)
        for key, what in _WITHOUT_SECOND_DERIVATIVES.items()
        if getattr(balancer, what, None)
    ]
    return wrong


def _refused_with_quintics(scene: Scene) -> list[str]:
    """What cannot be coupled by them."""
    return [
        f"{what}: coupling.order = 5 takes a constant speed, supports without dry friction, "
        "and point weights on centred tracks: leave this out, or take order = 3"
        for what in (without_second_derivatives(scene) if scene.coupling.order == 5 else ())
    ]


def _refused_under_a_motor(scene: Scene, rotor: LinearRotor) -> list[str]:
    """What a motor of limited power cannot drive."""
    motor = scene.operation.motor
    if motor is None:
        return []
    lines = []
    u = rotor.unbalance
    least = float((u.conj() @ np.linalg.solve(rotor.mass, u)).real)
    if not motor.inertia > least:
        lines.append(
            f"operation.motor.inertia = {motor.inertia:g} kg m^2: must be above {least:.6g}, "
            "the unbalance's own: squared static moment over mass"
        )
    if scene.coupling.scheme == "compensated":
        lines.append(
            'coupling.scheme = "compensated": does not know operation.motor: must be "auto", '
            '"iterated", "gauss-seidel" or "jacobi"'
        )
    return lines
