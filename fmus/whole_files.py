"""Files that appear complete or not at all: written beside their place, then moved there."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

drafts: set[Path] = set()  # that exist now; who ends the process removes them


@contextmanager
def draft_of(target: Path) -> Iterator[Path]:
    """Name of a file beside `target`, gone when the block ends."""
    draft = target.with_name(f".{target.name}-{os.urandom(4).hex()}{target.suffix}")
    drafts.add(draft)
    try:
        yield draft
    finally:
        draft.unlink(missing_ok=True)
        drafts.discard(draft)


@contextmanager
def whole_file(target: Path, mode: str = "wb", **options: Any) -> Iterator[IO[Any]]:
    """A file to write that takes its place, and the permissions there, when the block ends.

    Raises:
        OSError: it cannot be written.
    """
    with draft_of(target) as draft:
        with open(draft, mode.replace("w", "x"), **options) as stream:
            yield stream
            stream.flush()
            os.fsync(stream.fileno())
        if target.exists():
            os.chmod(draft, target.stat().st_mode & 0o7777)
        os.replace(draft, target)
