"""`autobalancer motions`: every steady motion that starts of a machine end in, and how often."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..errors import MOST_STARTS, UserError
from ..output import options
from ..output.files import write_json
from ..output.terminal import progress_bar, say, show
from ..units import si_number
from .changes import changed_scene, set_option

MOST_SPEEDS = 1000


def command(
    scene: Annotated[str, options.SCENE],
    speeds: Annotated[
        tuple[str, str, str] | None,
        typer.Option(
            metavar="LOW HIGH N",
            help="N speeds [rad/s], or with units: 300rpm 3000rpm 9; default: the scene's.",
        ),
    ] = None,
    starts: Annotated[
        str, typer.Option(help="rest, turning, run-up; several with commas.")
    ] = "rest,turning,run-up",
    n: Annotated[int, options.whole("Random starts of each kind", "-n", most=MOST_STARTS)] = 100,
    seed: Annotated[
        int, options.whole("The same seed draws the same starts", "--seed", least=0)
    ] = 1,
    sweep: Annotated[
        bool, typer.Option("--sweep", help="Raise and lower the speed slowly instead.")
    ] = False,
    store: Annotated[Path | None, options.store()] = None,
    plot: Annotated[Path | None, options.picture("Shares over speed, or the sweep.")] = None,
    json_file: Annotated[Path | None, options.json("everything")] = None,
    cluster: Annotated[str | None, options.CLUSTER] = None,
    changes: Annotated[list[str] | None, set_option("balls.drag=0.1")] = None,
) -> None:
    """Find every steady motion, and how many starts end in it."""
    from ..output.cluster import who_works

    loaded = changed_scene(scene, changes)
    wanted = None if speeds is None else _speeds(*speeds)
    if sweep:
        if wanted is None or len(wanted) < 2:
            raise UserError("--sweep: give also --speeds LOW HIGH N, between which the speed moves")
        if store is not None:
            raise UserError(
                "--store: --sweep is two runs and keeps no store; leave one of them out"
            )
        swept = loaded.sweep(wanted[0], wanted[-1], seed=seed)
        say(swept.sentence())
        if plot is not None:
            say(f"Picture: {swept.plot(plot)}")
        if json_file is not None:
            write_json(swept.as_json(), json_file)
        return
    with progress_bar(f"motions of {loaded.name}") as progress, who_works(cluster) as workers:
        found = loaded.motions(
            wanted, starts, n, seed=seed, workers=workers, progress=progress, store=store
        )
    show(found.readable())
    for line in found.sentences():
        say(line)
    if store is not None:
        say(f"Store: {store}")
    if plot is not None:
        say(f"Picture: {found.plot(plot)}")
    if json_file is not None:
        write_json(found.as_json(), json_file)


def _speeds(first: str, last: str, number: str) -> list[float]:
    low, high = (si_number(end, "rad/s", "--speeds") for end in (first, last))
    count = int(number) if number.isascii() and number.isdigit() else 0
    if not 0.0 < low <= high or not 1 <= count <= MOST_SPEEDS:
        raise UserError(
            f"--speeds {first} {last} {number}: must be two positive speeds, rising, and a number "
            f"of them from 1 to {MOST_SPEEDS}"
        )
    if count == 1:
        return [low]
    return [low + (high - low) * k / (count - 1) for k in range(count)]
