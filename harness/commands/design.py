"""`autobalancer design`: how many weights, and how large."""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..design.space import MATERIALS
from ..output import options
from ..output.table import Sheet
from ..output.terminal import progress_bar, say, show
from ..units import in_both, rounded, shown_in
from .changes import changed_scene, set_option

if TYPE_CHECKING:
    from ..design.choices import Choice, Design

MEASURE = "Measure it (autobalancer drag) and give it in a [[balancer]] table: settling follows it."


def command(
    scene: Annotated[str, options.SCENE],
    unbalance: Annotated[
        str | None,
        typer.Option(
            metavar="[LOW..]HIGH",
            help='Unbalance, kg m or such as "0..300 g mm"; default: the scene\'s.',
        ),
    ] = None,
    race: Annotated[
        float | None,
        options.quantity("m", "Radius of the race, m; default: the scene's.", "--race", "--track"),
    ] = None,
    width: Annotated[
        float | None,
        options.quantity(
            "m", "Space along the axis, m; default: the diameter of the scene's weights.", "--width"
        ),
    ] = None,
    material: Annotated[
        str,
        typer.Option(
            "--material", "--density", help=f"{', '.join(MATERIALS)}; or a density, kg/m^3."
        ),
    ] = "steel",
    reserve: Annotated[float, typer.Option(help="Ratio of capacity to largest unbalance.")] = 1.0,
    starts: Annotated[int, typer.Option(min=6, help="Random starts for each number.")] = 200,
    most: Annotated[int, typer.Option(min=2, max=64, help="Largest number to compare.")] = 8,
    output: Annotated[
        Path | None, options.picture("Picture (png, svg, pdf).", "--output", "-o")
    ] = None,
    changes: Annotated[list[str] | None, set_option("balls.drag=0.1")] = None,
    report: Annotated[Path | None, options.REPORT] = None,
    details: Annotated[
        bool, typer.Option("--details", help="Also compare Goncharov's theory with the runs.")
    ] = False,
) -> None:
    """Find number and size of balls or rollers for a rotor."""
    from ..design.recommendation import left_behind, words
    from ..output.report import Report

    loaded = changed_scene(scene, changes)
    page = Report(report, f"Design: {loaded.heading}", [loaded])
    with progress_bar(f"designing for {loaded.name}") as progress:
        data = loaded.design(
            unbalance,
            race=race,
            width=width,
            material=material,
            reserve=reserve,
            starts=starts,
            most=most,
            workers=os.cpu_count() or 1,
            progress=progress,
        )
    with page.keeping():
        show(table(data, starts))
        if details:
            show(details_table(data))
        for line in words(data):
            say(line)
        if said := left_behind(data):
            say(said)
        if not loaded.balancer:
            from ..design.scenes import ASSUMED_RATE

            rate = ASSUMED_RATE * loaded.profile().end
            say(f"Drag is ASSUMED: a ball loses its speed within {1.0 / rate:.3g} s. {MEASURE}")
    for path in filter(None, (output, page.picture(f"{loaded.name}_design"))):
        say(f"Picture: {data.plot(path, theory=details)}")
    page.cited = "Goncharov 2017"
    page.write()


def table(data: Design, starts: int) -> Sheet:
    """One line for every number of weights."""
    unit, factor = shown_in("kg m")
    columns = ("n", "diameter mm", "mass kg", f"holds {unit}", "used", "settle s (95 %)", "settled")
    rows = []
    for c in data.choices:
        size = (str(c.count), f"{2e3 * c.radius:.4g}", f"{c.count * c.mass:.4g}")
        used = f"{data.unbalance / c.capacity:.0%}"
        outcome = ("not run", "-")
        if c.runs:
            lost = f", {len(c.failures)} failed" if c.failures else ""
            outcome = (_settling(c), f"{c.settled}/{len(c.ran)}{lost}")
        rows.append((*size, rounded(factor * c.capacity), used, *outcome))
    title = f"{data.kind} for {in_both(data.unbalance, 'kg m')}"
    title += f" with a reserve of {data.reserve:g}" if data.reserve > 1.0 else ""
    title += f", race {1e3 * data.race:.4g} mm, {starts} random starts each\nmass: of all n; "
    title += "holds: largest unbalance they balance; used: of it"
    return Sheet(columns, rows, "r" * len(columns), title)


def _settling(choice: Choice) -> str:
    """Median and interval of the settling time; the time of the run where it did not settle."""
    if math.isnan(choice.median):
        return "too many failed"
    late = f"not within {choice.seconds:.3g} s"
    if math.isinf(choice.median):
        return late
    high = f"-{choice.high:.2g}" if math.isfinite(choice.high) else f" to {late}"
    return f"{choice.median:.3g} ({choice.low:.2g}{high})"


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
