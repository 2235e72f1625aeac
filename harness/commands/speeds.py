"""`autobalancer speeds`: critical speeds by several methods side by side."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ...models.readable import written_apart
from ..errors import UserError
from ..output import options
from ..output.files import write_json
from ..output.table import GOOD, Sheet
from ..output.terminal import progress_bar, say, show
from ..stability.methods import DEFAULT_METHODS
from ..units import engineering, engineers, in_both
from .changes import changed_scene, set_option

if TYPE_CHECKING:
    from ...models.linear.regions import Crossing
    from ..stability.proved import Proof
    from ..stability.speeds import Speeds
    from ..stability.whirl import Whirls

DEFAULT = ",".join(DEFAULT_METHODS)
HEADS = {"criterion": "criterion, a rule"}  # what the other methods compute, it approximates
_COLOURS = {"stable": GOOD, "unstable": "red", "undecided": "yellow", "neutral": "yellow"}


def command(
    scene: Annotated[str, options.SCENE],
    range_: Annotated[tuple[str, str] | None, options.RANGE_OR_DEFAULT] = None,
    method: Annotated[
        str,
        typer.Option(help="criterion, floquet, cosim, proved; several with commas."),
    ] = DEFAULT,
    json_file: Annotated[Path | None, options.json("the speeds")] = None,
    narrowest: Annotated[
        float | None,
        options.quantity(
            "rad/s",
            "Width of the narrowest band to find [rad/s]; default: range/1000, with cosim only "
            "range/60. With --method proved: width of undecided bands.",
            "--narrowest",
        ),
    ] = None,
    within: Annotated[
        str, typer.Option(metavar="PATH=5%,...", help="Tolerances for --method proved.")
    ] = "",
    changes: Annotated[list[str] | None, set_option("rotor.mass=3.0")] = None,
) -> None:
    """Find the speeds at which balancing begins or ends."""
    from ..stability.boundaries import METHODS, default_range

    if narrowest is not None and not narrowest > 0.0:
        raise UserError(f"--narrowest {narrowest:g} rad/s: must be positive")
    names = [name.strip() for name in method.split(",") if name.strip()]
    if not names:
        raise UserError(f"--method {method!r}: name at least one of {', '.join(METHODS)}")
    loaded = changed_scene(scene, changes)
    low, high = options.speed_range(range_) if range_ else default_range(loaded)
    if not range_:
        say(f"range: {low:.4g} to {high:.4g} rad/s; --range LOW HIGH for another")
    with progress_bar(f"critical speeds of {loaded.name}") as progress:
        result = loaded.speeds(
            low,
            high,
            names,
            narrowest=narrowest,
            progress=progress,
            within=within,
        )
    if result.methods:
        show(table(result, loaded.heading))
    if result.proof is not None:
        show(bands_table(result.proof, loaded.heading))
        for line in result.proof.lines():
            say(f"proved: {line}")
    for name, side in result.lowest.items():
        throughout = "" if result.methods[name] else ", and up to its end"
        say(f"{name}: {side} at the low end of the range{throughout}")
    for line in result.unknown():
        say(line, style="yellow")
    if "criterion" in result.methods:
        say("criterion: a rule, fast and approximate: it leaves out mass and drag of the weights")
    for name, reason in result.refused.items():
        say(f"{name}: no answer: {reason}", style="yellow")
    if result.whirl is not None:
        for line in result.whirl.lines():
            say(line)
        if result.whirl.at:
            show(whirl_table(result.whirl))
    if "cosim" in result.methods:
        say(f"cosim: {_looked(result, narrowest)}")
    if result.captured is not None:
        say(result.captured.sentence())
    if result.supports:
        say(result.supports)
    if json_file is not None:
        write_json(result.as_json(), json_file)


def table(result: Speeds, title: str) -> Sheet:
    """Crossings by method; what the methods hold for the same one stands in one row."""
    low, high = result.range
    pair = {"floquet", "cosim"}
    both = pair <= result.methods.keys()
    columns = ["", "above it", *(f"{HEADS.get(name, name)} [rad/s]" for name in result.methods)]
    columns += ["cosim - floquet"] * both
    rows = []
    for number, row in enumerate(result.rows(), start=1):
        cells = [_known(row[name]) if name in row else "-" for name in result.methods]
        if both:
            met = pair <= row.keys()
            cells.append(f"{row['cosim'].speed - row['floquet'].speed:.1e}" if met else "-")
        first = next(iter(row.values()))
        cells += [] if engineering.get() else [engineers(first.speed, "rad/s")]
        rows.append([str(number), first.above, *cells])
    columns += [] if engineering.get() else ["that is"]
    span = f"{in_both(low, 'rad/s')} to {in_both(high, 'rad/s')}"
    heading = f"{title}: critical speeds from {span}"
    colours = {"above it": _COLOURS}
    return Sheet(columns, rows, "ll" + "r" * (len(columns) - 2), heading, colours)


def _known(crossing: Crossing) -> str:
    """A speed with the digits that its error leaves."""
    digits = 8
    if crossing.error > 0.0:
        digits = math.floor(math.log10(crossing.speed / crossing.error)) + 1
    return f"{crossing.speed:.{min(max(digits, 3), 8)}g}"


def bands_table(proof: Proof, title: str) -> Sheet:
    """Proved bands."""
    columns = ["from [rad/s]", "to [rad/s]", "proved"]
    rows = [[f"{b.low:.10g}", f"{b.high:.10g}", b.state] for b in proof.bands]
    if not engineering.get():
        columns.append("that is")
        for row, b in zip(rows, proof.bands, strict=True):
            ends = written_apart(lambda v, n: engineers(v, "rad/s", n), b.low, b.high, 4)
            row.append(" to ".join(ends))
    machines = f"for every machine within {proof.within}" if proof.within else "for this machine"
    colours = {"proved": _COLOURS}
    aligned = "rrl" + "l" * (len(columns) - 3)
    return Sheet(columns, rows, aligned, f"{title}: proved {machines}", colours)


def whirl_table(whirl: Whirls) -> Sheet:
    """What runs leave at each speed."""
    stations = [f"station {n} [mm]" for n in range(1, len(whirl.at[0].amplitude) + 1)]
    rows = [
        [
            f"{one.speed:.6g}",
            "failed" if one.failure else "settled" if one.stable else "not settled",
            *(f"{1e3 * a:.4g}" for a in one.amplitude),
            ", ".join(f"{math.degrees(angle):.1f}" for angle in one.angles),
        ]
        for one in whirl.at
    ]
    colours = {"run": {"settled": GOOD, "failed": "red"}}
    columns = ["speed [rad/s]", "run", *stations, "weights at [deg]"]
    title = "What remains: largest distance from the middle, 0-peak"
    return Sheet(columns, rows, "rl" + "r" * (len(columns) - 2), title, colours)


def _looked(result: Speeds, narrowest: float | None) -> str:
    from ..stability.boundaries import intervals_of_scan

    if "floquet" in result.methods:
        return "looked on both sides of every speed of Floquet, between them and at the ends"
    low, high = result.range
    width = (high - low) / intervals_of_scan(result.range, narrowest)
    return f"scanned by itself: bands narrower than {width:.3g} rad/s can be missed"
