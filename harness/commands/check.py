"""`autobalancer check`: scenes against theory."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..errors import SimulationError
from ..output import options
from ..output.files import write_json
from ..output.terminal import progress_bars, ready_to_fill, say, say_facts, show
from .changes import changed_scene, set_option, with_changes

if TYPE_CHECKING:
    from ..checks.row import Row
    from ..checks.runner import SceneReport
    from ..scene import Scene


def command(
    scenes: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="SCENE...",
            help="Scene files or bundled names; default: all except long ones (on_request = true), "
            "such as bristol.",
        ),
    ] = None,
    json_file: Annotated[Path | None, options.json("the rows")] = None,
    report: Annotated[Path | None, options.REPORT] = None,
    changes: Annotated[list[str] | None, set_option("coupling.steps_per_rev=80")] = None,
) -> None:
    """Check scenes against theory and measurement.

    Exit code 1 if a row does not hold.
    """
    from ..checks.report import as_json, table, verdict
    from ..checks.runner import check_all, checked_scenes
    from ..scene.plausible import implausible, tell_warning

    loaded: list[Scene]
    if scenes:
        loaded = [changed_scene(name, changes, quietly=True) for name in scenes]
    else:
        loaded = [with_changes(scene, changes) for scene in checked_scenes()]
    for scene in loaded if scenes else []:
        for line in implausible(scene):
            tell_warning(f"{scene.label}: {line}")
    if report is not None:
        ready_to_fill(report)
    with progress_bars() as bars:
        tasks = {s.name: bars.add_task(f"checking {s.name}", total=1.0) for s in loaded}
        results = check_all(loaded, lambda name, done: bars.update(tasks[name], completed=done))
    rows = [row for result in results for row in result.rows]
    for result in results:
        seconds = sum(row.seconds for row in result.rows)
        show(table(result.rows, f"{result.scene} ({seconds:.1f} s)"))
        say_facts(result.units, result.left_out)
        say("")
    say(verdict(rows), style="bold")
    if json_file is not None:
        write_json(as_json(rows), json_file)
    if report is not None:
        _write_report(loaded, results, rows, report)
    if not all(row.holds for row in rows):
        raise typer.Exit(1)


def _write_report(
    scenes: list[Scene], results: list[SceneReport], rows: list[Row], directory: Path
) -> None:
    from ..checks.pictures import draw_pictures
    from ..checks.report import table, verdict
    from ..output.report import Report

    page = Report(directory, "Checks", scenes)
    page.parts += [verdict(rows), *(table(r.rows, r.scene, sourced=True) for r in results)]
    page.parts += [f"{r.scene} left out: {'; '.join(r.left_out)}" for r in results if r.left_out]
    page.folder()
    with progress_bars() as bars:
        for scene, result in zip(scenes, results, strict=True):
            task = bars.add_task(f"drawing {scene.name}", total=None)
            if all(row.quantity != "run" for row in result.rows):
                try:
                    page.pictures += draw_pictures(scene, directory, result.scene)
                except SimulationError as error:  # the rows stand all the same
                    page.parts.append(f"No picture of {scene.heading}: {error}")
            bars.remove_task(task)
    page.write()
