"""`autobalancer cite`: the papers and methods behind a scene's run."""

from __future__ import annotations

from typing import Annotated

import typer

from ..output import options
from ..output.terminal import say
from .changes import changed_scene, set_option


def command(
    scene: Annotated[str, options.SCENE],
    changes: Annotated[list[str] | None, set_option("coupling.scheme='\"jacobi\"'")] = None,
    separate: Annotated[
        bool, typer.Option("--separate", help="What a run of separate FMUs cites.")
    ] = False,
) -> None:
    """Print what a run of a scene cites, as BibTeX.

    The first entry is the program itself.  A comment above each entry says what it is cited for.
    """
    say(changed_scene(scene, changes, quietly=True).cite(separate=separate))
