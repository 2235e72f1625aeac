"""`autobalancer precision`: error against run time."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..output import options
from ..output.files import write_json, write_whole
from ..output.terminal import progress_bar, say, show

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
) -> None:
    """Measure what each digit costs: every scheme, order and step, and SciPy's methods."""
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

    loaded = load_scene(scene)
    with progress_bar(f"measuring {loaded.name}") as move:
        found = precision(loaded, seconds=seconds, progress=lambda what, done: move(done, what))
        move(1.0, "where the time goes")
        splits = _splits(found)
    show(table(found))
    show(split_table(splits))
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
