"""The units that there are, by name.  What is built, described and documented follows from here."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path
from typing import Any

from .liquid.variables import LIQUID
from .motor.variables import MOTOR
from .ring.variables import RING
from .rotor.variables import ROTOR
from .unit import SizedUnit, Unit, alternatives
from .weights.variables import BALLS

CATALOGUE: dict[str, Unit] = {unit.name: unit for unit in (ROTOR, LIQUID, BALLS, RING, MOTOR)}


def sized_unit(name: str, **options: Any) -> SizedUnit:
    """A unit of the catalogue with build options; those that concern other units are left aside.

    Raises:
        ValueError: there is no such unit, or an option is not one of those allowed; the text says
            what is.
        TypeError: no unit has such an option.
    """
    if name not in CATALOGUE:
        raise ValueError(f"unit = {name!r}: must be one of {alternatives(CATALOGUE)}")
    known = {f.name: None for unit in CATALOGUE.values() for f in fields(unit.sizes)}
    for option in options:
        if option not in known:
            from difflib import get_close_matches  # slow to load

            near = get_close_matches(option, known, 1)
            hint = f"did you mean {near[0]!r}?" if near else f"options are {alternatives(known)}"
            raise TypeError(f"{option}: no unit has this option; {hint}")
    own = {f.name for f in fields(CATALOGUE[name].sizes)}
    return CATALOGUE[name].sized({k: v for k, v in options.items() if k in own})


def equations(unit: Unit) -> str:
    """README.md of the unit: what it computes and where that is valid."""
    path = Path(__file__).parent / unit.folder / "README.md"
    return path.read_text(encoding="utf-8")
