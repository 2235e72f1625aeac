"""Rows of checks: what was expected, what was measured, and whether it holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from ..output.files import plain
from ..output.table import BAD, GOOD, Sheet
from .row import Row, Value

COLUMNS = ("check", "quantity", "expected", "measured", "error", "tolerance", "holds")


def text(value: Value | None, digits: int = 8) -> str:
    """A cell: numbers short, absent ones as a dash."""
    if value is None:
        return "-"
    return value if isinstance(value, str) else f"{value:.{digits}g}"


def as_json(rows: Sequence[Row]) -> dict[str, Any]:
    """`{"holds": bool, "rows": [...]}` with nothing that JSON cannot say."""
    holds = bool(rows) and all(row.holds for row in rows)
    return {"holds": holds, "rows": [plain(asdict(row)) for row in rows]}


def table(rows: Sequence[Row], title: str) -> Sheet:
    """The rows of one scene."""
    cells = [[*_cells(row), "yes" if row.holds else "NO"] for row in rows]
    return Sheet(COLUMNS, cells, "llrrrrl", title, {"holds": {"yes": GOOD, "NO": BAD}})


def _cells(row: Row) -> list[str]:
    """All but the last of `COLUMNS`."""
    numbers = (text(row.expected), text(row.measured), text(row.error, 2), text(row.tolerance, 2))
    return [row.check, row.quantity, *numbers]


def by_scene(rows: Sequence[Row]) -> dict[str, list[Row]]:
    """Rows grouped by scene, in order."""
    groups: dict[str, list[Row]] = {}
    for row in rows:
        groups.setdefault(row.scene, []).append(row)
    return groups


def verdict(rows: Sequence[Row]) -> str:
    """The last line: how many rows hold."""
    bad = [row for row in rows if not row.holds]
    if not rows:
        return "Nothing was checked."
    if not bad:
        return f"All {len(rows)} rows hold."
    return f"{len(bad)} of {len(rows)} rows do NOT hold."


def tables(rows: Sequence[Row]) -> list[Sheet]:
    """One for every scene."""
    return [
        table(members, f"{scene} ({sum(row.seconds for row in members):.1f} s)")
        for scene, members in by_scene(rows).items()
    ]


def sourced(rows: Sequence[Row]) -> Sheet:
    """The rows of one scene with time and source."""
    cells = [[*_cells(r), "yes" if r.holds else "NO", f"{r.seconds:.2f}", r.source] for r in rows]
    columns, colours = (*COLUMNS, "seconds", "source"), {"holds": {"yes": GOOD, "NO": BAD}}
    return Sheet(columns, cells, "llrrrrlrl", rows[0].scene, colours)
