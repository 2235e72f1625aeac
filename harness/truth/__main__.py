"""Command: draw random scenes, run them as they are, and count how many are right.

python -m autobalancer.harness.truth --n 1000 --seed 1 [--save DIR]
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from ..errors import UserError
from ..output.terminal import progress_bar, say
from .draw import FAMILIES
from .study import Study, kept, line, misses, save, table, verdicts

SHARES = {"planar": 3, "run_up": 1, "two_support": 1, "flexible": 1, "liquid": 1, "heavy": 1}


def command(
    n: Annotated[int, typer.Option("--n", min=1, help="Scenes in all, or of each --family.")] = 200,
    seed: Annotated[int, typer.Option(help="Another seed draws other scenes.")] = 1,
    family: Annotated[
        list[str] | None, typer.Option(help=f"Only these: {', '.join(FAMILIES)}.")
    ] = None,
    tolerance: Annotated[
        float | None, typer.Option(help="Asked of every run, instead of the default coupling.")
    ] = None,
    save_to: Annotated[
        Path | None, typer.Option("--save", metavar="DIR", help="Keep the scenes that went wrong.")
    ] = None,
    workers: Annotated[int, typer.Option(min=1)] = os.cpu_count() or 1,
) -> None:
    """Random scenes against an independent integration."""
    if family:
        counts = dict.fromkeys(family, n)
    else:
        total = sum(SHARES.values())
        counts = {name: max(1, n * share // total) for name, share in SHARES.items()}
    changes = () if tolerance is None else (("coupling.tolerance", tolerance),)
    try:
        study = Study(counts, seed, changes)
    except ValueError as error:
        raise UserError(str(error)) from None
    with progress_bar("random scenes") as progress:
        found = verdicts(study, workers, progress)
    for verdict in misses(found):
        say(line(verdict))
    say("")
    say(table(found))
    if tolerance is not None:
        say(kept(found, tolerance))
    if save_to is not None:
        say(f"{len(save(study, found, save_to))} scenes written to {save_to}")


if __name__ == "__main__":
    typer.run(command)
