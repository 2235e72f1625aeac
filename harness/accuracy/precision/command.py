"""`autobalancer precision`: error against run time."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ...output import costs, options
from ...output.files import write_json, write_whole
from ...output.machine import machine
from ...output.terminal import progress_bar, say, show

if TYPE_CHECKING:
    from .measure import Point, Precision
    from .time_shares import Split

PROFILED_STEPS = 20  # a revolution, or the scene's first measured step
PROFILED_TOLERANCE = 1e-5
SLOW = 0.3  # s: a run that needs no repeating to be told from noise


def command(
    scene: Annotated[
        str, typer.Argument(metavar="SCENE", help="Scene file or bundled name.")
    ] = "two_balls",
    output: Annotated[
        Path | None, options.picture("Draw it (png, svg, pdf).", "--output", "-o")
    ] = None,
    csv_file: Annotated[
        Path | None, options.output("", "Also write the rows as CSV.", "--csv")
    ] = None,
    json_file: Annotated[Path | None, options.json("the rows")] = None,
    markdown_file: Annotated[Path | None, options.markdown("the tables")] = None,
    seconds: Annotated[
        float, typer.Option(min=1.0, help="About how long the measuring may take.")
    ] = 75.0,
    all_curves: Annotated[
        bool, typer.Option("--all-curves", help="Draw all methods, not the best of each group.")
    ] = False,
    changes: Annotated[list[str] | None, options.changes("run.revolutions=20")] = None,
    at_most: Annotated[str, options.AT_MOST] = costs.DEFAULT,
) -> None:
    """Measure error against run time of every scheme."""
    from ...scene.changes import changed_scene
    from . import report
    from .measure import precision

    loaded = changed_scene(scene, changes)
    limit = costs.limited(at_most, f"run.revolutions = {loaded.run.revolutions:g}")
    with limit, progress_bar(f"measuring {loaded.name}") as move:
        study = precision(loaded, seconds=seconds, progress=lambda what, done: move(done, what))
        move(1.0, "where the time goes")
        splits = _splits(study)
    show(report.table(study))
    show(report.split_table(splits))
    say(report.reference_words(study))
    say(machine())
    if csv_file is not None:
        report.write_csv(study, csv_file)
    if json_file is not None:
        write_json(report.as_json(study), json_file)
    if markdown_file is not None:
        with write_whole(markdown_file) as stream:
            stream.write(report.markdown(study, splits))
    if output is not None:
        from .plot import plot_precision

        say(f"Picture: {plot_precision(study, output, all_curves)}")
    if words := report.one_file_words(study):
        say(words, style="bold")
    say(report.cheapest_words(study), style="bold")


def _splits(study: Precision) -> list[Split]:
    """One coupling of every family that ran."""
    from .time_shares import split_time

    chosen: dict[str, Point] = {}
    for point in study.points:
        method = point.method
        usual = method.steps_per_rev == PROFILED_STEPS or method.tolerance == PROFILED_TOLERANCE
        ours = not (method.in_one_piece or method.one_file)
        if ours and point.counts and (usual or method.family not in chosen):
            chosen[method.family] = point
    return [
        split_time(study.scene, p.method, study.signals, 1 if (p.seconds or 0.0) > SLOW else 3)
        for p in chosen.values()
    ]
