"""Rows of checks: what was expected, what was measured, and whether it holds."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..output.files import write_whole
from .row import Row, Value

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

COLUMNS = ("check", "quantity", "expected", "measured", "error", "tolerance", "holds")


def text(value: Value | None, digits: int = 8) -> str:
    """A cell: numbers short, absent ones as a dash."""
    if value is None:
        return "-"
    return value if isinstance(value, str) else f"{value:.{digits}g}"


def _plain(value: Any) -> Any:
    """Numbers that JSON has no word for as text; NumPy scalars as Python's."""
    if hasattr(value, "item"):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    return value


def as_json(rows: Sequence[Row]) -> dict[str, Any]:
    """`{"holds": bool, "rows": [...]}` with nothing that JSON cannot say."""
    holds = bool(rows) and all(row.holds for row in rows)
    return {"holds": holds, "rows": [_plain(asdict(row)) for row in rows]}


def write_json(document: Any, path: Path) -> None:
    """Write a document as JSON, completely or not at all.

    Raises:
        UserError: the file cannot be written.
    """
    with write_whole(path) as stream:
        json.dump(_plain(document), stream, indent=2, ensure_ascii=False, allow_nan=False)
        stream.write("\n")


def table(rows: Sequence[Row], title: str) -> Table:
    """The rows of one scene as a table for the terminal."""
    from rich.markup import escape
    from rich.table import Table

    grid = Table(title=escape(title), title_justify="left")
    for column in COLUMNS:
        right = column in {"expected", "measured", "error", "tolerance"}
        grid.add_column(column, justify="right" if right else "left", overflow="fold")
    for row in rows:
        verdict = "[green]yes[/green]" if row.holds else "[bold red]NO[/bold red]"
        cells = (
            row.check,
            row.quantity,
            text(row.expected),
            text(row.measured),
            text(row.error, 2),
            text(row.tolerance, 2),
        )
        grid.add_row(*map(escape, cells), verdict)
    return grid


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


def print_rows(rows: Sequence[Row], console: Console) -> None:
    """Tables by scene."""
    for scene, members in by_scene(rows).items():
        seconds = sum(row.seconds for row in members)
        console.print(table(members, f"{scene} ({seconds:.1f} s)"))


def markdown(rows: Sequence[Row]) -> str:
    """The rows as Markdown, with sources."""
    lines = ["# Checks", "", verdict(rows)]
    columns = (*COLUMNS, "seconds", "source")
    for scene, members in by_scene(rows).items():
        lines += ["", f"## {scene}", "", f"| {' | '.join(columns)} |", "|---" * len(columns) + "|"]
        for row in members:
            cells = [
                row.check,
                row.quantity,
                text(row.expected),
                text(row.measured),
                text(row.error, 2),
                text(row.tolerance, 2),
                "yes" if row.holds else "**NO**",
                f"{row.seconds:.2f}",
                row.source,
            ]
            lines.append(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |")
    return "\n".join(lines) + "\n"
