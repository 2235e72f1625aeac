"""Parts of a page that are neither a line of text nor a table: headings, verdicts, pictures."""

from __future__ import annotations

from base64 import b64encode
from dataclasses import dataclass
from html import escape
from typing import Literal

from ..output.words import in_html, printable


@dataclass(frozen=True)
class Heading:
    """The question that a section answers."""

    text: str

    def html(self) -> str:
        """As HTML."""
        return f"<h2>{in_html(self.text)}</h2>"


@dataclass(frozen=True)
class Lead:
    """What stands first: the answer in a sentence, and whether it is good."""

    text: str
    look: Literal["good", "bad", ""] = ""

    def html(self) -> str:
        """As HTML."""
        return f'<p class="lead {self.look}">{in_html(self.text)}</p>'


@dataclass(frozen=True)
class Note:
    """What limits the answer above it."""

    text: str

    def html(self) -> str:
        """As HTML."""
        return f'<p class="note">{in_html(self.text)}</p>'


@dataclass(frozen=True)
class Image:
    """A picture as PNG bytes, with what it shows."""

    png: bytes
    shows: str

    def html(self) -> str:
        """As HTML."""
        shows, said = escape(printable(self.shows)), in_html(self.shows)
        data = b64encode(self.png).decode("ascii")
        return (
            f'<figure><img src="data:image/png;base64,{data}" alt="{shows}">'
            f"<figcaption>{said}</figcaption></figure>"
        )


@dataclass(frozen=True)
class Drawing:
    """A drawing as SVG text, with what it shows."""

    svg: str
    shows: str

    def html(self) -> str:
        """As HTML."""
        caption = f"<figcaption>{in_html(self.shows)}</figcaption>"
        return f"<figure>{self.svg}{caption}</figure>"
