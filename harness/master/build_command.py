"""`autobalancer build`: the units as FMU files."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ...fmus.catalogue import CATALOGUE
from ..errors import UserError, is_own_file
from ..output import options
from ..output.table import Sheet
from ..output.terminal import progress_bars, ready_to_write, say, show
from ..scene.changes import changed_scene

if TYPE_CHECKING:
    from ..scene import Scene


def command(
    scene: Annotated[
        str | None,
        typer.Argument(metavar="SCENE", help="Build exactly the units that this scene needs."),
    ] = None,
    output: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="Where the files go.")
    ] = Path(),
    fmi: Annotated[int, typer.Option("--fmi", metavar="2|3", help="Version of FMI.")] = 2,
    platform: Annotated[
        list[str] | None,
        typer.Option(
            "--platform",
            metavar="NAME",
            help="For this platform instead of all, such as x86_64-linux; may be repeated.",
        ),
    ] = None,
    python: Annotated[
        bool, typer.Option("--python", help="Units that run Python, instead of native ones.")
    ] = False,
    one_file: Annotated[
        bool, options.one_file("The scene's units and their coupling as a single FMU.")
    ] = False,
    ssp: Annotated[
        bool, typer.Option("--ssp", help="The scene as a system structure package, ready to run.")
    ] = False,
    changes: Annotated[list[str] | None, options.changes("rotor.mass=3.0")] = None,
) -> None:
    """Build all units as FMUs, or exactly those that a scene needs."""
    backend = "python" if python else "native"
    form = {"backend": backend, "fmi": fmi, "platforms": platform}
    if scene is None and changes:
        raise UserError("--set: give the scene in which the value is to be replaced")
    loaded = None if scene is None else changed_scene(scene, changes)
    if ssp:
        if loaded is None or fmi != 2 or (one_file and python):
            raise UserError(
                "--ssp: give a scene, and neither --fmi 3, which SSP 1.0 does not have, nor "
                "--python with --one-file"
            )
        _build_ssp(loaded, output, one_file, backend, platform)
        return
    if one_file:
        if loaded is None:
            raise UserError("--one-file: give the scene whose units are to be coupled")
        if python:
            raise UserError("--one-file: has no Python units; leave out --python")
        _build_one_file(loaded, output, fmi, platform)
        return
    wanted, left_out = _wanted(loaded, python)
    rows = []
    with progress_bars() as bars:
        for name, (unit, sizes) in bars.track(wanted.items(), description="building"):
            path = _build(unit, output / name, {**sizes, **form})
            shown = ", ".join(f"{key} = {value}" for key, value in sizes.items()) or "-"
            rows.append([str(path), unit, shown, f"{path.stat().st_size / 1000:.0f}"])
    show(Sheet(("file", "unit", "options", "kB"), rows, "lllr", "Units built"))
    say(f"Left out: {', '.join(left_out) or 'nothing'}")


def _wanted(
    scene: Scene | None, python: bool
) -> tuple[dict[str, tuple[str, dict[str, Any]]], list[str]]:
    """File name -> unit and options; and the units that the scene does without."""
    if scene is None:
        kinds = [unit for unit in CATALOGUE if not (python and CATALOGUE[unit].native)]
        return {f"{unit}.fmu": (unit, {}) for unit in kinds}, [
            f"{unit} (native only)" for unit in CATALOGUE if unit not in kinds
        ]
    from .plan import plan

    units = plan(scene).units
    wanted = {unit.file_name: (unit.model, dict(unit.sizes)) for unit in units}
    used = {unit.model for unit in units}
    return wanted, [f"{unit} (none in the scene)" for unit in CATALOGUE if unit not in used]


def _build_one_file(scene: Scene, output: Path, fmi: int, platforms: list[str] | None) -> None:
    from .one_file import build_one_file

    path = _written(
        output / f"{scene.name}.fmu", lambda to: build_one_file(scene, to, fmi, platforms)
    )
    parts = ", ".join(["rotor", *(balancer.label for balancer in scene.balancer)])
    row = [str(path), parts, scene.coupling.scheme, f"{path.stat().st_size / 1000:.0f}"]
    show(Sheet(("file", "units", "coupling", "kB"), [row], "lllr", "Scene built"))


def _build_ssp(
    scene: Scene, output: Path, one_file: bool, backend: str, platforms: list[str] | None
) -> None:
    from .ssp.build import build_ssp

    path = output
    if output.suffix != ".ssp":
        path = output / f"{scene.name}.ssp"
    form: dict[str, Any] = {"one_file": one_file, "backend": backend, "platforms": platforms}
    _written(path, lambda to: build_ssp(scene, to, **form))
    units = "coupled inside" if one_file else "connected, with slopes"
    row = [str(path), units, f"{path.stat().st_size / 1000:.0f}"]
    show(Sheet(("file", "units", "kB"), [row], "llr", "System structure package built"))


def _build(unit: str, path: Path, form: dict[str, Any]) -> Path:
    from ...fmus.build import build

    return _written(path, lambda to: build(unit, to, **form))


def _written(path: Path, make: Callable[[Path], Path]) -> Path:
    """An FMU made at a path; what prevents it is a UserError."""
    from ...fmus.native.build.compile import NotCompiled

    there = next(folder for folder in path.parents if folder.exists())  # the others are made
    ready_to_write(there / path.name)  # compiling can take minutes
    try:
        return make(path)
    except OSError as error:
        if is_own_file(error):
            raise
        raise UserError(f"{path}: cannot be written: {error.strerror or error}") from error
    except ValueError as error:
        raise UserError(f"{path}: {error}") from error
    except NotCompiled as error:
        raise UserError(f"{error}; or build units that run Python: --python") from error
