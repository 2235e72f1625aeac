"""`autobalancer report`: one page about a machine for a colleague."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from ..errors import MOST_STARTS
from ..output import options
from ..output.terminal import progress_bar, say
from .changes import changed_scene, set_option


def command(
    scene: Annotated[str, options.SCENE],
    output: Annotated[Path | None, options.output(".html", "The page.", "--output", "-o")] = None,
    run_up: Annotated[
        float | None,
        options.quantity(
            "s", "Time from standstill to full speed [s]; default: the scene's drive.", "--run-up"
        ),
    ] = None,
    limit: Annotated[
        float | None,
        options.quantity("m/s", "Limit of the vibration velocity, rms [m/s].", "--limit"),
    ] = None,
    vary: Annotated[
        list[str] | None,
        typer.Option(metavar="PATH=NAME(NUMBERS)", help="A tolerance, as of `scatter`."),
    ] = None,
    machines: Annotated[
        int,
        options.whole("Number of machines drawn from the tolerances", "-n", most=MOST_STARTS),
    ] = 200,
    changes: Annotated[list[str] | None, set_option("rotor.mass=3.0")] = None,
) -> None:
    """Write a page about a machine for a colleague."""
    loaded = changed_scene(scene, changes)
    with progress_bar(f"report on {loaded.name}") as progress:
        page = loaded.report(
            output,
            run_up=run_up,
            limit=limit,
            vary=vary or (),
            n=machines,
            workers=os.cpu_count() or 1,
            progress=progress,
        )
    for line in page.verdicts:
        say(line)
    say(f"Page: {page.path} ({page.path.stat().st_size / 1000:.0f} kB); open it in a browser")
