"""What balancing found, on a terminal: cycles of the virtual machine, corrections of runs."""

from __future__ import annotations

import math
from cmath import phase
from typing import TYPE_CHECKING

import numpy as np

from ..output.table import BAD, Sheet
from ..output.terminal import console, say, show
from ..output.words import printable
from .errors import LARGE, READING_ERROR, moved_by_errors

_ROUNDING = 1e-9  # of the largest vibration measured
REPEAT = " Repeat the trial runs with a larger mass, at angles 120 deg apart."

if TYPE_CHECKING:
    from .correction import Correction
    from .cycles import BalancingReport, Cycle, Technology


def print_cycles(result: BalancingReport) -> None:
    """Coefficients and cycles of both technologies."""
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
        if technology.actually_met:
            say(f"Grade met after {len(technology.cycles)} cycles, control run included.")
        else:
            say(f"Not balanced: {technology.note}.", style=BAD)
    say(f"{result.runs} runs of the machine. FMUs loaded: {', '.join(result.units)}")


def _coefficients(result: BalancingReport) -> Sheet:
    cosimulated = ("co-simulated [1/kg]", "phase")
    columns = ("support", "plane", *cosimulated, "equations [1/kg]", "difference")
    rows = []
    for (i, j), value in np.ndenumerate(result.measured):
        exact = result.analytic[i, j]
        shown = (f"{abs(value):.6g}", f"{_degrees(value):.1f}°")
        other = (f"{abs(exact):.6g}", f"{abs(value - exact) / abs(exact):.1e}")
        rows.append((str(i + 1), str(result.planes[j]), *shown, *other))
    title = "Influence coefficients, amplitude 0-peak per unbalance (20), (22)"
    return Sheet(columns, rows, "llrrrr", title)


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
    vectors = (*cycle.amplitude, *cycle.found)
    shares = (*cycle.at_supports / result.at_supports, actual)
    return [
        *(f"{abs(v):.3g} at {_degrees(v):.1f}°" for v in vectors),
        *(f"{100.0 * s:.1f} %" for s in shares),
    ]


def print_correction(result: Correction, file: str) -> None:
    """What to mount, what is expected to remain, and whether the grade is met."""
    measured = result.measured
    say(
        f"{file}: runs: {len(measured.runs)}, readings in each: {len(measured.sensors)}, planes: "
        f"{len(measured.planes)}; condition number of the influence coefficients "
        f"{result.condition:.3g} (an error of 1 % in the readings moves the masses by up to "
        f"{result.condition:.3g} %)"
    )
    for line in _how_read(result):
        say(line)
    show(_masses(result))
    show(_readings(result))
    sizes = result.rms, float(abs(result.after).max())
    rms, largest = (f"{_size(each, result):.3g} {measured.unit}" for each in sizes)
    say(f"Expected to remain: rms {rms}, largest {largest}")
    if (grade := result.grade) is not None:
        say(
            f"{grade.name} permits {grade.permissible:.4g} kg m over all planes: "
            f"{grade.before:.4g} before, {grade.after:.2g} expected after: "
            f"G{grade.reached:.2g}, {'met' if grade.met else 'not met'}",
            style="" if grade.met else BAD,
        )
        if math.isnan(result.uncertainty[0]):
            say("The corrections' uncertainty is unknown: it needs more readings than corrections, "
                "and least squares.")  # fmt: skip


def _how_read(result: Correction) -> list[str]:
    """What was subtracted from the readings, and how well they fit where there are no phases."""
    measured, said = result.measured, []
    if measured.has_runout:
        said.append("Run-out was subtracted from every reading.")
    if result.circles is None:
        return said
    missed = float(np.sqrt(np.mean(result.circles.left**2)))
    largest = float(np.abs(result.circles.left).max())
    said.append(
        "No phases: coefficients are found from the amplitudes of the trial runs (Siebert's "
        f"construction). They miss the readings by {missed:.2g} {measured.unit} rms, "
        f"{largest:.2g} at most; leads below are counted from each sensor's initial vibration."
    )
    moved = moved_by_errors(result.circles, measured.mounted, result.exact, READING_ERROR)
    shares = moved / np.maximum(np.abs(result.exact), 1e-300)
    planes = zip(measured.planes, shares.tolist(), strict=True)
    said.append(
        f"Readings that err by {100.0 * READING_ERROR:g} % move the correction by "
        + ", ".join(f"{100.0 * share:.2g} % in plane {plane}" for plane, share in planes)
        + " (standard deviation)."
        + REPEAT * bool((shares > LARGE).any())
    )
    said += [
        f"Ambiguous: for sensor {sensor!r} and plane {plane} a second solution misses the readings "
        f"by {rms:.2g} {measured.unit} rms alone.{REPEAT}"
        for sensor, plane, rms in result.ambiguous
    ]
    return said


def _masses(result: Correction) -> Sheet:
    """What to mount, in addition to what was mounted in the first run."""
    planes, radii = result.measured.planes, result.measured.radii
    rows = []
    for j, (name, exact) in enumerate(zip(planes, result.exact.tolist(), strict=True)):
        radius = "as the trial mass" if radii is None else f"{radii[j]:.4g}"
        spread = result.uncertainty[j]
        off = "-" if math.isnan(spread) else f"{spread:.2g}"
        angle = f"{_degrees(exact) % 360.0:.1f}"
        rows.append([name, f"{abs(exact):.4g}", angle, off, radius, result.method])
        for piece in result.pieces:
            if piece.plane == name and abs(piece.mass - abs(exact)) > 1e-9 * abs(exact):
                angle = f"{math.degrees(piece.angle) % 360.0:.1f}"
                rows.append(["", f"{piece.mass:.4g}", angle, "", radius, "at an allowed angle"])
    columns = ["plane", "mass [g]", "angle [deg]", "+- [g]", "radius [mm]", ""]
    return Sheet(columns, rows, "lrrrrl", f"Mount in addition to run {result.measured.runs[0]!r}")


def _readings(result: Correction) -> Sheet:
    unit = result.measured.unit
    both = zip(result.before.tolist(), result.after.tolist(), strict=True)
    rows = [
        [
            name,
            f"{abs(b):.4g}",
            f"{_degrees(b) % 360:.1f}",
            f"{_size(abs(a), result):.3g}",
            f"{_degrees(a) % 360:.1f}" if _size(abs(a), result) else "-",
        ]
        for name, (b, a) in zip(result.measured.sensors, both, strict=True)
    ]
    columns = ["sensor", f"measured [{unit}]", "lead [deg]", f"expected [{unit}]", "lead [deg] "]
    return Sheet(columns, rows, "lrrrr", "Vibration")


def _size(amplitude: float, result: Correction) -> float:
    """An expected amplitude; 0 where it is rounding."""
    return amplitude if amplitude > _ROUNDING * float(np.abs(result.before).max()) else 0.0


def _degrees(value: complex) -> float:
    return math.degrees(phase(value))
