"""What the options of several commands have in common; places to write to are looked at first."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextvars import ContextVar
from functools import partial
from pathlib import Path
from typing import Any, TypeGuard

import typer

from ..errors import UserError
from ..units import si_number
from .files import PICTURES, is_stream, picture_format
from .terminal import ready_to_write

typed: ContextVar[tuple[str, ...]] = ContextVar("typed", default=())  # after the program's name
STORE, TABLE = ".zarr", ".csv"
SCENE = typer.Argument(metavar="SCENE", help="Scene file, or the name of a bundled scene.")
AT_MOST = typer.Option("--at-most", metavar="TIME", help="Refuse what takes longer: 30m, 2h, 1d.")
REPORT = typer.Option(
    "--report",
    metavar="DIR",
    help="Also write report.html there, a page to pass on, with its pictures.",
)
CLUSTER = typer.Option(
    "--cluster", metavar="ADDRESS", help="Work on the Dask cluster of this scheduler."
)


def quantity(symbol: str, help: str, *names: str) -> Any:
    """A number in this SI unit, or with a unit."""
    parser = partial(si_number, symbol=symbol, what=names[0])
    return typer.Option(*names, help=help, parser=parser, metavar="NUMBER")


RANGE = typer.Option(
    "--range", metavar="LOW HIGH", help="Speeds [rad/s], or with units: 300rpm 3000rpm."
)


def speed_range(given: tuple[str, str]) -> tuple[float, float]:
    """Both speeds of `RANGE` [rad/s]."""
    low, high = (si_number(end, "rad/s", "--range") for end in given)
    return low, high


def _writable(path: Path | None) -> Path | None:
    ready_to_write(path)
    return path


def _no_store(path: Path | None) -> Path | None:
    if is_store(path):
        raise UserError(f"{path}: this command writes no store: name the file otherwise")
    return _writable(path)


def _drawable(path: Path | None) -> Path | None:
    ready_to_write(path)
    if path is not None:
        picture_format(path)
    return path


def output(kind: str, help: str, *names: str) -> Any:
    """A file to write, ending in `kind`, under these names of the option or the parameter's."""

    def ready(path: Path | None) -> Path | None:
        _no_store(path)
        if path is not None and kind and path.suffix.lower() != kind and not is_stream(path):
            raise UserError(f"{path}: must end in {kind}")
        return path

    return typer.Option(*names, metavar=f"FILE{kind}", help=help, callback=ready)


def picture(help: str, *names: str) -> Any:
    """A picture to draw."""
    return typer.Option(*names, metavar="FILE.png", help=help, callback=_drawable)


def is_store(path: Path | None) -> TypeGuard[Path]:
    """Whether it is named as a store."""
    return path is not None and path.suffix == STORE


def _storable(path: Path) -> None:
    from .store import refuse_store

    refuse_store(path)


def _drawable_or_store(paths: list[Path] | None) -> list[Path] | None:
    for path in paths or ():
        _refuse_ending(path, f"{STORE} for a store", (*PICTURES, STORE.removeprefix(".")))
        _storable(path) if is_store(path) else _drawable(path)
    return paths


def _refuse_ending(path: Path, others: str, known: Sequence[str]) -> None:
    if path.suffix.removeprefix(".").lower() not in known:
        kinds = ", ".join(f".{kind}" for kind in PICTURES)
        raise UserError(f"{path}: must end in {kinds}, or {others}")


def _kept(help: str, callback: Callable[[Any], Any]) -> Any:
    """`--output`, which can be a store."""
    return typer.Option("--output", "-o", metavar="FILE", help=help, callback=callback)


def pictures_or_store() -> Any:
    """Pictures to draw, and a store of everything they are drawn from."""
    help = (
        "Picture (png, svg, pdf); or FILE.zarr, which keeps every point as it comes: the same "
        "command goes on where it was ended. Can be given several times."
    )
    return _kept(help, _drawable_or_store)


def _any_place(paths: list[Path] | None) -> list[Path] | None:
    kinds = [*PICTURES, *(each.removeprefix(".") for each in (STORE, TABLE))]
    for path in paths or ():
        _refuse_ending(path, f"{TABLE} for a table, {STORE} for a store", kinds)
        _writable(path) if path.suffix == TABLE else _drawable_or_store([path])
    return paths


def picture_table_or_store(of: str) -> Any:
    """Pictures, tables, and a store of the same."""
    help = (
        f"Picture (png, svg, pdf); FILE.csv with every {of}; or FILE.zarr, which keeps them as "
        "they come: the same command goes on where it was ended. Can be given several times."
    )
    return _kept(help, _any_place)


def json(what: str) -> Any:
    """`--json FILE`."""
    return output("", f"Also write {what} as JSON.", "--json")


def markdown(what: str) -> Any:
    """`--markdown FILE`."""
    return output("", f"Also write {what}.", "--markdown")


def _settings(texts: list[str] | None) -> list[str] | None:
    """Refuse what is no KEY=VALUE before the words after it are refused as further arguments."""
    from ..scene.changes import parse_change

    for text in texts or ():
        parse_change(text)
    return texts


def changes(example: str) -> Any:
    """`--set KEY=VALUE`, as often as wanted."""
    help = f"Replace a value: {example}"
    return typer.Option("--set", metavar="KEY=VALUE", help=help, callback=_settings)
