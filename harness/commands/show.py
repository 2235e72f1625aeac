"""`autobalancer show`: a scene as a page that runs it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from ..output import options
from ..output.terminal import progress_bars, say
from .changes import changed_scene, set_option


def command(
    scene: Annotated[str, options.SCENE],
    output: Annotated[Path | None, options.output(".html", "The page.", "--output", "-o")] = None,
    changes: Annotated[list[str] | None, set_option("rotor.mass=3.0")] = None,
) -> None:
    """Write a web page, one file, that runs a scene."""
    loaded = changed_scene(scene, changes)
    with progress_bars() as bars:
        bars.add_task(f"stability of {loaded.name} against speed", total=None)
        page = loaded.show(output)
    say(page.summary)
    say(f"Page: {page.path} ({page.path.stat().st_size / 1000:.0f} kB); open it in a browser")
