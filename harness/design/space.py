"""What a design is for, as a user writes it: unbalance, space, material and reserve."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from ..errors import UserError
from ..units import si_number

MATERIALS = {
    "steel": 7800.0, "brass": 8500.0, "tungsten carbide": 14900.0, "ceramic": 3200.0,
    "glass": 2500.0, "aluminium": 2700.0,
}  # kg/m^3  # fmt: skip
LARGEST = 10.0  # m: of a race, and of the space along the axis
DENSEST = 1e5  # kg/m^3: above every solid


@dataclass(frozen=True)
class Space:
    """What weights must fit into, and what they must hold.

    Attributes:
        race: radius on which they roll [m].
        width: room along the axis, the height of rollers included [m].
        clearance: of it that stays free [m].
        density: of the weights [kg/m^3].
        least, unbalance: the smallest and the largest unbalance [kg m].
        reserve: capacity over the largest unbalance.
    """

    race: float
    width: float
    clearance: float
    density: float
    least: float
    unbalance: float
    reserve: float

    @property
    def required(self) -> float:
        """Capacity that a candidate must have [kg m]."""
        return self.reserve * self.unbalance


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
    least, largest = _unbalances(unbalance)
    lengths = {}
    for name, given in (("race", race), ("width", width)):
        value = None if given is None else si_number(given, "m", f"--{name}")
        if value is not None and not 0.0 < value < math.inf:
            raise UserError(f"--{name} {value:g}: must be above 0")
        if value is not None and not value < LARGEST:
            raise UserError(
                f"--{name} {value:g} m: must be below {LARGEST:g} m; a number alone is in m: write "
                f'"{value:g} mm" if it is in mm'
            )
        lengths[name] = value
    reserve = si_number(reserve, "", "--reserve")
    if not 1.0 <= reserve < math.inf:
        raise UserError(f"--reserve {reserve:g}: must be 1 or more, such as 1.3")
    density = _density(material)
    return {"unbalance": largest, "least": least, **lengths, "density": density, "reserve": reserve}


def _unbalances(given: float | str | None) -> tuple[float, float | None]:
    """Smallest and largest unbalance [kg m] of "0..300 g mm"; None: the scene's."""
    if given is None:
        return 0.0, None
    low, _, high = str(given).rpartition("..")
    largest = si_number(high, "kg m", "--unbalance")
    unit = high.strip().lstrip("+-.0123456789eE")
    bare = low.strip() and not low.strip()[-1].isalpha()  # its unit is the other's
    least = si_number(low + unit if bare else low, "kg m", "--unbalance") if low else 0.0
    if not 0.0 <= least <= largest < math.inf:
        raise UserError(f'--unbalance {given}: must rise from 0 or more, such as "0..300 g mm"')
    return least, largest


def _density(material: float | str) -> float:
    """Of a material by its name, or as it is given [kg/m^3]."""
    if isinstance(material, str) and material in MATERIALS:
        return MATERIALS[str(material)]
    try:
        density = si_number(material, "kg/m^3", "--material")
    except UserError as error:
        from ..scene.messages import did_you_mean

        known = did_you_mean(material, list(MATERIALS))
        raise UserError(f"{error}, or one of {', '.join(MATERIALS)}{known}") from None
    if not 0.0 < density < DENSEST:
        raise UserError(
            f"--material {material}: must be above 0 and below {DENSEST:g} kg/m^3; such as 7800"
        )
    return density
