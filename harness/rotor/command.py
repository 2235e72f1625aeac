"""`autobalancer rotor`: modes, critical speeds and pictures of a scene's rotor."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import UserError
from ..master.run_command import changed_scene
from ..output.terminal import console, progress_bars, ready_to_write, say

if TYPE_CHECKING:
    from rich.table import Table

    from ...models.linear.modes import Modes
    from ..scene import Scene


def command(
    scene: Annotated[str, typer.Argument(help="Scene file, or the name of a bundled scene.")],
    campbell: Annotated[
        Path | None,
        typer.Option(metavar="FILE.png", help="Natural frequencies and damping against speed."),
    ] = None,
    response: Annotated[
        Path | None,
        typer.Option(metavar="FILE.png", help="Amplitude and phase by unbalance against speed."),
    ] = None,
    orbit: Annotated[
        Path | None, typer.Option(metavar="FILE.png", help="Orbits of the stations.")
    ] = None,
    run_up: Annotated[
        Path | None, typer.Option(metavar="FILE.png", help="Displacement while the speed rises.")
    ] = None,
    limits: Annotated[
        tuple[float, float] | None,
        typer.Option("--range", metavar="LOW HIGH", help="Speeds of the pictures [rad/s]."),
    ] = None,
    changes: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="Replace a value: rotor.mass=3.0"),
    ] = None,
    json_file: Annotated[
        Path | None, typer.Option("--json", metavar="FILE", help="Also write the modes as JSON.")
    ] = None,
) -> None:
    """Modes and critical speeds of a scene's rotor, and pictures of its motion."""
    from ..checks.report import write_json
    from ..output.files import picture_format
    from .study import modes_at, speed_range

    wanted = {"campbell": campbell, "response": response, "orbit": orbit, "run-up": run_up}
    for path in [*wanted.values(), json_file]:
        ready_to_write(path)
    for path in wanted.values():
        if path is not None:
            picture_format(path)
    loaded = changed_scene(scene, changes)
    low, high = limits or speed_range(loaded)
    if not 0.0 < low < high:
        raise UserError(f"--range {low:g} {high:g}: must be two speeds [rad/s], 0 < LOW < HIGH")
    found = modes_at(loaded)
    console().print(modes_table(loaded, found))
    facts = critical_facts(loaded)
    for line in facts["lines"]:
        say(line)
    with progress_bars() as bars:
        for kind, path in wanted.items():
            if path is not None:
                task = bars.add_task(f"drawing {kind}", total=None)
                _draw(kind, loaded, low, high, path)
                bars.remove_task(task)
                say(f"Picture: {path}")
    if json_file is not None:
        write_json(as_json(loaded, found, facts), json_file)


def _draw(kind: str, scene: Scene, low: float, high: float, path: Path) -> None:
    from . import plot as pictures
    from . import plot_motion as rotor_motion
    from . import study as rotor_study

    if kind == "campbell":
        data, critical = rotor_study.campbell_of(scene, low, high)
        pictures.plot_campbell(data, critical, scene.title or scene.name, path)
    elif kind == "response":
        pictures.plot_response(rotor_study.response_of(scene, low, high), path)
    elif kind == "orbit":
        rotor_motion.plot_orbits(rotor_study.orbits_of(scene), path)
    else:
        rotor_motion.plot_run_up(rotor_study.run_up_of(scene, low, high), path)


def modes_table(scene: Scene, found: Modes) -> Table:
    """Natural frequency, damping and whirl of every mode."""
    from rich.markup import escape
    from rich.table import Table

    table = Table(
        title=escape(f"{scene.title or scene.name}: rotor alone at {found.speed:g} rad/s"),
        title_justify="left",
    )
    for column in ("mode", "frequency [rad/s]", "[Hz]", "damping ratio [1]"):
        table.add_column(escape(column), justify="right")
    table.add_column("whirl")
    rows = zip(found.natural_frequencies, found.damping_ratios, found.directions, strict=True)
    for number, (frequency, damping, direction) in enumerate(rows, start=1):
        hertz = frequency / 6.283185307179586
        shown = direction if damping >= 0.0 else f"{direction}, UNSTABLE"
        table.add_row(str(number), f"{frequency:.6g}", f"{hertz:.5g}", f"{damping:.4g}", shown)
    return table


def critical_facts(scene: Scene) -> dict[str, Any]:
    """Critical speeds of the rotor alone and with its balancers' masses on it [rad/s]."""
    from ...models.linear.modes import critical_speeds

    assembly = scene.assembly()
    alone = critical_speeds(assembly.rotor).tolist()
    loaded = critical_speeds(assembly.loaded_rotor).tolist()

    def shown(speeds: list[float]) -> str:
        return ", ".join(f"{speed:.6g}" for speed in speeds) + " rad/s"

    lines = [f"Critical speeds, undamped: {shown(alone)}"]
    if scene.balancer:
        lines.append(f"with the balancers' masses fixed to it: {shown(loaded)}")
    return {"alone": alone, "loaded": loaded, "lines": lines}


def as_json(scene: Scene, found: Modes, facts: dict[str, Any]) -> dict[str, Any]:
    """Modes and critical speeds, SI units."""
    return {
        "scene": scene.name,
        "speed": found.speed,
        "critical_speeds": facts["alone"],
        "critical_speeds_loaded": facts["loaded"],
        "modes": [
            {
                "frequency": float(frequency),
                "damping_ratio": float(damping),
                "growth_rate": float(value.real),
                "whirl": float(whirl),
                "direction": direction,
            }
            for value, frequency, damping, whirl, direction in zip(
                found.eigenvalues,
                found.natural_frequencies,
                found.damping_ratios,
                found.whirl,
                found.directions,
                strict=True,
            )
        ],
    }
