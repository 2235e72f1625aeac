"""`autobalancer precision`: error against run time."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..output.terminal import console, progress_bars, ready_to_write, say

if TYPE_CHECKING:
    from .measure import Precision
    from .time_shares import Split

PROFILED_STEPS = 20  # a revolution, or the scene's first measured step
PROFILED_TOLERANCE = 1e-5
SLOW = 0.3  # s: a run that needs no repeating to be told from noise


def command(
    scene: Annotated[
        str, typer.Argument(metavar="[SCENE]", help="Scene file or bundled name.")
    ] = "two_balls",
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE.png", help="Draw it (png, svg, pdf)."),
    ] = None,
    csv_file: Annotated[
        Path | None, typer.Option("--csv", metavar="FILE", help="Also write the rows as CSV.")
    ] = None,
    json_file: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="Also write the rows as JSON.")
    ] = None,
    markdown_file: Annotated[
        Path | None, typer.Option("--markdown", metavar="FILE", help="Also write the tables.")
    ] = None,
    seconds: Annotated[
        float, typer.Option(min=1.0, help="About how long the measuring may take.")
    ] = 75.0,
) -> None:
    """Measure what each digit costs: every scheme, order and step, and SciPy's methods."""
    from ..checks.report import write_json
    from ..output.files import picture_format, write_whole
    from ..scene import load_scene
    from .measure import precision
    from .report import (
        as_json,
        cheapest_words,
        comparison_words,
        machine,
        markdown,
        reference_words,
        split_table,
        table,
        write_csv,
    )

    for path in (output, csv_file, json_file, markdown_file):
        ready_to_write(path)
    if output is not None:
        picture_format(output)
    loaded = load_scene(scene)
    with progress_bars() as bars:
        task = bars.add_task(f"measuring {loaded.name}", total=1.0)
        found = precision(
            loaded,
            seconds=seconds,
            progress=lambda part, what: bars.update(task, completed=part, description=what),
        )
        bars.update(task, description="where the time goes")
        splits = _splits(found)
    console().print(table(found))
    console().print(split_table(splits))
    say(reference_words(found))
    say(machine())
    if csv_file is not None:
        write_csv(found, csv_file)
    if json_file is not None:
        write_json(as_json(found), json_file)
    if markdown_file is not None:
        with write_whole(markdown_file) as stream:
            stream.write(markdown(found, splits))
    if output is not None:
        from .plot import plot_precision

        say(f"Picture: {plot_precision(found, output)}")
    if words := comparison_words(found):
        say(words, style="bold")
    say(cheapest_words(found), style="bold")


def _splits(found: Precision) -> list[Split]:
    """One coupling of every family that ran."""
    from .methods import ALONG_FIXED_AXES
    from .time_shares import split_time

    chosen = {}
    for point in found.points:
        method = point.method
        other = method.name.startswith("monolith") or method.name in (
            ALONG_FIXED_AXES,
            "libcosimpy",
        )
        if other or not point.counts:
            continue
        usual = PROFILED_STEPS, PROFILED_TOLERANCE
        if method.family not in chosen or (
            method.steps_per_rev == usual[0] or method.tolerance == usual[1]
        ):
            chosen[method.family] = method
    slow = {point.method: (point.seconds or 0.0) > SLOW for point in found.points}
    return [
        split_time(found.scene, method, found.signals, 1 if slow[method] else 3)
        for method in chosen.values()
    ]
