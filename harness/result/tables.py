"""A result in numbers: the table of its signals, and what `--json` writes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..output.table import Sheet
from ..units import shown_in
from .sag import from_sag

if TYPE_CHECKING:
    from .result import Result


def summary(result: Result) -> Sheet:
    """Smallest, largest and last value of every signal, displacements from the sag."""
    rows, sag = [], result.sag()
    for name, values in {"time": result.time, **from_sag(result.signals, sag)}.items():
        unit = "s" if name == "time" else result.signal_units.get(name, "")
        unit, factor = shown_in(unit, name)
        numbers = (factor * values.min(), factor * values.max(), factor * values[-1])
        rows.append(
            [f"{name}, from the sag" if name in sag else name, unit, *(f"{n:.6g}" for n in numbers)]
        )
    columns = ["signal", "unit", "smallest", "largest", "at the end"]
    return Sheet(columns, rows, "llrrr", result.scene_title or "run")


def _summary(result: Result) -> dict[str, Any] | None:
    if result.scene is None:
        return None
    return result.summary().as_json()


def as_json(result: Result) -> dict[str, Any]:
    """The facts of a run and every signal's values, for `--json`."""
    signals = {
        name: {
            "unit": result.signal_units.get(name, ""),
            "smallest": values.min(),
            "largest": values.max(),
            "last": values[-1],
        }
        for name, values in result.signals.items()
    }
    return {
        "title": result.scene_title,
        "time": result.time[-1],
        "steps": result.steps,
        "passes": result.passes,
        "seconds": result.seconds,
        "estimated_error": result.estimated_error,
        "error_known": result.error_known,
        "unknown_error": result.unknown_error,
        "units": result.units,
        "left_out": result.left_out,
        "events": result.events,
        "summary": _summary(result),
        "sag": {name: values[-1] for name, values in result.sag().items()},
        "signals": signals,
    }
