"""Command: draw random scenes, run them as they are, and count how many are right.

python -m autobalancer.harness.truth --n 1000 --seed 1 [--verify] [--save DIR]
python -m autobalancer.harness.truth --family planar=3000 --family heavy=500
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from ..errors import UserError
from ..output import options
from ..output.files import write_whole
from ..output.terminal import progress_bar, say
from .draw import FAMILIES
from .study import Study, every, kept, line, misses, save, table, verdicts

SHARES = {"planar": 3}  # of the scenes; of every other family one


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
        bool, typer.Option("--verify", help="Are the errors right that runs measure themselves?")
    ] = False,
    save_to: Annotated[
        Path | None, typer.Option("--save", metavar="DIR", help="Keep the scenes that went wrong.")
    ] = None,
    markdown: Annotated[Path | None, options.markdown("the table")] = None,
    output: Annotated[
        Path | None, options.output(".csv", "Write every verdict as CSV.", "--output", "-o")
    ] = None,
    workers: Annotated[int, typer.Option(min=1)] = os.cpu_count() or 1,
) -> None:
    """Random scenes against an independent integration."""
    changes = () if tolerance is None else (("coupling.tolerance", tolerance),)
    try:
        study = Study(counts(family, n), seed, changes, verify)
    except ValueError as error:
        raise UserError(str(error)) from None
    with progress_bar("random scenes") as progress:
        found = verdicts(study, workers, progress)
    for verdict in misses(found):
        say(line(verdict))
    text = table(found).markdown()
    if tolerance is not None:
        text += f"\n\n{kept(found, tolerance)}"
    say(f"\n{text}")
    if markdown is not None:
        with write_whole(markdown) as stream:
            stream.write(f"{text}\n")
    if output is not None:
        say(f"Verdicts: {every(found).write_csv(output)}")
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
    typer.run(command)
