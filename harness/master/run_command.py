"""`autobalancer run`: one co-simulation from a scene file to signals."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import UserError
from ..output import costs, options
from ..output.table import Sheet
from ..output.terminal import progress_bar, say, say_facts, show

if TYPE_CHECKING:
    from ..scene import Scene
    from .result import Result


ON_PYTHON = {"coupling.units": "python"}  # what --python changes in a scene
_LONGEST_SHOWN = 200  # characters of what was typed


def command(
    scene: Annotated[str, options.SCENE],
    output: Annotated[
        Path | None, options.output(".csv", "Write the signals as CSV.", "--output", "-o")
    ] = None,
    plot: Annotated[Path | None, options.picture("Draw the signals (png, svg, pdf).")] = None,
    changes: Annotated[list[str] | None, options.changes("rotor.unbalance=0.1")] = None,
    fmus: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Use the FMUs there, build none.")
    ] = None,
    python: Annotated[bool, options.python()] = False,
    at_most: Annotated[str, options.at_most()] = costs.DEFAULT,
) -> None:
    """Run a scene by co-simulation."""
    from .cosimulation import cosimulate

    loaded = changed_scene(scene, changes)
    if python:
        loaded = loaded.replace(ON_PYTHON)
    if fmus is not None and not fmus.is_dir():
        raise UserError(f"{fmus}: is not a directory with FMUs")
    with progress_bar(f"running {loaded.name}") as progress:
        key = f"run.revolutions = {loaded.run.revolutions:g}"
        limited = costs.within(at_most, key, progress)
        result = cosimulate(loaded, fmus=fmus, progress=limited)
    show(summary(result))
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
        document = tomllib.loads(f"value = {value}")
        if document.keys() != {"value"}:  # a line break, and an assignment after it
            raise ValueError
        return key, document["value"]
    except (ValueError, RecursionError) as error:
        shown = text if len(text) <= _LONGEST_SHOWN else f"{text[:_LONGEST_SHOWN]}..."
        raise UserError(
            f"--set {' '.join(shown.splitlines())}: must be KEY=VALUE with one value as in "
            "a scene file, such as rotor.unbalance=0.1 or 'coupling.scheme=\"jacobi\"'"
        ) from error


def summary(result: Result) -> Sheet:
    """Smallest, largest and last value of every signal."""
    rows = []
    for name, values in {"time": result.time, **result.signals}.items():
        unit = "s" if name == "time" else result.signal_units.get(name, "")
        numbers = (values.min(), values.max(), values[-1])
        rows.append([name, unit, *(f"{number:.6g}" for number in numbers)])
    columns = ("signal", "unit", "smallest", "largest", "at the end")
    return Sheet(columns, rows, "llrrr", result.scene_title or "run")
