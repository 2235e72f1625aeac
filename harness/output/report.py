"""A report to pass on: one page with tables, pictures, scenes, how it was made, and its sources.

It needs nothing but itself, runs no script, and prints.
"""

from __future__ import annotations

import datetime
import shlex
from base64 import b64encode
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Protocol

from ...models.references import citations, references
from . import options
from .files import write_whole
from .machine import machine, program_version
from .table import Sheet
from .terminal import keeping, ready_to_fill, say
from .words import in_html, printable

NAME = "report.html"
_TEMPLATE = Path(__file__).with_name(NAME)


class Described(Protocol):
    """What a page shows in full: a scene."""

    @property
    def heading(self) -> str:
        """Its title."""

    @property
    def toml(self) -> str:
        """Its text."""


class Part(Protocol):
    """A part of a page that is no line of text, such as a `Sheet`."""

    def html(self) -> str:
        """As HTML, every text escaped."""


class Report:
    """What goes into the page, in order.

    Attributes:
        directory: where page and pictures are written, made for the first of them; None: nowhere.
        parts: lines of text, tables, and other parts that have HTML of their own.
        pictures: PNG files.
        cited: text that names sources beside the parts.
    """

    def __init__(self, directory: Path | None, title: str, scenes: Sequence[Described]) -> None:
        self.directory, self.title, self.scenes = directory, title, scenes
        self.parts: list[str | Part] = []
        self.pictures: list[Path] = []
        self.cited = ""
        if directory is not None:
            ready_to_fill(directory)

    @contextmanager
    def keeping(self) -> Iterator[None]:
        """What is said and shown within the block goes into the page, too."""
        with keeping(self.parts):
            yield

    def folder(self) -> Path | None:
        """The directory, made now: a command that fails before leaves none; None: no page."""
        if self.directory is not None:
            self.directory.mkdir(parents=True, exist_ok=True)
        return self.directory

    def picture(self, name: str) -> Path | None:
        """Where to draw a picture of the page; None where there is no page."""
        folder = self.folder()
        if folder is None:
            return None
        self.pictures.append(folder / f"{name}.png")
        return self.pictures[-1]

    def write(self) -> None:
        """Write the page, completely or not at all; nothing where no directory was given.

        Raises:
            UserError: it cannot be written.
        """
        folder = self.folder()
        if folder is None:
            return
        page = self.page()
        with write_whole(folder / NAME) as stream:
            stream.write(page)
        say(f"Report: {folder / NAME}")

    def page(self) -> str:
        """As HTML."""
        from jinja2 import Environment
        from markupsafe import Markup

        environment = Environment(autoescape=True, trim_blocks=True, finalize=_harmless)
        environment.filters["coded"] = lambda text: Markup(in_html(text))  # it escapes
        scenes = [(scene.heading, scene.toml) for scene in self.scenes]
        pictures = [(path.stem, b64encode(path.read_bytes()).decode()) for path in self.pictures]
        return environment.from_string(_TEMPLATE.read_text(encoding="utf-8")).render(
            title=self.title,
            parts=self.parts,
            pictures=pictures,
            scenes=scenes,
            sources=self._sources([text for _, text in scenes]),
            program=program_version(),
            machine=machine(),
            command=shlex.join(["autobalancer", *options.typed.get()]),
            date=datetime.datetime.now().astimezone().strftime("%Y-%m-%d %H:%M %Z"),
        )

    def _sources(self, scenes: Sequence[str]) -> list[str]:
        """What tables, lines and scenes cite, as in the bibliography."""
        parts = [
            f"{p.title} {p.rows}" if isinstance(p, Sheet) else p if isinstance(p, str) else ""
            for p in self.parts
        ]
        named = citations("\n".join([*parts, *scenes, self.cited]))
        return [str(entry) for key, entry in references().items() if key in named]


def _harmless(value: object) -> object:
    # bytes of pictures are long, and text as it is
    return printable(value) if type(value) is str else value
