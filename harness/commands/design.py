"""`autobalancer design`: how many weights, and how large."""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ...models.readable import rounded
from ..design.space import MATERIALS
from ..errors import MOST_STARTS, UserError
from ..output import options
from ..output.table import Sheet
from ..output.terminal import progress_bar, say, show
from ..units import in_both, shown_in
from .changes import changed_scene, set_option

if TYPE_CHECKING:
    from ..api.scene import Scene
    from ..design.choices import Choice, Design
    from ..design.fitting import Fitting
    from ..output.report import Report

STARTS = 40  # at each end of drag and unbalance
DETAILS_STARTS = 200  # of `Scene.settling`
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
    reserve: Annotated[
        float, options.number("Ratio of capacity to largest unbalance.", "--reserve")
    ] = 1.0,
    starts: Annotated[
        str,
        typer.Option(help="run-up, rest, or turning (the friendliest); or their number."),
    ] = "run-up",
    n: Annotated[
        int, options.whole("Starts at each end of drag and unbalance", "-n", most=MOST_STARTS)
    ] = STARTS,
    run_up: Annotated[
        float | None,
        options.quantity(
            "s", "Time from standstill to full speed [s]; default: the scene's.", "--run-up"
        ),
    ] = None,
    drag: Annotated[
        str | None,
        typer.Option(metavar="[LOW..]HIGH", help="Drag of every weight, N s/m; measured."),
    ] = None,
    oil: Annotated[str | None, typer.Option(help='Bounds the drag: "ISO VG 46".')] = None,
    clearance: Annotated[
        float, options.quantity("m", "Of the width that stays free, m.", "--clearance")
    ] = 0.0,
    standard: Annotated[
        bool, typer.Option("--standard", help="Only standard diameters of balls.")
    ] = False,
    most: Annotated[
        int, options.whole("Largest number to compare", "--most", least=2, most=64)
    ] = 8,
    output: Annotated[
        Path | None, options.picture("Picture (png, svg, pdf).", "--output", "-o")
    ] = None,
    save: Annotated[
        Path | None,
        options.output(".toml", "Scene with the recommended weights, at the smallest drag tried."),
    ] = None,
    changes: Annotated[list[str] | None, set_option("balls.drag=0.1")] = None,
    report: Annotated[Path | None, options.REPORT] = None,
    details: Annotated[
        bool,
        typer.Option(
            "--details", help="Instead: settling times from turning starts, beside Goncharov."
        ),
    ] = False,
) -> None:
    """Choose balls or rollers for a rotor, or none."""
    from ..output.report import Report

    loaded = changed_scene(scene, changes)
    page = Report(report, f"Design: {loaded.heading}", [loaded])
    number = int(starts) if starts.isdecimal() else None
    space: dict[str, Any] = {"race": race, "width": width, "material": material}
    space |= {"reserve": reserve, "most": most, "workers": os.cpu_count() or 1}
    if details:
        _refuse_beside_details(
            {"--save": save, "--run-up": run_up, "--drag": drag, "--oil": oil,
             "--clearance": clearance, "--standard": standard, "-n": n != STARTS,
             "--starts rest": starts == "rest"}
        )  # fmt: skip
        count = DETAILS_STARTS if number is None else number
        _details(loaded, unbalance, space, count, page, output)
        return
    if number is not None:
        starts, n = "run-up", number
    with progress_bar(f"designing for {loaded.name}") as progress:
        data = loaded.design(
            unbalance, start=starts, n=n, run_up=run_up, drag=drag, oil=oil,
            clearance=clearance, standard=standard, progress=progress, **space,
        )  # fmt: skip
    with page.keeping():
        show(candidates_table(data))
        for line in data.words():
            say(line)
    if save is not None:
        found = data.scene()
        say(f"Scene: {found.save(save)}" if found else f"{save}: not written, none is recommended")
    for path in filter(None, (output, page.picture(f"{loaded.name}_design"))):
        say(f"Picture: {data.plot(path)}")
    page.cited = "ISO 3290" if standard else ""
    page.write()


def _refuse_beside_details(given: dict[str, Any]) -> None:
    """Raise UserError for options, by name, that `--details` does not ask for."""
    if unfit := [option for option, value in given.items() if value]:
        raise UserError(
            f"{', '.join(unfit)}: not with --details, which compares turning starts of the largest "
            "weights that fit, at the scene's drag, and recommends no size; leave one of them out"
        )


def candidates_table(data: Fitting) -> Sheet:
    """One line for every candidate."""
    unit, factor = shown_in("kg m")
    columns = (
        "n", "diameter mm", "mass g", f"holds {unit}", "balances", "95 %", "drag/limit",
        "peak/none", "left/none", "settles s",
    )  # fmt: skip
    rows = []
    for one in data.trials:
        c, (low, high) = one.candidate, one.interval
        size = (str(c.count), f"{2e3 * c.radius:.4g}", f"{1e3 * one.total:.4g}")
        share = f"{one.worst.balanced}/{one.worst.of}"
        rows.append(
            [
                *size, rounded(factor * c.capacity), share, f"{100 * low:.0f}-{100 * high:.0f}",
                *map(_number, (one.margin, one.peak_ratio, one.left, one.settling)),
            ]
        )  # fmt: skip
    title = f"{data.title}: {data.kind} in a race of {1e3 * data.space.race:.4g} mm\n"
    title += "each in its worst corner of drag and unbalance; peak, left: vibration over that "
    title += "without; drag/limit: above 1 none can be left behind"
    return Sheet(columns, rows, "r" * len(columns), title)


def _number(value: float) -> str:
    return f"{value:.3g}" if math.isfinite(value) else "-"


def _details(
    scene: Scene,
    unbalance: str | None,
    space: dict[str, Any],
    starts: int,
    page: Report,
    output: Path | None,
) -> None:
    """Settling times from turning starts beside Goncharov's theory."""
    from ..design.recommendation import left_behind, words
    from ..design.scenes import ASSUMED_RATE

    with progress_bar(f"settling times of {scene.name}") as progress:
        data = scene.settling(unbalance, starts=starts, progress=progress, **space)
    with page.keeping():
        show(table(data, starts))
        show(details_table(data))
        say("Starts: weights turn with the rotor at its speed, the friendliest start.")
        for line in filter(None, (*words(data), left_behind(data))):
            say(line)
        if not scene.balancer:
            rate = ASSUMED_RATE * scene.profile().end
            say(f"Drag is ASSUMED: a ball loses its speed within {1.0 / rate:.3g} s. {MEASURE}")
    for path in filter(None, (output, page.picture(f"{scene.name}_design"))):
        say(f"Picture: {data.plot(path, theory=True)}")
    page.cited = "Goncharov 2017"
    page.write()


def table(data: Design, starts: int) -> Sheet:
    """One line for every number of weights."""
    unit, factor = shown_in("kg m")
    columns = ("n", "diameter mm", "mass kg", f"holds {unit}", "used", "settle s (95 %)", "settled")
    rows = []
    for c in data.choices:
        size = (str(c.count), f"{2e3 * c.radius:.4g}", f"{c.count * c.mass:.4g}")
        used = f"{100.0 * data.unbalance / c.capacity:.0f} %"
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
    late = f"not within {rounded(choice.seconds, 3)} s"
    if math.isinf(choice.median):
        return late
    high = f"-{rounded(choice.high, 2)}" if math.isfinite(choice.high) else f" to {late}"
    return f"{rounded(choice.median, 3)} ({rounded(choice.low, 2)}{high})"


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
    return rounded(seconds, 3) if math.isfinite(seconds) else never
