"""Units of recorded signals, known by the last part of their names."""

from __future__ import annotations

import re

_UNITS = {
    "m": "x y bending clearance",
    "m/s": "vx vy",
    "rad": "angle",
    "rad/s": "speed",
    "rad/s^2": "acceleration",
    "N": "F_xi F_eta F_x F_y",
    "m/s^2": "a_xi a_eta a_x a_y",
    "kg": "added_mass liquid_mass",
    "kg m": "moment_xi moment_eta",
    "1": "spread",
}
_UNIT_OF = {name: unit for unit, names in _UNITS.items() for name in names.split()}
_DERIVATIVE = re.compile(r"^der\((?P<name>[^,)]*)(?:,(?P<order>\d+))?\)$")


def unit_of_signal(name: str) -> str:
    """SI unit of a recorded signal such as `rotor.x`; empty when it is not known."""
    last = name.rpartition(".")[2] if not name.endswith(")") else name.rpartition(".der(")[1:]
    if isinstance(last, str):
        return _UNIT_OF.get(last, "")
    derivative = _DERIVATIVE.match(name[name.index("der(") :])
    if derivative is None:
        return ""
    base = _UNIT_OF.get(derivative["name"].rpartition(".")[2], "")
    order = int(derivative["order"] or 1)
    return f"{base} s^-{order}" if base else ""
