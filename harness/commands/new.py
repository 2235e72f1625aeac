"""`autobalancer new`: a scene file to start from."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..errors import UserError
from ..output import options
from ..output.files import write_whole
from ..output.terminal import say

MACHINES = ("drum", "grinder", "centrifuge", "optical_drive", "fan")


def command(
    name: Annotated[
        str, typer.Argument(metavar="NAME", help=f"{', '.join(MACHINES)}, or a bundled scene.")
    ],
    output: Annotated[
        Path | None,
        options.output(".toml", "The file; default: my_NAME.toml here.", "--output", "-o"),
    ] = None,
) -> None:
    """Write a commented scene file to start from."""
    from ..scene.file import find

    source = find(name.replace(" ", "_"))
    path = output or Path(f"my_{source.stem}.toml")
    if path.exists():
        raise UserError(f"{path}: exists; name another file with -o")
    with write_whole(path) as stream:
        stream.write(template(source))
    say(f"Scene: {path}; change its values, then: autobalancer run {path}")


def template(source: Path) -> str:
    """A bundled scene as a start: without what is for the self-check."""
    text = source.read_text(encoding="utf-8").partition("\n[[check]]")[0]
    lines = [line for line in text.splitlines() if not line.startswith("on_request")]
    return "\n".join(lines).rstrip() + "\n"
