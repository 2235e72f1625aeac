"""What a reader of a run of units of any origin must know about the units and their coupling."""

from __future__ import annotations

from typing import Any

from ..foreign.abilities import HELD

MOST_NAMED = 4  # signals or units in a sentence


def notes(run: Any) -> list[str]:
    """Of a run that has been started: loops, what units cannot do, and what they have logged."""
    found = [run.ended] if run.ended else []
    if run.system.stuck and run.system.coupled and run.scheme_name != "jacobi":
        unseen = ", and its gain is known only as far as the units show it before the first step"
        found.append(
            f"{_some(run.system.stuck)} cannot restore a state: the loop was not iterated "
            f"({run.scheme_name}){'' if run.system.is_free else unseen}"
        )
    for loop in run.wiring.loops():
        solved = "made consistent behind every step" if run.scheme.loop else "delayed"
        solved = "iterated" if run.scheme_name == "iterated" else solved
        found.append(f"algebraic loop: {_some(loop)} ({solved}; loop gain {run.gain:.3g})")
    direct = [
        f"{unit}.{inlet.variable}"
        for unit, inlets in run.wiring.inlets.items()
        for inlet in inlets
        if inlet.takes == HELD and not inlet.holds_mean and not inlet.is_tried
    ]
    if direct and run.coupled:
        found.append(
            f"{_some(direct)} cannot be given slopes and act on outputs directly: they hold the "
            "value at the end of each step; what a unit integrates of it errs by the step"
        )
    for name, unit in run.units.items():
        if getattr(unit, "is_python", True) is False and unit.abilities.needs_tool:
            found.append(f"{name}: {unit.path.name} calls a program that it needs on this machine")
        found += [f"{name}: {message}" for message in dict.fromkeys(unit.messages)]
    return found


def _some(names: list[str]) -> str:
    more = len(names) - MOST_NAMED
    return ", ".join(names[:MOST_NAMED]) + (f" and {more} more" if more > 0 else "")
