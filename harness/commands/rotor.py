"""`autobalancer rotor`: modes, critical speeds and pictures of a scene's rotor."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from ..output import options
from ..output.files import write_json
from ..output.table import Sheet
from ..output.terminal import progress_bars, say, show
from ..scene.at_rest import about_restraints
from ..units import engineering
from .changes import changed_scene, set_option

if TYPE_CHECKING:
    from ...models.arrays import Array
    from ..rotor.analysis import RotorAnalysis


def command(
    scene: Annotated[str, options.SCENE],
    campbell: Annotated[
        Path | None, options.picture("Natural frequencies and damping against speed.")
    ] = None,
    response: Annotated[
        Path | None, options.picture("Amplitude and phase by unbalance against speed.")
    ] = None,
    run_up: Annotated[Path | None, options.picture("Displacement while the speed rises.")] = None,
    modes: Annotated[
        Path | None, options.picture("Mode shapes along the shaft, with their whirl.")
    ] = None,
    limits: Annotated[tuple[str, str] | None, options.RANGE] = None,
    changes: Annotated[list[str] | None, set_option("rotor.mass=3.0")] = None,
    json_file: Annotated[Path | None, options.json("the modes")] = None,
) -> None:
    """Find modes and critical speeds of the rotor, draw its motion."""
    wanted = {"campbell": campbell, "response": response, "run-up": run_up, "modes": modes}
    loaded = changed_scene(scene, changes)
    found = loaded.rotor(*((limits and options.speed_range(limits)) or ()))
    show(_modes(found))
    say(f"Critical speeds, undamped: {_listed(found.critical)}")
    if loaded.balancer:
        say(f"with the balancers' masses fixed to it: {_listed(found.critical_loaded)}")
    if supports := about_restraints(loaded):
        say(supports)
    if loaded.rotor.bodies:
        show(_shown(found.forces()))
    with progress_bars() as bars:
        for kind, path in wanted.items():
            if path is not None:
                task = bars.add_task(f"drawing {kind}", total=None)
                found.plot(path, kind=kind)
                bars.remove_task(task)
                say(f"Picture: {path}")
    if json_file is not None:
        write_json(found.as_json(), json_file)


def _shown(sheet: Sheet) -> Sheet:
    """Numbers as text, without columns in which nothing stands."""
    kept = [k for k, _ in enumerate(sheet.columns) if any(row[k] != "" for row in sheet.rows)]
    rows = [[c if isinstance(c := row[k], str) else f"{c:.4g}" for k in kept] for row in sheet.rows]
    align = "".join(sheet.align[k] for k in kept)
    return Sheet([sheet.columns[k] for k in kept], rows, align, sheet.title)


_WORDS = {"stable": "", "neutral": ", neutral", "unstable": ", UNSTABLE"}


def _modes(found: RotorAnalysis) -> Sheet:
    """The modes; engineers' frequencies are in Hz anyway, and need no column of their own."""
    sheet, alone = found.table(), engineering.get()
    rows = [
        (
            str(n),
            f"{w:.6g}",
            *(() if alone else (f"{f:.5g}",)),
            f"{d:.4g}",
            f"{whirl}{_WORDS[state]}",
        )
        for (n, w, f, d, whirl), state in zip(sheet.rows, found.modes.states, strict=True)
    ]
    columns, aligned = sheet.columns, "rrrrl"
    if alone:
        columns, aligned = (*columns[:2], *columns[3:]), "rrrl"
    return Sheet(columns, rows, aligned, sheet.title)


def _listed(speeds: Array) -> str:
    return ", ".join(f"{speed:.6g}" for speed in speeds) + " rad/s"
