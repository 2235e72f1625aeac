"""`autobalancer race`: what a race that is not round leaves of the vibration."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..output import options
from ..output.files import write_json
from ..output.terminal import progress_bars, say, show
from .changes import changed_scene, set_option


def command(
    scene: Annotated[str, options.SCENE],
    lobes: Annotated[
        str | None,
        typer.Option(
            help="ORDER=AMPLITUDE@ANGLE, several with commas: 2=20 um@30 deg is an oval, "
            "20 um half of its peak-to-valley; default: the scene's own races."
        ),
    ] = None,
    speed: Annotated[
        float | None,
        options.quantity("rad/s", "Of the rotor [rad/s]; default: the scene's.", "--speed"),
    ] = None,
    json_file: Annotated[Path | None, options.json("everything")] = None,
    changes: Annotated[list[str] | None, set_option("balls.drag=0.1")] = None,
) -> None:
    """Say what a race that is not round leaves of the vibration."""
    loaded = changed_scene(scene, changes)
    with progress_bars() as bars:
        bars.add_task(f"rests of the weights of {loaded.name}", total=None)
        found = loaded.race(lobes, speed)
    show(found.readable())
    say(found.sentence())
    if json_file is not None:
        write_json(found.as_json(), json_file)
