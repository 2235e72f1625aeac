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
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from functools import partial
from itertools import zip_longest
from os import PathLike
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from ..errors import UserError
from .terminal import stores

_MADE = "fmus/native/bin/"  # by a compiler, from the other sources
_SHOWN = 60  # characters of what a store was made for
_MAGIC, _IDENTITY_AT = (
    b"SQLite format 3\0",
    68,
)  # of a database file, and of its application's number
_IDENTITY = 0x41426C73  # "ABls": SQLite's `application_id` of a store
_BEGIN = (
    f"PRAGMA application_id = {_IDENTITY}",
    "CREATE TABLE outcome (item INT PRIMARY KEY, value BLOB, checksum TEXT)",
    "CREATE TABLE made_for (words TEXT, checksum TEXT)",
)

Content = TypeVar("Content", str, bytes)


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
        """The outcome of an item; raises UserError where the file is damaged."""
        wanted = "SELECT value, checksum FROM outcome WHERE item = ?"
        row = _run(self._path, wanted, item)
        value = _whole(self._path, f"outcome {item}", item, row, bytes)
        with np.load(io.BytesIO(value)) as arrays:
            return tuple(each if each.ndim else each.item() for each in arrays.values())

    def __setitem__(self, item: int, outcome: tuple[Any, ...]) -> None:
        arrays = map(np.asarray, outcome)
        value = io.BytesIO()
        np.savez(value, *(a.astype(str) if a.dtype == object else a for a in arrays))
        row = (item, value.getvalue(), _checksum(item, value.getvalue()))
        _run(self._path, "INSERT OR REPLACE INTO outcome VALUES (?, ?, ?)", *row)
        self._finished.add(item)


def open_store(place: str | Path, made_for: Mapping[str, str]) -> StoredItems:
    """The store at a place, begun if there is none.

    Args:
        made_for: in words whatever the outcomes depend on, but for the program, which is added.

    Raises:
        UserError: what is there is no store (it is left as it is then), is damaged or in use, or
            was made for something else.
    """
    if not isinstance(place, (str, PathLike)):
        raise UserError(f"store = {place!r}: must be the path of a file")
    path, ours = Path(place), {**made_for, "program": _program()}
    if _is_new(path):
        words = json.dumps(ours)
        _begin(path, words)
    else:
        row = _run(path, "SELECT words, checksum FROM made_for")
        words = _whole(path, "what it was made for", 0, row, str)
        _refuse_foreign(path, json.loads(words), ours)
    stores.append(path)
    return StoredItems(path)


def _is_new(path: Path) -> bool:
    """Whether nothing is there yet; raises UserError for what is no store of ours.

    Looks at the first bytes alone: to open another program's database can change it.
    """
    try:
        with path.open("rb") as file:
            head = file.read(_IDENTITY_AT + 4)
    except FileNotFoundError:
        return True
    except OSError as error:
        raise _no_store(path, str(error.strerror)) from error
    if head and not head.startswith(_MAGIC):
        raise _no_store(path, "file is not a database")
    if head and int.from_bytes(head[_IDENTITY_AT:], "big") != _IDENTITY:
        raise _no_store(path, "it is a database of another program, or of an older version")
    return not head


def _no_store(path: Path, why: str) -> UserError:
    return UserError(
        f"{path}: is no store that can be continued: {why}; name another file, or remove it"
    )


def _begin(path: Path, words: str) -> None:
    """Make the tables, all of them or none."""
    with _opened(path) as file:
        file.execute("BEGIN")
        for statement in _BEGIN:
            file.execute(statement)
        file.execute("INSERT INTO made_for VALUES (?, ?)", (words, _checksum(0, words)))


def _run(path: Path, statement: str, *values: Any) -> list[tuple[Any, ...]]:
    """Rows of one statement, which takes effect whole or not at all."""
    with _opened(path) as file:
        return file.execute(statement, values).fetchall()


@contextmanager
def _opened(path: Path) -> Iterator[sqlite3.Connection]:
    """The database for one transaction; its errors in words."""
    try:
        with closing(sqlite3.connect(path)) as file, file:
            file.text_factory = partial(str, encoding="utf-8", errors="replace")
            yield file
    except sqlite3.OperationalError as error:
        if "locked" not in str(error):
            raise _no_store(path, str(error)) from error
        raise UserError(
            f"{path}: another program is writing to this store; wait until it has finished, or "
            "name another file"
        ) from error
    except sqlite3.Error as error:
        raise _no_store(path, str(error)) from error


def _checksum(item: int, value: str | bytes) -> str:
    content = value.encode() if isinstance(value, str) else value
    return hashlib.sha256(b"%d:" % item + content).hexdigest()


def _whole(
    path: Path, what: str, item: int, row: Sequence[tuple[Any, ...]], kind: type[Content]
) -> Content:
    """The content of a row (content, checksum); raises UserError unless it is as it was written."""
    content, checksum = row[0] if row else (None, None)
    if not isinstance(content, kind) or _checksum(item, content) != checksum:
        raise UserError(
            f"{path}: is damaged: {what} is not as it was written; name another file, or remove it"
        )
    return content


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
