"""Files that appear complete or not at all, formats of pictures, and JSON."""

from __future__ import annotations

import contextlib
import errno
import math
import os
import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import IO, Any

from ...fmus.whole_files import draft_of, whole_file
from ..errors import UserError

_DESCRIPTOR = r"/dev/(?P<name>stdout|stderr)$|(?:/dev|/proc/self)/fd/(?P<number>\d+)$"
_STANDARD = {"stdout": 1, "stderr": 2}
PICTURES = ("png", "svg", "pdf")
MOVIES = ("gif", "webp", "mp4")


def picture_format(path: Path) -> str:
    """Format of a picture by the end of its name.

    Raises:
        UserError: it is none of those known.
    """
    return _format(path, "pictures", PICTURES)


def movie_format(path: Path) -> str:
    """Format of a movie by the end of its name.

    Raises:
        UserError: it is none of those known.
    """
    return _format(path, "movies", MOVIES)


def _format(path: Path, what: str, known: Sequence[str]) -> str:
    kind = path.suffix.removeprefix(".").lower()
    if kind not in known:
        raise UserError(f"{path}: {what} end in {', '.join('.' + name for name in known)}")
    return kind


@contextlib.contextmanager
def write_whole(path: str | Path, mode: str = "w") -> Iterator[IO[Any]]:
    """A file that appears complete or not at all: written beside its place, then moved there.

    A device or pipe is written to as it is: moving a file there would replace it.

    Raises:
        UserError: the directory is missing, not writable, or the disk is full, or the file that is
            there is write-protected; nothing is left.
    """
    text: dict[str, Any] = {} if "b" in mode else {"encoding": "utf-8", "newline": ""}
    try:
        straight = _straight(path)
        if straight is not None:
            with open(straight, mode, **text) as stream:
                yield stream
            return
        target = Path(os.path.realpath(path))  # a link stays a link
        _refuse_protected(target)
        with whole_file(target, mode, **text) as stream:
            yield stream
    except OSError as error:
        raise UserError(f"{path}: cannot be written: {error.strerror or error}") from error


def refuse_unwritable(path: Path) -> None:
    """Refuse now what `write_whole` would refuse in the end: a file is begun there, and dropped.

    Raises:
        UserError: as `write_whole`.
    """
    try:
        if path.is_dir():
            raise IsADirectoryError(errno.EISDIR, "it is a directory")
        if path.parent.is_file():
            raise NotADirectoryError(errno.ENOTDIR, f"{path.parent} is a file, not a directory")
        if not path.parent.is_dir():
            raise FileNotFoundError(errno.ENOENT, f"there is no directory {path.parent}")
        if is_stream(path):
            return  # to open a pipe would have its reader begin
        target = Path(os.path.realpath(path))
        _refuse_protected(target)
        with draft_of(target) as draft:
            draft.touch(exist_ok=False)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise UserError(f"{path}: cannot be written: {reason}") from error


def is_stream(path: Path) -> bool:
    """Whether a path is a device, a pipe or an open file, which have no ending."""
    return bool(re.match(_DESCRIPTOR, str(path))) or (path.exists() and not path.is_file())


def _refuse_protected(target: Path) -> None:
    """A file whose owner took the right to write it is not replaced, whoever runs the program."""
    if target.exists() and not (os.access(target, os.W_OK) and target.stat().st_mode & 0o222):
        raise PermissionError(errno.EACCES, "it is write-protected")


def _straight(path: str | Path) -> str | int | None:
    """What to open where nothing is to be replaced: a device, a pipe, an open file; None else.

    /dev/stdout may itself be a file: it is written on where it stands, not from its beginning.
    """
    open_file = re.match(_DESCRIPTOR, str(path))
    if open_file:
        number = _STANDARD.get(open_file["name"]) or int(open_file["number"])
        for stream in (sys.stdout, sys.stderr):
            if stream is not None:
                stream.flush()
        return os.dup(number)
    return str(path) if os.path.exists(path) and not os.path.isfile(path) else None


def plain(value: Any) -> Any:
    """Numbers that JSON has no word for as text, complex ones as [real, imaginary]; NumPy's as
    Python's."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, complex):
        value = [value.real, value.imag]
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    return value


def write_json(document: Any, path: Path) -> None:
    """Write a document as JSON, completely or not at all.

    Raises:
        UserError: the file cannot be written.
    """
    import json  # few programs write any

    with write_whole(path) as stream:
        json.dump(plain(document), stream, indent=2, ensure_ascii=False, allow_nan=False)
        stream.write("\n")
