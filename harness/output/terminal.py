"""The terminal: tables on standard output, progress and problems on standard error."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...fmus.whole_files import draft_of
from ..errors import UserError
from ..units import in_words
from .files import refuse_unwritable
from .words import printable

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress

    from .table import Sheet

_kept: ContextVar[list[Any] | None] = ContextVar("kept", default=None)
is_quiet: ContextVar[bool] = ContextVar("is_quiet", default=False)  # nothing on the scene itself
_bars: list[Progress] = []  # at present
stores: list[Path] = []  # that keep what is done
PIPED_WIDTH = 160  # columns of a table that no terminal limits


def console(error: bool = False) -> Console:
    """Standard output, or standard error."""
    from rich.console import Console

    stream = sys.stderr if error else sys.stdout
    limited = (stream is not None and stream.isatty()) or "COLUMNS" in os.environ
    width = None if limited else PIPED_WIDTH
    return Console(stderr=error, width=width, highlight=False, emoji=False)


@contextmanager
def progress_bars() -> Iterator[Progress]:
    """Bars on standard error that vanish when the work is done; nothing when it is a file."""
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn
    from rich.progress import TimeElapsedColumn as Elapsed
    from rich.progress import TimeRemainingColumn as Remaining

    screen = console(error=True)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        Elapsed(),
        Remaining(),
    )
    with Progress(
        *columns, console=screen, transient=True, disable=not screen.is_terminal
    ) as progress:
        _bars.append(progress)
        try:
            yield progress
        finally:
            _bars.remove(progress)


def how_far() -> str:
    """Work that is not finished with what is done of it, and the stores that keep it."""
    work = [task for bars in _bars for task in bars.tasks if not task.finished]
    done = [f"{each.percentage:.0f} % of " * bool(each.total) + each.description for each in work]
    kept = [f"{path} keeps what is done, the same command continues" for path in stores]
    return "".join(f"; {each}" for each in [", ".join(done), *kept] if each)


@contextmanager
def progress_bar(words: str) -> Iterator[Callable[..., None]]:
    """One bar, moved by a call with the finished fraction and, if they change, new words for it."""
    with progress_bars() as bars:
        task = bars.add_task(words, total=1.0)

        def move(fraction: float, words: str | None = None) -> None:
            bars.update(task, completed=fraction, description=words)

        yield move


@contextmanager
def keeping(parts: list[Any]) -> Iterator[None]:
    """What is said and shown within the block is appended to `parts` as well."""
    before = _kept.set(parts)
    try:
        yield
    finally:
        _kept.reset(before)


def show(sheet: Sheet) -> None:
    """A table on standard output."""
    sheet = sheet.in_units()
    _keep(sheet)
    console().print(sheet.rich())


def say(text: str, style: str = "", error: bool = False) -> None:
    """One line of plain text."""
    text = text if error else in_words(text)  # problems are told in the words of the scene
    _keep(text)
    console(error).print(printable(text), style=style or None, markup=False, soft_wrap=True)


def _keep(part: str | Sheet) -> None:
    parts = _kept.get()
    if parts is not None and part:
        parts.append(part)


def say_facts(units: Iterable[str], left_out: Iterable[str], ran_as: str = "FMUs loaded") -> None:
    """Which FMUs ran, by default loaded, and what was left out."""
    say(f"{ran_as}: {', '.join(units) or 'none'}")
    say(f"Left out: {'; '.join(left_out) or 'nothing'}")


def ready_to_write(path: Path | None) -> None:
    """Refuse a place that cannot be written to before long work begins.

    Raises:
        UserError: the directory does not exist or takes no files, a directory stands in the file's
            place, or the file there is write-protected.
    """
    if path is not None:
        refuse_unwritable(path)


def ready_to_fill(path: Path) -> None:
    """Refuse a directory that cannot be made before long work begins; none stays behind.

    Raises:
        UserError: it cannot be made, or takes no files.
    """
    missing: list[Path] = []
    try:
        missing += [each for each in (path, *path.parents) if not each.exists()]
        path.mkdir(parents=True, exist_ok=True)
        with draft_of(path / "anything") as draft:
            draft.touch(exist_ok=False)
    except (OSError, ValueError) as error:
        if path.is_dir() and path not in missing:
            raise UserError(
                f"{path}: takes no files: {getattr(error, 'strerror', error)}"
            ) from error
        reason = getattr(error, "strerror", None) or error
        raise UserError(f"{path}: cannot be made a directory: {reason}") from error
    finally:
        for each in missing:  # the innermost first
            with suppress(OSError):
                each.rmdir()
