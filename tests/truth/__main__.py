"""Command: draw random scenes, run them as they are, and count how many are right.

python -m tests.truth --n 1000 --seed 1 [--verify] [--one-file] [--save DIR]
python -m tests.truth --family planar=3000 --family heavy=500
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from autobalancer.harness.errors import UserError
from autobalancer.harness.output import options
from autobalancer.harness.output.cluster import who_works
from autobalancer.harness.output.commands import Commands, execute
from autobalancer.harness.output.files import write_whole
from autobalancer.harness.output.interrupts import answer_signals
from autobalancer.harness.output.store import refuse_store
from autobalancer.harness.output.terminal import progress_bar, ready_to_write, say
from tests.truth.draw import FAMILIES
from tests.truth.store import Verdicts
from tests.truth.study import Study, every, line, misses, save, table, verdicts
from tests.truth.study import kept as tolerance_kept

SHARES = {"planar": 3}  # of the scenes; of every other family one


def _ready(path: Path | None) -> Path | None:
    refuse_store(path) if options.is_store(path) else ready_to_write(path)
    return path


def command(
    n: Annotated[int, typer.Option("--n", min=1, help="Scenes in all, or of a --family.")] = 200,
    seed: Annotated[int, typer.Option(help="Another seed draws other scenes.")] = 1,
    family: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME[=N]", help=f"Only these: {', '.join(FAMILIES)}."),
    ] = None,
    tolerance: Annotated[
        float | None, typer.Option(help="Asked of every run, instead of the default coupling.")
    ] = None,
    verify: Annotated[
        bool, typer.Option("--verify", help="Judge the errors that runs measure themselves, too.")
    ] = False,
    separate: Annotated[
        bool, typer.Option("--separate", help="Judge separate FMUs, not the coupling in C.")
    ] = False,
    save_to: Annotated[
        Path | None, typer.Option("--save", metavar="DIR", help="Keep the scenes that went wrong.")
    ] = None,
    markdown: Annotated[Path | None, options.markdown("the table")] = None,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help="Every verdict as CSV; or in FILE.zarr as it comes: the same command goes on "
            "where it was ended.",
            callback=_ready,
        ),
    ] = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes.")] = None,
    cluster: Annotated[str | None, options.CLUSTER] = None,
) -> None:
    """Random scenes against an independent integration."""
    changes = () if tolerance is None else (("coupling.tolerance", tolerance),)
    try:
        study = Study(counts(family, n), seed, changes, verify, separate)
    except ValueError as error:
        raise UserError(str(error)) from None
    kept = Verdicts(output, study) if options.is_store(output) else None
    with progress_bar("random scenes") as progress, who_works(cluster) as executor:
        found = verdicts(study, workers or executor, progress, kept)
    for verdict in misses(found):
        say(line(verdict))
    text = table(found).markdown()
    if separate:
        text += "\n\nRun on separate FMUs."
    if tolerance is not None:
        text += f"\n\n{tolerance_kept(found, tolerance)}"
    say(f"\n{text}")
    if markdown is not None:
        with write_whole(markdown) as stream:
            stream.write(f"{text}\n")
    if output is not None:
        say(f"Verdicts: {output if kept else every(found).write_csv(output)}")
    if save_to is not None:
        say(f"{len(save(study, found, save_to))} scenes written to {save_to}")


def counts(families: list[str] | None, n: int) -> dict[str, int]:
    """How many scenes of each family: shares of `n`, or what `NAME=N` says of those named.

    Raises:
        ValueError: a number is none.
    """
    if not families:
        shares = {name: SHARES.get(name, 1) for name in FAMILIES}
        return {name: max(1, n * share // sum(shares.values())) for name, share in shares.items()}
    found = {}
    for text in families:
        name, equals, number = text.partition("=")
        if equals and not (number.isdecimal() and int(number) > 0):
            raise ValueError(f"family {text!r}: must be NAME or NAME=N with N of 1 or more")
        found[name] = int(number) if equals else n
    return found


if __name__ == "__main__":
    app = typer.Typer(cls=Commands, add_completion=False, pretty_exceptions_enable=False)
    app.callback(invoke_without_command=True)(command)
    answer_signals()
    execute(app)
