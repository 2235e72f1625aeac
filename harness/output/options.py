"""What the options of several commands have in common; places to write to are looked at first."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Sequence
from contextlib import suppress
from contextvars import ContextVar
from pathlib import Path
from typing import Any

import typer

from ..errors import UserError
from ..units import si_number
from .files import PICTURES, is_stream, picture_format
from .terminal import ready_to_write

typed: ContextVar[tuple[str, ...]] = ContextVar("typed", default=())  # after the program's name
claimed: ContextVar[tuple[Path, ...]] = ContextVar("claimed", default=())  # files to be written
TABLE = ".csv"
_PICTURES = [f".{kind}" for kind in PICTURES]
SCENE = typer.Argument(metavar="SCENE", help="Scene file, or the name of a bundled scene.")
REPORT = typer.Option(
    "--report",
    metavar="DIR",
    help="Also write a report to this folder: report.html, with its pictures.",
)
CLUSTER = typer.Option(
    "--cluster", metavar="ADDRESS", help="Work on the Dask cluster of this scheduler."
)


def quantity(symbol: str, help: str, *names: str) -> Any:
    """A number in this SI unit, or with a unit."""

    def parser(text: str) -> float:
        return si_number(text, symbol, names[0])

    return typer.Option(*names, help=help, parser=parser, metavar="NUMBER")


def whole(help: str, *names: str, least: int = 1, most: int | None = None) -> Any:
    """A whole number from `least` on, or to `most`."""
    allowed = f"{least} or more" if most is None else f"{least} to {most}"

    def parser(text: str) -> int:
        with suppress(ValueError):
            number = int(text)
            if least <= number and (most is None or number <= most):
                return number
        raise UserError(f"{names[0]} {text}: must be a whole number in digits, {allowed}")

    return typer.Option(
        *names, help=f"{help.removesuffix('.')}: {allowed}.", parser=parser, metavar="NUMBER"
    )


def number(help: str, *names: str, least: float = -math.inf) -> Any:
    """A finite number of no unit, `least` or more."""
    allowed = "" if math.isinf(least) else f", {least:g} or more"

    def parser(text: str) -> float:
        with suppress(ValueError):
            value = float(text)
            if least <= value < math.inf:
                return value
        raise UserError(f"{names[0]} {text}: must be a number{allowed}")

    return typer.Option(*names, help=help, parser=parser, metavar="NUMBER")


RANGE = typer.Option(
    "--range", metavar="LOW HIGH", help="Speeds [rad/s], or with units: 300rpm 3000rpm."
)

RANGE_OR_DEFAULT = typer.Option(
    "--range",
    metavar="LOW HIGH",
    help="Speeds [rad/s], or with units: 300rpm 3000rpm; default: from half the lowest natural "
    "frequency to 1.25 times the highest speed of the operation.",
)


def speed_range(given: tuple[str, str]) -> tuple[float, float]:
    """Both speeds of `RANGE` [rad/s]."""
    low, high = (si_number(end, "rad/s", "--range") for end in given)
    return low, high


def _ready(path: Path, endings: Sequence[str]) -> None:
    """Refuse a place that has none of these endings, or cannot be written to."""
    ready_to_write(path)
    if endings and path.suffix.lower() not in endings and not is_stream(path):
        raise UserError(f"{path}: must end in {', '.join(endings)}")
    claim(path)


def claim(path: Path) -> None:
    """Note a file that the command will write."""
    if not is_stream(path):
        claimed.set((*claimed.get(), path.resolve()))


def refuse_read(values: Iterable[Any]) -> None:
    """Refuse to write a file twice, or one that the command reads.

    Args:
        values: of all options and arguments.

    Raises:
        UserError: a file that is claimed is so.
    """
    each = [one for value in values for one in (value if isinstance(value, list) else [value])]
    there = [one for one in each if isinstance(one, (str, Path)) and os.path.isfile(one)]
    for path in claimed.get():
        if claimed.get().count(path) > 1:
            raise UserError(f"{path}: two outputs of this command; give each a file of its own")
        if sum(os.path.realpath(one) == str(path) for one in there) > 1:
            raise UserError(f"{path}: the command reads this file; write to another one")


def output(kind: str, help: str, *names: str) -> Any:
    """A file to write, ending in `kind`, under these names of the option or the parameter's."""

    def ready(path: Path | None) -> Path | None:
        if path is not None:
            _ready(path, [kind] if kind else [])
        return path

    return typer.Option(*names, metavar=f"FILE{kind}", help=help, callback=ready)


def picture(help: str, *names: str) -> Any:
    """A picture to draw."""

    def ready(path: Path | None) -> Path | None:
        ready_to_write(path)
        if path is not None:
            picture_format(path)
            claim(path)
        return path

    return typer.Option(*names, metavar="FILE.png", help=help, callback=ready)


def pictures(help: str = "", *tables: str) -> Any:
    """`--output`, several times: pictures, or tables with these endings."""

    def ready(paths: list[Path] | None) -> list[Path] | None:
        for path in paths or ():
            _ready(path, [*_PICTURES, *tables])
        return paths

    help = f"Picture (png, svg, pdf){help}. Can be given several times."
    return typer.Option("--output", "-o", metavar="FILE", help=help, callback=ready)


def store() -> Any:
    """`--store FILE`."""
    help = "Keep finished parts in this file: the same command continues an interrupted one."
    return output("", help, "--store")


def json(what: str) -> Any:
    """`--json FILE`."""
    return output("", f"Also write {what} as JSON.", "--json")


def markdown(what: str) -> Any:
    """`--markdown FILE`."""
    return output("", f"Also write {what} as Markdown.", "--markdown")
