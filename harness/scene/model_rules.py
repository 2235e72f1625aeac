"""Problems that the models see, once the tables of a scene are right by themselves.

Each function gives a line for every problem, or none.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ...models.rotor import LinearRotor
from .balancer import AnyBalancer
from .check import AnyCheck
from .rotor import Rotor
from .run import Motor, Operation

# keys of a balancer by what is then true of it
_WITHOUT_SECOND_DERIVATIVES = {
    "weight_radius": "can_meet",
    "rolling_resistance": "can_stick",
}


def without_second_derivatives(
    rotor: Rotor, operation: Operation, balancers: Sequence[AnyBalancer]
) -> dict[str, str]:
    """Keys of what has no second derivatives of its signals, and why."""
    wrong = {}
    if operation.motor:
        wrong["operation.motor"] = "the acceleration of its shaft is exchanged as a cubic"
    if rotor.friction:
        wrong["rotor.friction"] = "the rotor's Taylor series between events takes cubics"
    return wrong | {
        f"balancer[{i}].{key}": "only weights that cannot meet or stick have second derivatives"
        for i, balancer in enumerate(balancers, start=1)
        for key, what in _WITHOUT_SECOND_DERIVATIVES.items()
        if getattr(balancer, what, None)
    }


def native_alone(
    rotor: Rotor, operation: Operation, balancers: Sequence[AnyBalancer], order: int
) -> list[str]:
    """Keys of what native units compute and Python units do not."""
    keys = ["operation.motor"] if operation.motor else []
    keys += ["operation.unbalance_changes"] if operation.unbalance_changes else []
    keys += ["rotor.friction"] if rotor.friction else []
    keys += ["coupling.order"] if order == 5 else []
    for i, balancer in enumerate(balancers, start=1):
        own = [key for key in ("weight_radius", "rolling_resistance") if getattr(balancer, key, 0)]
        own += ["track_offset"] if getattr(balancer, "offset", 0) else []
        keys += [f"balancer[{i}].{key}" for key in own]
    return keys


def in_python(keys: Sequence[str]) -> list[str]:
    """What Python units do not compute, in a scene that asks for them."""
    return [
        f'{key}: not with coupling.units = "python": only native units have it; leave one of the '
        "two out"
        for key in keys
    ]


def with_quintics(without: Mapping[str, str]) -> list[str]:
    """What of a scene has no second derivatives, coupled by signals of order 5."""
    return [
        f"{key}: not with coupling.order = 5: {why}; leave this out, or take order = 3"
        for key, why in without.items()
    ]


def under_a_motor(motor: Motor | None, rotor: LinearRotor, scheme: str) -> list[str]:
    """What a motor of limited power cannot drive, and which scheme does not know it."""
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
    if scheme == "compensated":
        lines.append(
            'coupling.scheme = "compensated": does not know operation.motor: must be "auto", '
            '"iterated", "gauss-seidel" or "jacobi"'
        )
    return lines


def liquid_windows(
    checks: Sequence[AnyCheck],
    table: Rotor,
    rotor: LinearRotor,
    balancers: Sequence[AnyBalancer],
) -> list[str]:
    """Checks of a liquid balancer's window on scenes that have none in closed form."""
    one_liquid = [b.kind for b in balancers] == ["liquid"]
    if one_liquid and rotor.isotropic and table.kind == "planar":
        return []
    return [
        f'check[{i}].kind = "liquid_window": needs a planar rotor with equal stiffness '
        "and damping in x and y, and one balancer of kind liquid"
        for i, check in enumerate(checks, start=1)
        if check.kind == "liquid_window"
    ]
