"""`autobalancer rotor`: modes, critical speeds and pictures of a scene's rotor."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from ..errors import UserError
from ..output import costs, options
from ..output.files import write_json
from ..output.table import Sheet
from ..output.terminal import progress_bars, say, show
from ..scene.changes import changed_scene
from ..units import in_both

if TYPE_CHECKING:
    from ...models.linear.modes import Modes
    from ..scene import Scene


def command(
    scene: Annotated[str, options.SCENE],
    campbell: Annotated[
        Path | None, options.picture("Natural frequencies and damping against speed.")
    ] = None,
    response: Annotated[
        Path | None, options.picture("Amplitude and phase by unbalance against speed.")
    ] = None,
    orbit: Annotated[Path | None, options.picture("Orbits of the stations.")] = None,
    run_up: Annotated[Path | None, options.picture("Displacement while the speed rises.")] = None,
    modes: Annotated[
        Path | None, options.figure("Mode shapes along the shaft, with their whirl.")
    ] = None,
    polar: Annotated[
        Path | None, options.figure("Amplitude and phase by unbalance as polar curves.")
    ] = None,
    limits: Annotated[tuple[str, str] | None, options.RANGE] = None,
    changes: Annotated[list[str] | None, options.changes("rotor.mass=3.0")] = None,
    json_file: Annotated[Path | None, options.json("the modes")] = None,
    at_most: Annotated[str, options.AT_MOST] = costs.DEFAULT,
) -> None:
    """Find modes and critical speeds of the rotor, draw its motion."""
    from ...models.linear.modes import speeds_of_interest
    from ..scene.quantities import LARGEST
    from .study import modes_at

    wanted = {"campbell": campbell, "response": response, "orbit": orbit, "run-up": run_up}
    wanted |= {"modes": modes, "polar": polar}
    loaded = changed_scene(scene, changes)
    if limits is None:
        low, high = speeds_of_interest(loaded.assembly().rotor, loaded.profile().end)
    else:
        low, high = options.speed_range(limits)
    if not 0.0 < low < high <= LARGEST:
        raise UserError(
            f"--range {low:g} {high:g}: must be two speeds [rad/s], 0 < LOW < HIGH <= {LARGEST:g}"
        )
    at_speed = modes_at(loaded)
    show(modes_table(loaded, at_speed))
    facts = critical_facts(loaded)
    for line in facts["lines"]:
        say(line)
    with costs.limited(at_most, f"--range {low:g} {high:g}"), progress_bars() as bars:
        for kind, path in wanted.items():
            if path is not None:
                task = bars.add_task(f"drawing {kind}", total=None)
                _draw(kind, loaded, low, high, path)
                bars.remove_task(task)
                say(f"Picture: {path}")
    if json_file is not None:
        write_json(as_json(loaded, at_speed, facts), json_file)


def _draw(kind: str, scene: Scene, low: float, high: float, path: Path) -> None:
    from ..master.pictures.in_space import mode_shapes
    from . import plot, plot_motion, study

    if kind == "campbell":
        plot.plot_campbell(*study.campbell_of(scene, low, high), scene.heading, path)
    elif kind == "response":
        plot.plot_response(study.response_of(scene, low, high), path)
    elif kind == "orbit":
        plot_motion.plot_orbits(study.orbits_of(scene), path)
    elif kind == "modes":
        mode_shapes(scene).save(path)
    elif kind == "polar":
        plot.polar_response(study.response_of(scene, low, high)).save(path)
    else:
        plot_motion.plot_run_up(study.run_up_of(scene, low, high), path)


def modes_table(scene: Scene, at_speed: Modes) -> Sheet:
    """Natural frequency, damping and whirl of every mode."""
    modes = zip(
        at_speed.natural_frequencies, at_speed.damping_ratios, at_speed.directions, strict=True
    )
    rows = []
    for number, (frequency, damping, direction) in enumerate(modes, start=1):
        numbers = (f"{frequency:.6g}", f"{frequency / math.tau:.5g}", f"{damping:.4g}")
        whirl = direction if damping >= 0.0 else f"{direction}, UNSTABLE"
        rows.append([str(number), *numbers, whirl])
    columns = ("mode", "frequency [rad/s]", "[Hz]", "damping ratio [1]", "whirl")
    title = f"{scene.heading}: rotor alone at {in_both(at_speed.speed, 'rad/s')}"
    return Sheet(columns, rows, "rrrrl", title)


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


def as_json(scene: Scene, at_speed: Modes, facts: dict[str, Any]) -> dict[str, Any]:
    """Modes and critical speeds, SI units; for `write_json`."""
    columns = {
        "frequency": at_speed.natural_frequencies,
        "damping_ratio": at_speed.damping_ratios,
        "growth_rate": at_speed.eigenvalues.real,
        "whirl": at_speed.whirl,
        "direction": at_speed.directions,
    }
    return {
        "scene": scene.name,
        "speed": at_speed.speed,
        "critical_speeds": facts["alone"],
        "critical_speeds_loaded": facts["loaded"],
        "modes": [dict(zip(columns, m, strict=True)) for m in zip(*columns.values(), strict=True)],
    }
