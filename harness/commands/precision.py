"""`autobalancer precision`: error against run time."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..output import options
from ..output.files import write_json, write_whole
from ..output.machine import machine
from ..output.terminal import progress_bar, say, show
from .changes import changed_scene, set_option


def command(
    scene: Annotated[
        str, typer.Argument(metavar="SCENE", help="Scene file or bundled name.")
    ] = "two_balls",
    output: Annotated[
        Path | None,
        options.picture("Draw error against run time (png, svg, pdf).", "--output", "-o"),
    ] = None,
    json_file: Annotated[Path | None, options.json("the rows")] = None,
    markdown_file: Annotated[Path | None, options.markdown("the tables")] = None,
    seconds: Annotated[
        float,
        options.number("Approximate duration of the measurement, s.", "--seconds", least=1.0),
    ] = 75.0,
    changes: Annotated[list[str] | None, set_option("run.revolutions=20")] = None,
) -> None:
    """Measure error against run time of every scheme."""
    from ..accuracy.precision import report

    loaded = changed_scene(scene, changes)
    with progress_bar(f"measuring {loaded.name}") as move:
        study = loaded.precision(seconds, progress=lambda what, done: move(done, what))
    show(report.table(study))
    say(report.reference_words(study))
    say(machine())
    if json_file is not None:
        write_json(study.as_json(), json_file)
    if markdown_file is not None:
        with write_whole(markdown_file) as stream:
            stream.write(report.markdown(study))
    if output is not None:
        say(f"Picture: {study.plot(output)}")
    show(report.cheapest(study))
