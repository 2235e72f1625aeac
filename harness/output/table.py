"""A table, and the three ways to show it: on a terminal, as Markdown, as CSV."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..units import in_words, scaled, shown_in
from .files import write_whole
from .words import in_html, in_markdown, printable

if TYPE_CHECKING:
    from rich.table import Table

_JUSTIFY = {"l": "left", "r": "right"}
_RULES = {"l": "---", "r": "---:"}
_UNIT = r"\[([^\[\]]+)\]$"  # at the end of a head
GOOD, BAD = "green", "bold red"
_SHORT = 14  # characters that stay on one line
_CLASSES = {GOOD: "good", BAD: "bad"}


@dataclass(frozen=True)
class Sheet:
    """Rows under named columns.

    Attributes:
        columns: heads.
        rows: cells of every row, of the columns' number; text but for CSV, which takes numbers.
        align: a letter a column, `l` or `r`; by default all left.
        title: above it, on a terminal.
        colours: by column, the style of a cell by its text, on a terminal.
        grouped: a line is drawn above every row whose first cell says something, on a terminal.
    """

    columns: Sequence[str]
    rows: Sequence[Sequence[Any]]
    align: str = ""
    title: str = ""
    colours: Mapping[str, Mapping[str, str]] = field(default_factory=dict)
    grouped: bool = False

    def __post_init__(self) -> None:
        if any(len(row) != len(self.columns) for row in self.rows):
            raise ValueError(f"every row needs {len(self.columns)} cells: {self.columns}")
        if self.align and (len(self.align) != len(self.columns) or set(self.align) - {*"lr"}):
            raise ValueError(f"align {self.align!r} needs a letter l or r for each column")

    def in_units(self) -> Sheet:
        """With columns that name an SI unit, such as `speed [rad/s]`, in the unit that is shown."""
        heads, factors = [], []
        for head in self.columns:
            match = re.search(_UNIT, head)
            unit, factor = shown_in(match[1], head) if match else ("", 1.0)
            heads.append(f"{head[: match.start()]}[{unit}]" if match else head)
            factors.append(factor)
        rows = [[scaled(c, f) for c, f in zip(row, factors, strict=True)] for row in self.rows]
        return replace(self, columns=heads, rows=rows, title=in_words(self.title))

    @property
    def _align(self) -> str:
        return self.align or "l" * len(self.columns)

    def rich(self) -> Table:
        """For a terminal; what is too wide goes on below."""
        from rich.markup import escape
        from rich.table import Table
        from rich.text import Text

        table = Table(title=escape(printable(self.title)) or None, title_justify="left")
        for name, letter in zip(self.columns, self._align, strict=True):
            table.add_column(Text(name), justify=_JUSTIFY[letter], overflow="fold")  # type: ignore[arg-type]
        styles = [self.colours.get(name, {}) for name in self.columns]
        for number, row in enumerate(self.rows):
            if self.grouped and number and row[0]:
                table.add_section()
            cells = zip(row, styles, strict=True)
            table.add_row(
                *(Text(printable(cell), style=style.get(cell, "")) for cell, style in cells)
            )
        return table

    def markdown(self) -> str:
        """As lines of Markdown."""
        rule = "|".join(_RULES[letter] for letter in self._align)
        lines = [f"| {' | '.join(self.columns)} |", f"|{rule}|"]
        for row in self.rows:
            cells = (in_markdown(str(cell)).replace("|", "\\|") for cell in row)
            lines.append(f"| {' | '.join(cells)} |")
        return "\n".join(lines)

    def html(self) -> str:
        """As a table of HTML, every text escaped; cells are of class good, bad, short."""

        def cells(kind: str, texts: Sequence[Any]) -> str:
            made = []
            for name, letter, text in zip(self.columns, self._align, texts, strict=True):
                colour = _CLASSES.get(self.colours.get(name, {}).get(str(text), ""), "")
                short = "short" if len(str(text)) <= _SHORT else ""
                look = f'class="{colour} {short}" style="text-align:{_JUSTIFY[letter]}"'
                made.append(f"<{kind} {look}>{in_html(str(text))}</{kind}>")
            return "".join(made)

        rows = "\n".join(f"<tr>{cells('td', row)}</tr>" for row in self.rows)
        caption = f"<caption>{in_html(self.title)}</caption>" if self.title else ""
        head = f"<thead><tr>{cells('th', self.columns)}</tr></thead>"
        return f"<table>{caption}{head}<tbody>\n{rows}\n</tbody></table>"

    def write_csv(self, path: Path) -> Path:
        """As CSV, completely or not at all; numbers keep every digit.

        Raises:
            UserError: the file cannot be written.
        """
        with write_whole(path) as stream:
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow(self.columns)
            writer.writerows(self.rows)
        return path
