"""What the units' inputs are at a consistent start, for tools that do not find it themselves."""

from __future__ import annotations

from typing import Any

from ..master.cosimulation import CoSimulation
from ..master.one_file_run import OneFileRun
from ..master.plan import plan
from ..master.recorder import present_values
from ..master.runtime import runtime
from ..scene import Scene
from ..scene.run import Coupling


def start_values(scene: Scene) -> dict[str, dict[str, float | bool]]:
    """Parameters, and inputs at a consistent start, of every unit of a scene.

    An input is the sum of outputs of the scene's one file at its start, however the scene is
    coupled; without a native library of its Python units.
    """
    found = plan(scene)
    inputs = {
        target: [f"{unit}.{variable}" for unit, variable in sources]
        for target, sources in found.inputs("mass", "signal").items()
    }
    native = runtime("native").backend == "native"
    coupling: dict[str, Any] = {f"coupling.{key}": None for key in Coupling.model_fields}
    coupling["coupling.units"] = None if native else "python"
    simulation: type[OneFileRun | CoSimulation] = OneFileRun if native else CoSimulation
    with simulation(scene.replace(coupling)) as run:
        run.start()
        outputs = present_values(run.units, [name for names in inputs.values() for name in names])
    values = {unit.name: dict(unit.start) for unit in found.units}
    for target, names in inputs.items():
        values[target.unit][target.variable] = sum(outputs[name] for name in names)
    return values
