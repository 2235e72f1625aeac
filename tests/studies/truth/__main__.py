"""Command: draw random scenes, run them as they are, and count how many are right.

python -m tests.studies.truth --family planar=3000 --family heavy=500 [--seed 2] [--first 100]
    [--separate] [--tolerance 1e-5] [--markdown FILE]
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated, Any

import typer

from autobalancer.harness.output.terminal import progress_bar, say
from tests.studies.truth.draw import FAMILIES
from tests.studies.truth.study import line, misses, table, verdicts

EACH = 10  # scenes of every family, where none is named


def command(
    family: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=N", help=f"Only these: {', '.join(FAMILIES)}."),
    ] = None,
    seed: Annotated[int, typer.Option(help="Another seed draws other scenes.")] = 1,
    first: Annotated[
        int, typer.Option(min=0, help="Number of the first scene, to go on after another study.")
    ] = 0,
    tolerance: Annotated[
        float | None, typer.Option(help="Of every run, instead of the default coupling.")
    ] = None,
    separate: Annotated[
        bool, typer.Option("--separate", help="Judge separate FMUs, not the one file.")
    ] = False,
    markdown: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Also write the table to a file.")
    ] = None,
    workers: Annotated[int, typer.Option(min=1, help="Processes.")] = os.cpu_count() or 1,
) -> None:
    """Random scenes against an independent integration."""
    changes = {} if tolerance is None else {"coupling.tolerance": tolerance}
    options: dict[str, Any] = {"changes": changes, "separate": separate, "first": first}
    with progress_bar("random scenes") as progress:
        found = verdicts(counts(family), seed, workers, progress, **options)
    for verdict in misses(found):
        say(line(verdict))
    text = table(found).markdown()
    say(f"\n{text}")
    if markdown is not None:
        markdown.write_text(f"{text}\n", encoding="utf-8")


def counts(families: list[str] | None) -> dict[str, int]:
    """How many scenes of each family.

    Raises:
        typer.BadParameter: there is no such family, or a number is none.
    """
    found = dict.fromkeys(FAMILIES, EACH) if not families else {}
    for text in families or ():
        name, _, number = text.partition("=")
        if name not in FAMILIES or not (number.isdecimal() and int(number) > 0):
            known = ", ".join(FAMILIES)
            raise typer.BadParameter(f"family {text!r}: must be NAME=N, with NAME one of {known}")
        found[name] = int(number)
    return found


if __name__ == "__main__":
    typer.run(command)
