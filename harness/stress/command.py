"""`autobalancer stress`: stiff and extreme cases."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..errors import UserError
from ..output.terminal import console, progress_bars, ready_to_write, say


def command(
    only: Annotated[
        str | None,
        typer.Argument(metavar="[WORDS]", help="Only cases whose name has these words."),
    ] = None,
    json_file: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="Also write the rows as JSON.")
    ] = None,
    markdown_file: Annotated[
        Path | None, typer.Option("--markdown", metavar="FILE", help="Also write the table.")
    ] = None,
) -> None:
    """Run stiff and extreme cases: each must be right or clearly refused; exit code 1 if not."""
    from ..checks.report import write_json
    from ..output.files import write_whole
    from .cases import all_cases
    from .run import as_json, markdown, stress, table

    ready_to_write(json_file)
    ready_to_write(markdown_file)
    names = [name for name in all_cases() if only is None or only.lower() in name.lower()]
    if not names:
        raise UserError(f"{only!r}: no case has this in its name; there are: {_listed()}")
    with progress_bars() as bars:
        task = bars.add_task("stress", total=len(names))
        rows = stress(
            names,
            lambda done, _total, name: bars.update(task, completed=done, description=name[:40]),
        )
    console().print(table(rows))
    bad = [row for row in rows if not row.holds]
    held = f"All {len(rows)} cases hold." if not bad else f"{len(bad)} of {len(rows)} do NOT hold."
    say(held, style="bold")
    if json_file is not None:
        write_json(as_json(rows), json_file)
    if markdown_file is not None:
        with write_whole(markdown_file) as stream:
            stream.write(markdown(rows))
    if bad:
        raise typer.Exit(1)


def _listed() -> str:
    from .cases import all_cases

    return "; ".join(all_cases())
