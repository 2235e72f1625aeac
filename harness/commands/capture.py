"""`autobalancer capture`: whether weights can be left behind, in closed form."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from ..output import options
from ..output.files import write_json
from ..output.terminal import say, show
from .changes import changed_scene, set_option


def command(
    scene: Annotated[str, options.SCENE],
    speed: Annotated[
        float | None,
        options.quantity("rad/s", "Of the rotor [rad/s]; default: the scene's.", "--speed"),
    ] = None,
    output: Annotated[
        Path | None, options.picture("Brake and drag over speed.", "--output", "-o")
    ] = None,
    json_file: Annotated[Path | None, options.json("everything")] = None,
    changes: Annotated[list[str] | None, set_option("balls.drag=0.1")] = None,
) -> None:
    """Say in closed form whether weights can be left behind."""
    found = changed_scene(scene, changes).capture(speed)
    if found.found.natural:
        show(found.readable())
    say(found.sentence())
    for line in found.limits():
        say(line)
    if found.linear:
        say(found.linear)
    if output is not None:
        say(f"Picture: {found.plot(output)}")
    if json_file is not None:
        write_json(found.as_json(), json_file)
