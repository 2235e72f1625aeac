"""`autobalancer design`: how many weights, and how large."""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..errors import UserError
from ..output import costs, options
from ..output.table import Sheet
from ..output.terminal import progress_bar, say, show
from ..units import in_both

if TYPE_CHECKING:
    from .choices import Design


def command(
    scene: Annotated[str, options.SCENE],
    unbalance: Annotated[
        float | None,
        options.quantity("kg m", "Largest unbalance, kg m; default: the scene's.", "--unbalance"),
    ] = None,
    race: Annotated[
        float | None,
        options.quantity("m", "Radius of the race, m; default: the scene's.", "--race"),
    ] = None,
    width: Annotated[
        float | None,
        options.quantity(
            "m", "Space along the axis, m; default: the diameter of the scene's weights.", "--width"
        ),
    ] = None,
    density: Annotated[
        float, options.quantity("kg/m^3", "Of the weights, kg/m^3.", "--density")
    ] = 7800.0,
    starts: Annotated[int, typer.Option(min=6, help="Random starts for every number.")] = 200,
    most: Annotated[int, typer.Option(min=2, max=64, help="Compare 2 to this many.")] = 8,
    output: Annotated[
        Path | None, options.picture("Picture (png, svg, pdf).", "--output", "-o")
    ] = None,
    changes: Annotated[list[str] | None, options.changes("balls.drag=0.1")] = None,
    at_most: Annotated[str, options.AT_MOST] = costs.DEFAULT,
    report: Annotated[Path | None, options.REPORT] = None,
    details: Annotated[
        bool, typer.Option("--details", help="Also compare Goncharov's theory with the runs.")
    ] = False,
) -> None:
    """Compare numbers of balls or rollers: capacity and settling."""
    from ..output.report import Report
    from ..scene.changes import changed_scene
    from .choices import design
    from .recommendation import words

    if unbalance is not None and not 0.0 <= unbalance < math.inf:
        raise UserError(f"--unbalance {unbalance:g}: must be 0 or more")
    for name, value in (("--race", race), ("--width", width), ("--density", density)):
        if value is not None and not 0.0 < value < math.inf:
            raise UserError(f"{name} {value:g}: must be above 0")
    loaded = changed_scene(scene, changes)
    page = Report(report, f"Design: {loaded.heading}", [loaded])
    key = f"--starts {starts} --most {most}, run.revolutions = {loaded.run.revolutions:g}"
    limit = costs.limited(at_most, key)  # one batch of runs may be too long by itself
    with limit, progress_bar(f"designing for {loaded.name}") as progress:
        data = design(
            loaded,
            unbalance=unbalance,
            race=race,
            width=width,
            density=density,
            counts=range(2, most + 1),
            starts=starts,
            workers=os.cpu_count() or 1,
            progress=costs.within(at_most, key, progress),
        )
    with page.keeping():
        show(table(data, starts))
        if details:
            show(details_table(data))
        for line in words(data):
            say(line)
        if data.separate:
            say(f"Separate units ran: {data.separate}")
        elif data.with_capacity:
            say("All starts ran in C as one composite")
        say(f"FMUs loaded: {', '.join(data.units) or 'none'}")
    for path in filter(None, (output, page.picture(f"{loaded.name}_design"))):
        from .plot import plot_design

        say(f"Picture: {plot_design(data, path)}")
    page.cited = "Goncharov 2017"
    page.write()


def table(data: Design, starts: int) -> Sheet:
    """One line for every number of weights."""
    names = ("n", "radius mm", "mass kg", "max kg m", "used")
    columns = (*names, "settle s", "95 % s", "settled")  # 80 columns of a terminal are enough
    rows = []
    for c in data.choices:
        size = (str(c.count), f"{1e3 * c.radius:.4g}", f"{c.count * c.mass:.4g}")
        used = f"{data.unbalance / c.capacity:.0%}"
        measured = ("not run", "-", "-")
        if c.runs:
            settled = f"{c.settled}/{len(c.runs)}"
            measured = (_time(c.median, "never"), f"{c.low:.2g}-{c.high:.2g}", settled)
        rows.append((*size, f"{c.capacity:.4g}", used, *measured))
    title = f"{data.kind} for {in_both(data.unbalance, 'kg m')}, race {1e3 * data.race:.4g} mm"
    title += (
        f", {starts} random starts each\nmass: of all n; max: unbalance they can hold; used: of it"
    )
    return Sheet(columns, rows, "r" * len(columns), title)


def details_table(data: Design) -> Sheet:
    """Spread, measure and settling time by Goncharov 2017, and the spread that the runs reach."""
    spreads = ("n", "p packed", "p largest", "(1-p) m n", "predicted s")
    columns = (*spreads, "p reached", "predicted there s")
    rows = []
    for c in data.choices:
        theory = (f"{c.packed:.3f}", f"{c.largest:.3f}", f"{c.measure:.4f}", _time(c.predicted))
        reached = ("-", "not run")
        if c.runs:
            reached = (f"{c.median_alignment:.3f}", _time(c.predicted_at_end))
        rows.append((str(c.count), *theory, *reached))
    return Sheet(columns, rows, "r" * len(columns), "By Goncharov 2017, and where the runs end")


def _time(seconds: float, never: str = "p = 1") -> str:
    return f"{seconds:.3g}" if math.isfinite(seconds) else never
