"""`autobalancer map`: a stability map over any two parameters of a scene."""

from __future__ import annotations

from enum import Enum
from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import UserError
from ..output import options
from ..output.terminal import progress_bar, ready_to_write, say
from ..scene.at_rest import about_restraints
from .changes import changed_scene, set_option

AXIS = "PATH=LOW:HIGH:N[:log]"


class MapMethod(str, Enum):
    """What is known of every point of a map."""

    FLOQUET = "floquet"
    COSIM_RUN = "cosim-run"
    MOTIONS = "motions"
    PROVED = "proved"


def command(
    scene: Annotated[str, options.SCENE],
    x: Annotated[str, typer.Option(metavar=AXIS, help="Such as speed=0.5:12:100 (rad/s).")],
    y: Annotated[str, typer.Option(metavar=AXIS, help="Such as weights.drag=1e-4:1:100:log.")],
    output: Annotated[list[Path] | None, options.pictures()] = None,
    store: Annotated[Path | None, options.store()] = None,
    csv: Annotated[Path | None, options.output(".csv", "Write every point as CSV.")] = None,
    method: Annotated[
        MapMethod,
        typer.Option(
            help="Growth rates; residual vibration after the scene's run, in C; share of run-ups "
            "that balances; or stability proved for every cell."
        ),
    ] = MapMethod.FLOQUET,
    cluster: Annotated[str | None, options.CLUSTER] = None,
    changes: Annotated[list[str] | None, set_option("rotor.mass=3.0")] = None,
    report: Annotated[Path | None, options.REPORT] = None,
) -> None:
    """Draw over two parameters where balancing is stable."""
    from ..output.cluster import who_works
    from ..output.report import Report
    from ..stability.axis import Axis

    pictures = list(output or ())
    if not (pictures or csv or store or report):
        pictures = [Path("map.png")]
        ready_to_write(pictures[0])
    loaded = changed_scene(scene, changes)
    axes = []
    for option, text in (("--x", x), ("--y", y)):
        try:
            axes.append(Axis.parse(text, loaded))
        except UserError as error:
            raise UserError(f"{option} {error}") from error
    page = Report(report, f"Map: {loaded.heading}", [loaded])
    with progress_bar(f"mapping {loaded.name}") as progress, who_works(cluster) as workers:
        form: dict[str, Any] = {"workers": workers, "progress": progress, "store": store}
        data = loaded.map(axes[0], axes[1], method.value, **form)
    with page.keeping():
        for line in data.lines():
            say(line)
        if supports := about_restraints(loaded):
            say(supports)
    if csv is not None:
        say(f"Points: {data.to_csv(csv)}")
    if store is not None:
        say(f"Store: {store}")
    drawn = page.picture(f"{loaded.name}_map")
    if drawn is not None:
        pictures.append(drawn)
    for picture in pictures:
        say(f"Picture: {data.plot(picture)}")
    page.write()
