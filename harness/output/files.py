"""Files that appear complete or not at all, formats of pictures, and JSON."""

from __future__ import annotations

import contextlib
import json
import math
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

from ..errors import UserError

PICTURES = ("png", "svg", "pdf")


def picture_format(path: Path) -> str:
    """Format of a picture by the end of its name.

    Raises:
        UserError: it is none of those known.
    """
    kind = path.suffix.removeprefix(".").lower()
    if kind not in PICTURES:
        raise UserError(f"{path}: pictures end in {', '.join('.' + name for name in PICTURES)}")
    return kind


@contextlib.contextmanager
def write_whole(path: str | Path, mode: str = "w") -> Iterator[IO[Any]]:
    """A file that appears complete or not at all: written beside its place, then moved there.

    A device or pipe is written to as it is: moving a file there would replace it.

    Raises:
        UserError: the directory is missing, not writable, or the disk is full; nothing is left.
    """
    target = Path(os.path.realpath(path))  # a link stays a link
    text: dict[str, Any] = {} if "b" in mode else {"encoding": "utf-8", "newline": ""}
    try:
        if target.exists() and not target.is_file():
            with open(target, mode, **text) as stream:
                yield stream
            return
        handle, temporary = tempfile.mkstemp(
            dir=target.parent, prefix=f".{target.name}-", suffix=target.suffix
        )
        try:
            with open(handle, mode, **text) as stream:
                yield stream
                stream.flush()
                os.fsync(stream.fileno())
            os.chmod(temporary, _permissions(target))
            os.replace(temporary, target)
        except BaseException:
            with contextlib.suppress(OSError):
                os.unlink(temporary)
            raise
    except OSError as error:
        raise UserError(f"{path}: cannot be written: {error.strerror or error}") from error


def _permissions(target: Path) -> int:
    """Those of the file to be replaced, or of a new one (mkstemp makes its own private)."""
    if target.exists():
        return target.stat().st_mode & 0o7777
    umask = os.umask(0)
    os.umask(umask)
    return 0o666 & ~umask


def plain(value: Any) -> Any:
    """Numbers that JSON has no word for as text; NumPy scalars as Python's."""
    if hasattr(value, "item"):
        value = value.item()
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
    with write_whole(path) as stream:
        json.dump(plain(document), stream, indent=2, ensure_ascii=False, allow_nan=False)
        stream.write("\n")
