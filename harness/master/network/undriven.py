"""Refuse a rotor whose speed is to change, and that nothing drives.

The inputs `speed` and `acceleration` of a unit say where its rotor is at the start of a step, and
what the step adds.  Held at their start values they contradict each other unless the acceleration
is 0: every step would begin at the first speed again.  A scene in one file drives itself.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ...errors import UnitError
from .wiring import Wiring

DRIVE = ("speed", "acceleration")
OWN_DRIVE = "rise_time"  # of a unit that changes the speed by itself


def refuse_undriven(
    label: str,
    units: Mapping[str, Any],
    wiring: Wiring,
    starts: Mapping[str, Mapping[str, Any]],
) -> None:
    """Raise UnitError for units with an acceleration that no one integrates.

    Args:
        units: by name.
        starts: start values that replace those of a unit's description, by unit and variable.
    """
    undriven, given = [], (0.0, 0.0)
    for name, unit in units.items():
        fed = {inlet.variable for inlet in wiring.inlets.get(name, ())}
        inputs = {v.name: v for v in unit.description.modelVariables if v.causality == "input"}
        named = {v.name for v in unit.description.modelVariables}
        if OWN_DRIVE in named or fed & {*DRIVE} or not {*DRIVE} <= inputs.keys():
            continue
        own = starts.get(name, {})
        speed, acceleration = (float(own.get(key, inputs[key].start or 0.0)) for key in DRIVE)
        if acceleration:
            undriven.append(name)
            given = speed, acceleration
    if undriven:
        first = undriven[0]
        raise UnitError(
            f"{label}: {', '.join(undriven)}: nothing feeds speed and acceleration, which stay "
            f"{given[0]:.6g} rad/s and {given[1]:.6g} rad/s^2: a rotor that speeds up does not "
            "keep its speed. Run the scene, or its package in one file (autobalancer build "
            "--one-file --ssp), which changes the speed by itself; or hold the speed of each: "
            f"--set {first}.acceleration=0 --set {first}.speed=100"
        )
