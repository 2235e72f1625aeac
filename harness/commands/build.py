"""`autobalancer build`: the units as FMU files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import UserError
from ..output import options
from ..output.terminal import progress_bar, say, show
from .changes import changed_scene, set_option


def command(
    scene: Annotated[
        str | None,
        typer.Argument(metavar="SCENE", help="Build exactly the units that this scene needs."),
    ] = None,
    output: Annotated[
        Path,
        typer.Option("--output", "-o", metavar="PATH", help="Folder; of one file also its name."),
    ] = Path(),
    fmi: Annotated[int, options.whole("Version of FMI", "--fmi", least=2, most=3)] = 2,
    platform: Annotated[
        list[str] | None,
        typer.Option(
            "--platform",
            metavar="NAME",
            help="Build for this platform only, such as x86_64-linux; may be repeated.",
        ),
    ] = None,
    python: Annotated[
        bool, typer.Option("--python", help="Build units that run Python instead of native code.")
    ] = False,
    one_file: Annotated[
        bool, typer.Option(help="Build the scene's units and their coupling as a single FMU.")
    ] = False,
    plain: Annotated[
        bool, typer.Option("--plain", help="With --one-file: without slopes and coupling figures.")
    ] = False,
    flat: Annotated[
        bool,
        typer.Option("--flat-names", help="With --one-file: rotor_plane_1_F_x, without dots."),
    ] = False,
    reference: Annotated[
        bool,
        typer.Option(
            "--reference",
            help="With --one-file: add a reference solution, by an independent integration.",
        ),
    ] = False,
    ssp: Annotated[
        bool,
        typer.Option("--ssp", help="Write the scene as a system structure package, ready to run."),
    ] = False,
    release: Annotated[
        Path | None,
        typer.Option(
            "--release",
            metavar="DIR",
            help="Write a reproducible archive of all units and bundled scenes, with checksums.",
        ),
    ] = None,
    changes: Annotated[list[str] | None, set_option("rotor.mass=3.0")] = None,
) -> None:
    """Build all units as FMUs, or exactly those that a scene needs."""
    from ..export.build import build_files
    from ..export.release import build_release

    form: dict[str, Any] = {"python": python, "one_file": one_file, "ssp": ssp}
    form |= {"plain": plain, "flat": flat, "reference": reference}
    if scene is None and changes:
        raise UserError("--set: give the scene in which the value is to be replaced")
    loaded = None if scene is None else changed_scene(scene, changes)
    if release is not None:
        if loaded or any(form.values()) or fmi != 2 or output != Path():
            raise UserError(
                "--release: allows --platform only; it has all scenes and versions of FMI"
            )
        with progress_bar("building") as progress:
            archive = build_release(release, platform, progress=progress)
        show(archive.table())
        say(f"Left out as SSP of separate units: {'; '.join(archive.left_out) or 'none'}")
        return
    with progress_bar("integrating the reference" if reference else "building") as progress:
        form["progress"] = progress
        if loaded is None:
            built = build_files(None, output, fmi, platform, **form)
        else:
            built = loaded.build(output, fmi=fmi, platforms=platform, **form)
    show(built.table())
    if not (one_file or ssp):
        say(f"Left out: {', '.join(built.left_out) or 'nothing'}")
