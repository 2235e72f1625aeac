"""`autobalancer run`: one co-simulation from a scene file to signals."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import UserError
from ..output.terminal import console, progress_bars, ready_to_write, say, say_facts

if TYPE_CHECKING:
    from rich.table import Table

    from ..scene import Scene
    from .result import Result


def command(
    scene: Annotated[str, typer.Argument(help="Scene file, or the name of a bundled scene.")],
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE.csv", help="Write the signals as CSV."),
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE.png", help="Draw the signals (png, svg, pdf).")
    ] = None,
    changes: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Replace a value: rotor.unbalance=0.1"),
    ] = None,
    fmus: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Use the FMUs there, build none.")
    ] = None,
) -> None:
    """Run a scene by co-simulation."""
    from ..output.files import picture_format
    from .cosimulation import cosimulate

    ready_to_write(output)
    ready_to_write(plot)
    if plot is not None:
        picture_format(plot)
    loaded = changed_scene(scene, changes)
    if fmus is not None and not fmus.is_dir():
        raise UserError(f"{fmus}: is not a directory with FMUs")
    with progress_bars() as bars:
        task = bars.add_task(f"running {loaded.name}", total=1.0)
        result = cosimulate(
            loaded, fmus=fmus, progress=lambda done: bars.update(task, completed=done)
        )
    console().print(summary(result))
    say_facts(result.units, result.left_out)
    say(
        f"{result.steps} steps, {result.passes} passes, {sum(result.calls.values())} FMI calls in "
        f"{result.seconds:.3f} s"
    )
    for event in result.events:
        say(f"NOTE: {event}", style="bold yellow", error=True)
    if output is not None:
        say(f"Signals: {result.to_csv(output)}")
    if plot is not None:
        say(f"Picture: {result.plot(plot)}")


def changed_scene(scene: str, changes: list[str] | None) -> Scene:
    """The scene of that file or name with every --set KEY=VALUE put in its place.

    Raises:
        UserError: the scene is wrong, or a change is.
    """
    from ..scene import load_scene

    loaded = load_scene(scene)
    return loaded.replace(dict(map(parse_change, changes))) if changes else loaded


def parse_change(text: str) -> tuple[str, Any]:
    """'rotor.unbalance=0.1' as key and value, the value as TOML writes it.

    Raises:
        UserError: there is no '=', or what follows is not a value.
    """
    from ..scene.file import tomllib

    key, equals, value = (part.strip() for part in text.partition("="))
    try:
        if not (key and equals and value):
            raise ValueError
        return key, tomllib.loads(f"value = {value}")["value"]
    except ValueError as error:
        raise UserError(
            f"--set {text}: must be KEY=VALUE with a value as in a scene file, such as "
            "rotor.unbalance=0.1 or 'coupling.scheme=\"jacobi\"'"
        ) from error


def summary(result: Result) -> Table:
    """Smallest, largest and last value of every signal."""
    from rich.markup import escape
    from rich.table import Table

    table = Table(title=escape(result.scene_title or "run"), title_justify="left")
    table.add_column("signal")
    table.add_column("unit")
    for column in ("smallest", "largest", "at the end"):
        table.add_column(column, justify="right")
    for name, values in {"time": result.time, **result.signals}.items():
        unit = "s" if name == "time" else result.signal_units.get(name, "")
        numbers = (values.min(), values.max(), values[-1])
        table.add_row(escape(name), unit, *(f"{number:.6g}" for number in numbers))
    return table
