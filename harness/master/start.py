"""What the units' inputs are at a consistent start, for tools that do not find it themselves."""

from __future__ import annotations

from ..scene import Scene
from .cosimulation import CoSimulation


def start_values(scene: Scene) -> dict[str, dict[str, float | bool]]:
    """Parameters, and inputs at a consistent start, of every unit of a scene."""
    with CoSimulation(scene) as cosim:
        cosim.start()
        inputs, found = cosim.plan.inputs("mass", "signal"), {}
        for planned in cosim.plan.units:
            names = [port.variable for port in inputs if port.unit == planned.name]
            values = cosim.read(planned.name, names)
            found[planned.name] = {**planned.start, **dict(zip(names, values, strict=True))}
        return found
