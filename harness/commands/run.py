"""`autobalancer run`: one co-simulation from a scene file to signals."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..errors import UserError
from ..output import options
from ..output.terminal import progress_bar, say, say_facts, show
from . import run_pictures as drawings
from .changes import changed_scene, set_option
from .run_system import counts, run_system, say_notes_and_write, system_of

if TYPE_CHECKING:
    from ..result.result import Result
    from ..scene import Scene

MOVIE_SECONDS = 8.0


def command(
    scene: Annotated[str, options.SCENE],
    output: Annotated[
        Path | None, options.output(".csv", "Write the signals as CSV.", "--output", "-o")
    ] = None,
    plot: Annotated[Path | None, options.picture("Draw the signals (png, svg, pdf).")] = None,
    changes: Annotated[list[str] | None, set_option("rotor.unbalance=0.1")] = None,
    fmus: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Use the FMUs in this folder instead of building them."),
    ] = None,
    json_file: Annotated[Path | None, options.json("facts and signals")] = None,
    separate: Annotated[
        bool,
        typer.Option("--separate", help="Couple separate FMUs in Python instead of in C; slower."),
    ] = False,
    one_file: Annotated[
        bool, typer.Option("--one-file", hidden=True, help="Deprecated: the default now.")
    ] = False,
    report: Annotated[Path | None, options.REPORT] = None,
    verbose: Annotated[
        bool, typer.Option("--verbose", help="Also print which units ran, and what was left out.")
    ] = False,
    weights: Annotated[
        Path | None, options.picture("Displacement and angles of all weights against time.")
    ] = None,
    waterfall: Annotated[
        Path | None, options.picture("Spectra over the speed of a run-up.")
    ] = None,
    polar: Annotated[
        Path | None, options.picture("Synchronous amplitude and phase (Nyquist).")
    ] = None,
    orbits: Annotated[
        Path | None, options.picture("Last orbits along the shaft, in space.")
    ] = None,
    compare: Annotated[
        Path | None, options.picture("Vibration with balancers, and without.")
    ] = None,
    movie: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.gif",
            help="Moving picture: gif, webp, mp4.",
            callback=drawings.check_movie,
        ),
    ] = None,
    movie_seconds: Annotated[
        float | None,
        options.quantity("s", "Length of the movie, s; default: 8.", "--movie-seconds"),
    ] = None,
) -> None:
    """Run a scene, a system of FMUs of any origin, an SSP, or one FMU.

    Pictures are png, svg or pdf.
    """
    from ..capture.captured import left_behind
    from ..output.report import Report
    from ..result.run import refuse_separate
    from ..result.tables import summary

    wanted = {"weights": weights, "waterfall": waterfall, "polar": polar, "orbits": orbits}
    wanted["compared"] = compare
    pictures = {kind: path for kind, path in wanted.items() if path is not None}
    if (system := system_of(scene, changes)) is not None:
        unsupported = {**wanted, "fmus": fmus, "separate": separate, "report": report}
        unsupported |= {"movie": movie, "one-file": one_file}
        return run_system(system, unsupported, output, plot, json_file, verbose)
    loaded = changed_scene(scene, changes)
    if fmus is not None and not fmus.is_dir():
        raise UserError(f"{fmus}: is not a directory with FMUs")
    if one_file:
        refuse_separate(loaded, fmus)
        say("NOTE: --one-file is the default now, and deprecated", style="bold yellow", error=True)
    if movie is None and movie_seconds is not None:
        raise UserError("--movie-seconds: is the length of a movie: give --movie FILE.gif too")
    if movie is not None:
        from ..result.movie import refuse_unseen

        length = MOVIE_SECONDS if movie_seconds is None else movie_seconds
        refuse_unseen(loaded, length)
    drawings.refuse_pictures(loaded, pictures)
    record = drawings.record(loaded) if pictures or movie else loaded.run.record
    if plot is not None and record == ():
        raise UserError("--plot: nothing to draw: run.record = []")
    with progress_bar(f"running {loaded.name}") as progress:
        result = loaded.run(record=record, fmus=fmus, progress=progress, separate=separate)
    page = Report(report, loaded.heading, [loaded])
    with page.keeping():
        show(summary(result))
        say(str(result.summary()))
        if not loaded.guests and (said := left_behind(loaded)):
            say(said)
    if verbose:
        _say_how(result, loaded)
    say_notes_and_write(result, output, json_file, plot)
    if drawn := page.picture(loaded.name) if result.signals else None:
        result.plot(drawn)
    page.write()
    drawings.draw(result, pictures)
    if movie is not None:
        with progress_bar(f"drawing {movie.name}") as progress:
            result.movie(movie, length, progress)
        say(f"Movie: {movie}")


def _say_how(result: Result, scene: Scene) -> None:
    """Say which units ran, in how many steps, and with which error."""
    ran_as = "FMUs loaded"
    if result.series_order:
        how = f"power series of order {result.series_order}"
        if result.collocated_steps:
            how += f" and {result.collocated_steps} steps by collocation"
        ran_as = f"In one piece, by {how}, as one file"
    say_facts(result.units, result.left_out, ran_as)
    if result.series_order and (given := scene.coupling.of_separate):
        rows = ", rows are at the given ones" * (scene.coupling.steps_per_rev is not None)
        say(
            f"{', '.join(given)}: of separate FMUs (--separate); in one piece steps are the "
            f"machine's own{rows}"
        )
    known = "" if result.error_known else ", not known"
    say(f"{counts(result)}; estimated error {result.estimated_error:.1g}{known}")
