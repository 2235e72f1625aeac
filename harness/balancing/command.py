"""`autobalancer balance`: a scene's rotor on the virtual balancing machine, or measured runs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..errors import UserError
from ..output import costs, options
from ..output.files import write_json
from ..output.table import Sheet
from ..output.terminal import console, progress_bar, say, show
from ..output.words import printable
from ..scene.changes import changed_scene

if TYPE_CHECKING:
    from .cycles import BalancingReport, Cycle, Technology


def command(
    scene: Annotated[
        str,
        typer.Argument(
            metavar="SCENE", help="Scene with a table [balancing]; or FILE.csv: measured runs."
        ),
    ],
    output: Annotated[
        Path | None, options.picture("Draw the corrections.", "--output", "-o")
    ] = None,
    json_file: Annotated[Path | None, options.json("all")] = None,
    changes: Annotated[list[str] | None, options.changes("balancing.grade=G1")] = None,
    at_most: Annotated[str, options.AT_MOST] = costs.DEFAULT,
    correct: Annotated[
        str | None, typer.Option(metavar="RUN", help="Measured run to correct; default: the first.")
    ] = None,
    angles: Annotated[
        str | None,
        typer.Option(help="Where masses fit: 12 (evenly) or 0,30,75 (deg); planes parted by /."),
    ] = None,
    min_max: Annotated[
        bool, typer.Option("--min-max", help="Make the largest reading least, not the squares.")
    ] = False,
    largest_mass: Annotated[
        str | None, typer.Option(help="Grams that a plane takes: 5, or 5,8 one a plane.")
    ] = None,
    grade: Annotated[str | None, typer.Option(help="Of ISO 21940-11, for measured runs.")] = None,
    mass: Annotated[
        float | None, options.quantity("kg", "Of the rotor, kg, for --grade.", "--mass")
    ] = None,
    service_speed: Annotated[
        float | None,
        options.quantity(
            "rad/s", "For --grade, rad/s; default: the fastest one measured.", "--service-speed"
        ),
    ] = None,
    report: Annotated[Path | None, options.REPORT] = None,
) -> None:
    """Find correction masses, on a virtual machine or from runs.

    Exit code 1 if the grade is not met.
    """
    given = {
        "--correct": correct,
        "--angles": angles,
        "--min-max": min_max or None,
        "--largest-mass": largest_mass,
        "--grade": grade,
        "--mass": mass,
        "--service-speed": service_speed,
    }
    if scene.endswith(options.TABLE):
        from .measured_command import balance_measured

        if changes:
            raise UserError("--set: belongs to a scene; measured runs have nothing to replace")
        balance_measured(Path(scene), given, output, json_file, report)
        return
    if unfit := [name for name, value in given.items() if value is not None]:
        raise UserError(f"{', '.join(unfit)}: belong to measured runs (FILE.csv), not to a scene")
    from ..output.report import Report

    loaded = changed_scene(scene, changes)
    page = Report(report, f"Balancing: {loaded.heading}", [loaded])
    with (
        costs.limited(at_most, "balancing.revolutions"),
        progress_bar(f"balancing {loaded.name}") as progress,
    ):
        result = loaded.balance(progress=progress)
    with page.keeping():
        _print(result)
    for path in filter(None, (output, page.picture(f"{loaded.name}_balance"))):
        say(f"Picture: {result.plot(path)}")
    page.cited = "Polushkin 2016; ISO 21940-11"
    page.write()
    if json_file is not None:
        write_json(result.as_json(), json_file)
    if not result.met:
        raise typer.Exit(1)


def _print(result: BalancingReport) -> None:
    from rich.markup import escape

    console().print(escape(printable(result.title)), style="bold")
    shares = ", ".join(f"{share:.4g}" for share in result.at_supports)
    say(
        f"{result.grade} permits {result.permissible:.4g} kg m, {shares} kg m at the supports; "
        f"trial unbalance {result.trial:.4g} kg m; machine at {result.speed:g} rad/s"
    )
    show(_coefficients(result))
    for technology in result.technologies:
        show(_cycles(result, technology))
        say(_verdict(technology), style="" if technology.actually_met else "bold red")
    say(f"{result.runs} runs of the machine. FMUs loaded: {', '.join(result.units)}")


def _coefficients(result: BalancingReport) -> Sheet:
    from numpy import ndenumerate

    measured = ("measured [1/kg]", "phase", "uncertainty")
    columns = ("support", "plane", *measured, "equations [1/kg]", "difference")
    rows = []
    for (i, j), value in ndenumerate(result.measured):
        exact, spread = result.analytic[i, j], result.uncertainty[i, j]
        shown = (f"{abs(value):.6g}", _degrees(value), f"{spread:.1e}")
        other = (f"{abs(exact):.6g}", f"{abs(value - exact) / abs(exact):.1e}")
        rows.append((str(i + 1), str(result.planes[j]), *shown, *other))
    title = "Influence coefficients, amplitude 0-peak per unbalance (20), (22)"
    return Sheet(columns, rows, "llrrrrr", title)


def _cycles(result: BalancingReport, technology: Technology) -> Sheet:
    sensors = range(1, len(result.at_supports) + 1)
    unbalances = [f"plane {plane} [kg m]" for plane in result.planes]
    residuals = [*(f"residual at {s}" for s in sensors), "actually"]
    columns = ["cycle", *(f"support {s} [m]" for s in sensors), *unbalances, *residuals]
    rows = [[str(n), *_row(result, cycle)] for n, cycle in enumerate(technology.cycles, start=1)]
    title = (
        f"{technology.name.capitalize()} coefficients: amplitude 0-peak at the supports [m], "
        "unbalance found in the planes [kg m], residual in parts of what is permissible"
    )
    return Sheet(columns, rows, "r" * len(columns), title)


def _row(result: BalancingReport, cycle: Cycle) -> list[str]:
    actual = (cycle.actual_at_supports / result.at_supports).max()
    vectors = (*cycle.reading.amplitude, *cycle.found)
    shares = (*cycle.at_supports / result.at_supports, actual)
    return [*(f"{abs(v):.3g} at {_degrees(v)}" for v in vectors), *(f"{s:.1%}" for s in shares)]


def _verdict(technology: Technology) -> str:
    count = len(technology.cycles)
    if technology.actually_met:
        return f"Grade met after {count} cycles, control run included."
    return f"Not balanced: {technology.note}."


def _degrees(value: complex) -> str:
    from cmath import phase
    from math import degrees

    return f"{degrees(phase(value)):.1f}°"
