"""What the options of several commands have in common; places to write to are looked at first."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import typer

from .files import picture_format
from .terminal import ready_to_write

SCENE = typer.Argument(help="Scene file, or the name of a bundled scene.")


def _writable(path: Path | None) -> Path | None:
    ready_to_write(path)
    return path


def _drawable(path: Path | None) -> Path | None:
    ready_to_write(path)
    if path is not None:
        picture_format(path)
    return path


def output(kind: str, help: str, *names: str) -> Any:
    """A file to write, ending in `kind`, under these names of the option or the parameter's."""
    return typer.Option(*names, metavar=f"FILE{kind}", help=help, callback=_writable)


def picture(help: str, *names: str) -> Any:
    """A picture to draw."""
    return typer.Option(*names, metavar="FILE.png", help=help, callback=_drawable)


def json(what: str) -> Any:
    """`--json FILE`."""
    return output("", f"Also write {what} as JSON.", "--json")


def markdown(what: str) -> Any:
    """`--markdown FILE`."""
    return output("", f"Also write {what}.", "--markdown")


def python() -> Any:
    """`--python`."""
    return typer.Option("--python", help="Couple the units that run Python, not native ones.")


def at_most() -> Any:
    """`--at-most TIME`."""
    return typer.Option("--at-most", metavar="TIME", help="Refuse what takes longer: 30m, 2h, 1d.")


def changes(example: str) -> Any:
    """`--set KEY=VALUE`, as often as wanted."""
    return typer.Option("--set", metavar="KEY=VALUE", help=f"Replace a value: {example}")
