"""`autobalancer show`: a scene as a page that runs it."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from ..errors import UserError
from ..output import costs, options
from ..output.files import write_whole
from ..output.terminal import progress_bars, say
from ..scene.changes import changed_scene


def command(
    scene: Annotated[str, options.SCENE],
    output: Annotated[Path | None, options.output(".html", "The page.", "--output", "-o")] = None,
    changes: Annotated[list[str] | None, options.changes("rotor.mass=3.0")] = None,
    at_most: Annotated[str, options.AT_MOST] = costs.DEFAULT,
) -> None:
    """Write a web page, one file, that runs a scene."""
    from ...fmus.native.build.compile import NotCompiled
    from ..master.recorder import recorded
    from ..master.run import cosimulate
    from .page import page

    loaded = changed_scene(scene, changes)
    path = output or Path(f"{loaded.name}.html")
    with costs.limited(at_most, f"page of {loaded.name}"), progress_bars() as bars:
        bars.add_task(f"stability of {loaded.name} against speed", total=None)
        try:
            whole = loaded.replace({"run.record": None})
            said = str(cosimulate(whole, record=recorded(whole)).summary())
            text = page(loaded, said)
        except NotCompiled as error:
            raise UserError(str(error)) from error
    with write_whole(path) as stream:
        stream.write(text)
    say(said)
    say(f"Page: {path} ({path.stat().st_size / 1000:.0f} kB); open it in a browser")
