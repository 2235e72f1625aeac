"""`autobalancer stress`: stiff and extreme cases."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..errors import UserError
from ..output import options
from ..output.files import write_whole
from ..output.terminal import progress_bar, say, show


def command(
    only: Annotated[
        str | None,
        typer.Argument(metavar="WORDS", help="Only cases whose name contains these words."),
    ] = None,
    markdown_file: Annotated[Path | None, options.markdown("the table")] = None,
) -> None:
    """Run stiff and extreme cases.

    Each must be right or clearly refused; exit code 1 if not.
    """
    from ..accuracy.stress.run import all_cases, stress, table

    names = [name for name in all_cases() if only is None or only.lower() in name.lower()]
    if not names:
        listed = "; ".join(all_cases())
        raise UserError(f"{only!r}: no case has this in its name; there are: {listed}")
    with progress_bar("stress") as move:
        rows = stress(names, move)
    sheet = table(rows)
    show(sheet)
    bad = [row for row in rows if not row.holds]
    held = f"All {len(rows)} cases hold." if not bad else f"{len(bad)} of {len(rows)} do NOT hold."
    say(held, style="bold")
    if markdown_file is not None:
        with write_whole(markdown_file) as stream:
            stream.write(sheet.markdown() + "\n")
    if bad:
        raise typer.Exit(1)
