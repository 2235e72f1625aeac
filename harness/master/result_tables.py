"""A result in numbers: tables of its signals and errors, and what `--json` writes."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from ..output.table import Sheet
from ..units import shown_in

if TYPE_CHECKING:
    from .result import Result


def summary(result: Result) -> Sheet:
    """Smallest, largest and last value of every signal, and its error where that was measured."""
    rows, verification = [], result.verification
    for name, values in {"time": result.time, **result.signals}.items():
        unit = "s" if name == "time" else result.signal_units.get(name, "")
        unit, factor = shown_in(unit, name)
        numbers = (factor * values.min(), factor * values.max(), factor * values[-1])
        errors = ["-", "-"]
        if verification is not None and name in verification.error:
            error = factor * verification.error[name]
            errors = [f"{error:.2g}", f"{verification.relative[name]:.2g}"]
        rows.append([name, unit, *(f"{n:.6g}" for n in numbers), *(errors if verification else [])])
    columns = ["signal", "unit", "smallest", "largest", "at the end"]
    columns += ["error", "of range"] if verification else []
    align = "ll" + "r" * (len(columns) - 2)
    return Sheet(columns, rows, align, result.scene_title or "run")


def _summary(result: Result) -> dict[str, Any] | None:
    if result.scene is None:
        return None
    found = result.summary()
    return {**asdict(found), "balanced": found.balanced, "text": str(found)}


def as_json(result: Result) -> dict[str, Any]:
    """The facts of a run and every signal's values and errors, for `--json`."""
    signals: dict[str, Any] = {}
    verification = result.verification
    for name, values in result.signals.items():
        signals[name] = {
            "unit": result.signal_units.get(name, ""),
            "smallest": values.min(),
            "largest": values.max(),
            "last": values[-1],
        }
        if verification is not None:
            signals[name]["error"] = verification.error[name]
            signals[name]["relative_error"] = verification.relative[name]
    document = {
        "title": result.scene_title,
        "time": result.time[-1],
        "steps": result.steps,
        "passes": result.passes,
        "seconds": result.seconds,
        "units": result.units,
        "left_out": result.left_out,
        "events": result.events,
        "summary": _summary(result),
        "signals": signals,
    }
    if verification is not None:
        parting = asdict(verification.parting) if verification.parting else None
        document["verification"] = {"finer": verification.finer, "parting": parting}
    return document
