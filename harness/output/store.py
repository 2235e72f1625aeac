"""Outcomes that last: one file to which they are written as they come, and work continues from it.

An SQLite database, in which an outcome stands whole or not at all, whatever ends the process.
Nothing depends on when or where an item was worked on, so that continued work gives the same
outcomes as undisturbed work.
"""

from __future__ import annotations

import hashlib
import io
import json
import sqlite3
from collections.abc import Mapping
from contextlib import closing
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import UserError
from .terminal import stores

_MADE = "fmus/native/bin/"  # by a compiler, from the other sources
_SHOWN = 60  # characters of what a store was made for
_BEGIN = (
    "CREATE TABLE IF NOT EXISTS outcome (item PRIMARY KEY, value)",
    "CREATE TABLE IF NOT EXISTS made_for (words)",
)


class StoredItems:
    """Outcomes of numbered items, each a tuple of arrays, numbers and texts."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._finished = {item for (item,) in _run(path, "SELECT item FROM outcome")}

    def __len__(self) -> int:
        return len(self._finished)

    def __contains__(self, item: object) -> bool:
        return item in self._finished

    def __getitem__(self, item: int) -> tuple[Any, ...]:
        ((value,),) = _run(self._path, "SELECT value FROM outcome WHERE item = ?", item)
        with np.load(io.BytesIO(value)) as arrays:
            return tuple(each if each.ndim else each.item() for each in arrays.values())

    def __setitem__(self, item: int, outcome: tuple[Any, ...]) -> None:
        arrays = map(np.asarray, outcome)
        value = io.BytesIO()
        np.savez(value, *(a.astype(str) if a.dtype == object else a for a in arrays))
        inserted = "INSERT OR REPLACE INTO outcome VALUES (?, ?)"
        _run(self._path, inserted, item, value.getvalue())
        self._finished.add(item)


def open_store(path: Path, made_for: Mapping[str, str]) -> StoredItems:
    """The store at a place, begun if there is none.

    Args:
        made_for: in words whatever the outcomes depend on, but for the program, which is added.

    Raises:
        UserError: what is there is no store, or was made for something else.
    """
    ours = {**made_for, "program": _program()}
    for statement in _BEGIN:
        _run(path, statement)
    if found := _run(path, "SELECT words FROM made_for"):
        _refuse_foreign(path, json.loads(found[0][0]), ours)
    else:
        _run(path, "INSERT INTO made_for VALUES (?)", json.dumps(ours))
    stores.append(path)
    return StoredItems(path)


def _run(path: Path, statement: str, *values: Any) -> list[tuple[Any, ...]]:
    """Rows of one statement, which takes effect whole or not at all."""
    try:
        with closing(sqlite3.connect(path)) as file, file:
            return file.execute(statement, values).fetchall()
    except sqlite3.Error as error:
        raise UserError(
            f"{path}: is no store that can be continued: {error}; name another file, or remove it"
        ) from error


def _program() -> str:
    """The package's sources: different ones might compute something else."""
    root = Path(__file__).resolve().parents[2]
    content = hashlib.sha256()
    for name in ("models", "fmus", "harness"):
        for path in sorted((root / name).rglob("*.[pch]*")):
            place = path.relative_to(root).as_posix()
            if path.suffix in (".py", ".c", ".h") and not place.startswith(_MADE):
                content.update(place.encode() + path.read_bytes())
    return f"autobalancer {content.hexdigest()[:16]}"


def _refuse_foreign(path: Path, theirs: Mapping[str, Any], ours: Mapping[str, str]) -> None:
    for key, own in ours.items():
        other = theirs.get(key)
        if other == own:
            continue
        lines = zip_longest(str(other).splitlines(), own.splitlines(), fillvalue="")
        there, here = next((a, b) for a, b in lines if a != b)
        raise UserError(
            f"{path}: was made for another {key}: {there[:_SHOWN]!r} there, {here[:_SHOWN]!r} now; "
            "name another place, or remove it"
        )
