"""What a design is for, as a user writes it: unbalance, space, material and reserve."""

from __future__ import annotations

import math
from typing import Any

from ..errors import UserError
from ..units import si_number

MATERIALS = {
    "steel": 7800.0, "brass": 8500.0, "tungsten carbide": 14900.0, "ceramic": 3200.0,
    "glass": 2500.0, "aluminium": 2700.0,
}  # kg/m^3  # fmt: skip


def read_space(
    unbalance: float | str | None,
    race: float | str | None,
    width: float | str | None,
    material: float | str,
    reserve: float,
) -> dict[str, Any]:
    """Arguments of `choices.design`; None is the scene's.

    Raises:
        UserError: a value is wrong.
    """
    found: dict[str, Any] = {"density": _density(material), "reserve": reserve}
    for name, given, symbol in (
        ("unbalance", unbalance, "kg m"), ("race", race, "m"), ("width", width, "m"),
    ):  # fmt: skip
        value = None if given is None else si_number(given, symbol, f"--{name}")
        if value is not None and not 0.0 <= value < math.inf:
            raise UserError(f"--{name} {value:g}: must be 0 or more")
        if value == 0.0 and symbol == "m":
            raise UserError(f"--{name} 0: must be above 0")
        found[name] = value
    if not 1.0 <= reserve < math.inf:
        raise UserError(f"--reserve {reserve:g}: must be 1 or more, such as 1.3")
    return found


def _density(material: float | str) -> float:
    """Of a material by its name, or as it is given [kg/m^3]."""
    if material in MATERIALS:
        return MATERIALS[str(material)]
    try:
        density = si_number(material, "kg/m^3", "--material")
    except UserError as error:
        from ..scene.messages import did_you_mean

        known = did_you_mean(material, list(MATERIALS))
        raise UserError(f"{error}, or one of {', '.join(MATERIALS)}{known}") from None
    if not 0.0 < density < math.inf:
        raise UserError(f"--material {material}: must be above 0")
    return density
