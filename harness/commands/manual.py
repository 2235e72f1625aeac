"""`autobalancer manual`: the manual as a static site."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..output.terminal import progress_bars, say


def command(
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="Folder of the site.")
    ] = Path("site"),
    live: Annotated[
        bool,
        typer.Option("--live/--no-live", help="Include bundled scenes that run in their pages."),
    ] = True,
) -> None:
    """Write the manual as a static site with search.

    Requires the extra `docs`: pip install 'autobalancer[docs]'.
    """
    from ..manual.site import write_site

    with progress_bars() as bars:
        write_site(output, bars.track, live)
    size = sum(path.stat().st_size for path in output.rglob("*") if path.is_file())
    say(f"Site: {output / 'index.html'} ({size / 1e6:.1f} MB); open it in a browser")
