"""Recording: what is asked for at every communication point, and the facts of the run."""

from __future__ import annotations

from array import array
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..errors import SceneError
from ..scene import Scene
from ..scene.balancer import LiquidBalancer
from .fmu import Group, Unit
from .left_out import left_out
from .resolution import SAID
from .result import Result

if TYPE_CHECKING:
    from .cosimulation import CoSimulation


def recorded(scene: Scene) -> list[str]:
    """Signals the scene asks for; by default the rotor's motion and what each balancer does."""
    if scene.run.record is not None:
        return list(scene.run.record)
    stations = scene.rotor.build().stations
    names = ["rotor.x", "rotor.y"]
    if stations > 1:
        names = [f"rotor.station[{j}].{axis}" for j in range(1, stations + 1) for axis in "xy"]
    for balancer in scene.balancer:
        if isinstance(balancer, LiquidBalancer):
            names.append(f"{balancer.label}.clearance")
        else:
            names += [f"{balancer.label}.{v}" for v in ("moment_xi", "moment_eta")]
            names += [f"{balancer.label}.weight[{k}].angle" for k in range(1, balancer.count + 1)]
    return names


class Recorder:
    """Rows of recorded signals, filled as the run goes.

    Args:
        units: by name.
        names: `unit.variable`.

    Raises:
        SceneError: a name is not `unit.variable` of this scene.
    """

    def __init__(self, units: Mapping[str, Unit], names: Sequence[str]) -> None:
        wanted: dict[str, list[str]] = {}
        for name in names:
            unit, _, variable = name.partition(".")
            if unit not in units or variable not in units[unit].variables:
                known = ", ".join(units[unit].variables) if unit in units else ", ".join(units)
                raise SceneError(
                    f"run.record: {name!r} is not recorded by any unit; known: {known}"
                )
            wanted.setdefault(unit, []).append(variable)
        self.groups: list[tuple[Unit, Group]] = [
            (units[unit], units[unit].group(variables)) for unit, variables in wanted.items()
        ]
        self.names = [f"{unit}.{v}" for unit, variables in wanted.items() for v in variables]
        self.rows = array("d")

    def take(self, time: float) -> None:
        """Record the present values."""
        self.rows.append(time)
        for unit, group in self.groups:
            self.rows.extend(unit.get(group))

    def columns(self) -> tuple[NDArray[np.float64], dict[str, NDArray[np.float64]]]:
        """Times [s], and every signal by name."""
        table = np.array(self.rows).reshape(-1, 1 + len(self.names))
        return table[:, 0].copy(), {n: table[:, i].copy() for i, n in enumerate(self.names, 1)}

    def result(self, cosim: CoSimulation, seconds: float) -> Result:
        """Everything recorded, with the facts of the run."""
        time, signals = self.columns()
        calls: dict[str, int] = {}
        for unit in cosim.units.values():
            for kind, count in unit.calls.items():
                calls[kind] = calls.get(kind, 0) + count
        return Result(
            scene_title=cosim.scene.title,
            time=time,
            signals=signals,
            seconds=seconds,
            left_out=tuple(left_out(cosim.scene, self.names)),
            units=tuple(path.name for path in dict.fromkeys(cosim.paths)),
            events=tuple(events(cosim)),
            steps=cosim.steps,
            passes=cosim.units["rotor"].calls["step"],
            calls=calls,
            unconverged=cosim.unconverged,
        )


def events(cosim: CoSimulation) -> list[str]:
    """What a user must know about the run: validity and convergence."""
    notes = [message for unit in cosim.units.values() for message in unit.messages]
    if cosim.unconverged:
        notes.append(
            f"{cosim.unconverged} of {cosim.steps} steps left a residual above 1e-3 of the force "
            f"(worst {cosim.worst_residual:.2g}): use smaller steps or more corrections"
        )
    resolution = cosim.resolution
    if resolution and resolution.estimate >= SAID:
        notes.append(
            "steps too long for signals that vary faster: the motion errs by about "
            f"{resolution.estimate:.1g} of itself: use more steps_per_rev, or a tolerance"
        )
    elif resolution and resolution.unresolved:
        notes.append(
            f"{resolution.unresolved} of {cosim.steps} steps were too long for signals that "
            "vary faster: use more steps_per_rev, or a tolerance"
        )
    return notes
