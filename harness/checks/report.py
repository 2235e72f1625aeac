"""Rows of checks: what was expected, what was co-simulated, and whether it holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from ..output.files import plain
from ..output.table import BAD, GOOD, Sheet
from .row import Row, Value

COLUMNS = ("check", "quantity", "expected", "co-simulated", "error", "tolerance", "holds")


def text(value: Value | None, digits: int = 8) -> str:
    """A cell: numbers short, absent ones as a dash."""
    if value is None:
        return "-"
    return value if isinstance(value, str) else f"{value:.{digits}g}"


def as_json(rows: Sequence[Row]) -> dict[str, Any]:
    """`{"holds": bool, "rows": [...]}` with nothing that JSON cannot say."""
    holds = bool(rows) and all(row.holds for row in rows)
    return {"holds": holds, "rows": [plain(asdict(row)) for row in rows]}


def table(rows: Sequence[Row], title: str, *, sourced: bool = False) -> Sheet:
    """The rows of one scene; with time and source of each where `sourced`."""
    cells = []
    for row in rows:
        numbers = text(row.expected), text(row.measured), text(row.error, 2), text(row.tolerance, 2)
        cells.append([row.check, row.quantity, *numbers, "yes" if row.holds else "NO"])
        cells[-1] += [f"{row.seconds:.2f}", row.source] * sourced
    columns = (*COLUMNS, *("seconds", "source") * sourced)
    colours = {"holds": {"yes": GOOD, "NO": BAD}}
    return Sheet(columns, cells, "llrrrrl" + "rl" * sourced, title, colours)


def verdict(rows: Sequence[Row]) -> str:
    """The last line: how many rows hold."""
    bad = [row for row in rows if not row.holds]
    if not rows:
        return "Nothing was checked."
    if not bad:
        return f"All {len(rows)} rows hold."
    return f"{len(bad)} of {len(rows)} rows do NOT hold."
