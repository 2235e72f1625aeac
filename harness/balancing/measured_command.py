"""`autobalancer balance FILE.csv`: corrections from measured runs, in words, JSON and a picture."""

from __future__ import annotations

import math
from cmath import phase
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import typer

from ..errors import UserError
from ..output.files import write_json
from ..output.table import BAD, Sheet
from ..output.terminal import say, show

if TYPE_CHECKING:
    from .correction import Correction

_MOST_ANGLES = 1000


def balance_measured(
    path: Path,
    given: Mapping[str, Any],
    output: Path | None,
    json_file: Path | None,
    report: Path | None,
) -> None:
    """Find the corrections for a CSV file of measured runs, and print them.

    Args:
        given: the command's options by their names.

    Raises:
        UserError: as `read_measured` and `correct`.
        typer.Exit: the grade is not expected to be met.
    """
    from ..output.report import Report
    from .correction import correct

    for name in ("--mass", "--service-speed"):
        value = given[name]
        if value is not None and not 0.0 < value < math.inf:
            raise UserError(f"{name} {value:g}: must be a finite number above 0")
    result = correct(
        path,
        run=given["--correct"],
        angles=allowed_angles(given["--angles"]),
        grade=given["--grade"] or "",
        mass=given["--mass"],
        service_speed=given["--service-speed"],
        min_max=bool(given["--min-max"]),
        largest=_masses_allowed(given["--largest-mass"]),
    )
    page = Report(report, f"Balancing: {path.name}", [])
    with page.keeping():
        _print(result, path)
    for picture in filter(None, (output, page.picture(f"{path.stem}_balance"))):
        say(f"Picture: {result.plot(picture)}")
    page.cited = "Feese & Grazier 2004; ISO 21940-11"
    page.write()
    if json_file is not None:
        write_json(result.as_json(), json_file)
    if result.grade is not None and not result.grade.met:
        raise typer.Exit(1)


def allowed_angles(text: str | None) -> list[list[float]]:
    """Angles [rad] by plane: `12` is every 30 degrees from 0, `0,30,75` these; `/` parts planes.

    Raises:
        UserError: it is not written like that.
    """
    lists = []
    for part in text.split("/") if text is not None else ():
        try:
            numbers = [float(each) for each in part.split(",")]
        except ValueError:
            numbers = [math.nan]
        if len(numbers) == 1 and numbers[0] in range(1, _MOST_ANGLES + 1):
            numbers = [360.0 * k / numbers[0] for k in range(int(numbers[0]))]
        elif len(numbers) == 1 or not all(map(math.isfinite, numbers)):
            raise UserError(
                f"--angles {text}: must be a number of even places, 1 to {_MOST_ANGLES}, or angles "
                "in degrees with commas; lists for the planes are parted by /"
            )
        lists.append([math.radians(each) for each in numbers])
    return lists


def _masses_allowed(text: str | None) -> list[float]:
    """Largest masses [g]: one, or one a plane with commas.

    Raises:
        UserError: they are not numbers above 0.
    """
    try:
        masses = [float(each) for each in text.split(",")] if text is not None else []
    except ValueError:
        masses = [math.nan]
    if not all(0.0 < mass < math.inf for mass in masses):
        raise UserError(f"--largest-mass {text}: must be grams above 0, one or one a plane: 5,8")
    return masses


def _print(result: Correction, path: Path) -> None:
    measured = result.measured
    say(
        f"{path.name}: {len(measured.runs)} runs, {len(measured.sensors)} readings each, "
        f"{len(measured.planes)} planes; condition number of the influence coefficients "
        f"{result.condition:.3g}: the masses are off by up to that many times what readings are"
    )
    show(_masses(result))
    show(_readings(result))
    unit = f" {measured.unit}" if measured.unit else ""
    largest = float(np.abs(result.after).max())
    say(f"Expected to remain: rms {result.rms:.3g}{unit}, largest {largest:.3g}{unit}")
    if (grade := result.grade) is not None:
        say(
            f"{grade.name} permits {grade.permissible:.4g} kg m over all planes: "
            f"{grade.before:.4g} before, {grade.after:.2g} expected after: "
            f"G{grade.reached:.2g}, {'met' if grade.met else 'not met'}",
            style="" if grade.met else BAD,
        )
        if math.isnan(result.uncertainty[0]):
            say("Nothing is known of the corrections' uncertainty: it needs more readings than "
                "corrections, and least squares of any mass.")  # fmt: skip


def _masses(result: Correction) -> Sheet:
    """What to mount, in addition to what was mounted in the run that is corrected."""
    planes, radii = result.measured.planes, result.measured.radii
    rows = []
    for j, (name, exact) in enumerate(zip(planes, result.exact.tolist(), strict=True)):
        radius = "as the trial mass" if radii is None else f"{radii[j]:.4g}"
        spread = result.uncertainty[j]
        off = "-" if math.isnan(spread) else f"{spread:.2g}"
        rows.append([name, f"{abs(exact):.4g}", _degrees(exact), off, radius, result.method])
        for piece in result.pieces:
            if piece.plane == j and abs(piece.mass - abs(exact)) > 1e-9 * abs(exact):
                angle = f"{math.degrees(piece.angle) % 360.0:.1f}"
                rows.append(["", f"{piece.mass:.4g}", angle, "", radius, "at an allowed angle"])
    columns = ["plane", "mass [g]", "angle [deg]", "+- [g]", "radius [mm]", ""]
    return Sheet(columns, rows, "lrrrrl", f"Mount in addition to run {result.corrected!r}")


def _readings(result: Correction) -> Sheet:
    unit = f" [{result.measured.unit}]" if result.measured.unit else ""
    rows = [
        [name, f"{abs(b):.4g}", _degrees(b), f"{abs(a):.3g}", _degrees(a)]
        for name, b, a in zip(
            result.measured.sensors, result.before.tolist(), result.after.tolist(), strict=True
        )
    ]
    columns = ["sensor", f"measured{unit}", "lead [deg]", f"expected{unit}", "lead [deg] "]
    return Sheet(columns, rows, "lrrrr", "Vibration")


def _degrees(value: complex) -> str:
    return f"{math.degrees(phase(value)) % 360.0:.1f}"
