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
from ..units import in_both, rounded, shown_in, si_number

if TYPE_CHECKING:
    from .choices import Design


MEASURE = "Measure it (autobalancer drag) and give it in a [[balancer]] table: settling follows it."
MATERIALS = {
    "steel": 7800.0, "brass": 8500.0, "tungsten carbide": 14900.0, "ceramic": 3200.0,
    "glass": 2500.0, "aluminium": 2700.0,
}  # kg/m^3  # fmt: skip


def command(
    scene: Annotated[str, options.SCENE],
    unbalance: Annotated[
        str | None,
        typer.Option(
            metavar="[LOW..]HIGH",
            help='That occurs, kg m or such as "0..300 g mm"; default: the scene\'s.',
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
    reserve: Annotated[float, typer.Option(help="Capacity over the largest unbalance.")] = 1.0,
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
    """Find number and size of balls or rollers for a rotor."""
    from ..output.report import Report
    from ..scene.changes import changed_scene
    from .choices import design
    from .recommendation import words

    least, largest = _unbalances(unbalance)
    for name, value in (("--race", race), ("--width", width)):
        if value is not None and not 0.0 < value < math.inf:
            raise UserError(f"{name} {value:g}: must be above 0")
    if not 1.0 <= reserve < math.inf:
        raise UserError(f"--reserve {reserve:g}: must be 1 or more, such as 1.3")
    density = _density(material)
    loaded = changed_scene(scene, changes)
    page = Report(report, f"Design: {loaded.heading}", [loaded])
    key = f"--starts {starts} --most {most}, run.revolutions = {loaded.run.revolutions:g}"
    limit = costs.limited(at_most, key)  # one batch of runs may be too long by itself
    with limit, progress_bar(f"designing for {loaded.name}") as progress:
        data = design(
            loaded,
            unbalance=largest,
            race=race,
            width=width,
            density=density,
            counts=range(2, most + 1),
            starts=starts,
            workers=os.cpu_count() or 1,
            progress=costs.within(at_most, key, progress),
            reserve=reserve,
            least=least,
        )
    with page.keeping():
        show(table(data, starts))
        if details:
            show(details_table(data))
        for line in words(data, details):
            say(line)
        if not loaded.balancer:
            from .scenes import ASSUMED_RATE

            rate = ASSUMED_RATE * loaded.profile().end
            say(f"Drag is ASSUMED: a ball loses its speed within {1.0 / rate:.3g} s. {MEASURE}")
    for path in filter(None, (output, page.picture(f"{loaded.name}_design"))):
        from .plot import plot_capacity, plot_design

        say(f"Picture: {(plot_design if details else plot_capacity)(data, path)}")
    page.cited = "Goncharov 2017"
    page.write()


def _unbalances(given: str | None) -> tuple[float, float | None]:
    """Smallest and largest unbalance [kg m] of "0..300 g mm"; None: the scene's."""
    if given is None:
        return 0.0, None
    low, _, high = given.rpartition("..")
    largest = si_number(high, "kg m", "--unbalance")
    unit = high.strip().lstrip("+-.0123456789eE")
    bare = low.strip() and not low.strip()[-1].isalpha()  # its unit is the other's
    least = si_number(low + unit if bare else low, "kg m", "--unbalance") if low else 0.0
    if not 0.0 <= least <= largest < math.inf:
        raise UserError(f'--unbalance {given}: must be 0 or more, such as "0..300 g mm"')
    return least, largest


def _density(material: str) -> float:
    """Of a material by its name, or as it is given [kg/m^3]."""
    if material in MATERIALS:
        return MATERIALS[material]
    try:
        density = si_number(material, "kg/m^3", "--material")
    except UserError as error:
        from ..scene.messages import did_you_mean

        known = did_you_mean(material, list(MATERIALS))
        raise UserError(f"{error}, or one of {', '.join(MATERIALS)}{known}") from None
    if not 0.0 < density < math.inf:
        raise UserError(f"--material {material}: must be above 0")
    return density


def table(data: Design, starts: int) -> Sheet:
    """One line for every number of weights."""
    unit, factor = shown_in("kg m")
    columns = ("n", "diameter mm", "mass kg", f"holds {unit}", "used", "settle s (95 %)", "settled")
    rows = []
    for c in data.choices:
        size = (str(c.count), f"{2e3 * c.radius:.4g}", f"{c.count * c.mass:.4g}")
        used = f"{data.unbalance / c.capacity:.0%}"
        measured = ("not run", "-")
        if c.runs:
            time = f"{_time(c.median, 'never')} ({c.low:.2g}-{c.high:.2g})"
            measured = (time, f"{c.settled}/{len(c.runs)}")
        rows.append((*size, rounded(factor * c.capacity), used, *measured))
    title = f"{data.kind} for {in_both(data.unbalance, 'kg m')}"
    title += f" with a reserve of {data.reserve:g}" if data.reserve > 1.0 else ""
    title += f", race {1e3 * data.race:.4g} mm, {starts} random starts each\nmass: of all n; "
    title += "holds: largest unbalance they balance; used: of it"
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
