"""What the units' inputs are at a consistent start, for tools that do not find it themselves."""

from __future__ import annotations

from ..scene import Scene
from .cosimulation import CoSimulation
from .plan import ROTOR


def start_values(scene: Scene) -> dict[str, dict[str, float | bool]]:
    """Parameters, and inputs at a consistent start, of every unit of a scene."""
    with CoSimulation(scene) as cosim:
        cosim.start()
        inputs = start_inputs(cosim)
        return {unit.name: {**unit.start, **inputs.get(unit.name, {})} for unit in cosim.plan.units}


def start_inputs(cosim: CoSimulation) -> dict[str, dict[str, float]]:
    """Masses, forces and accelerations that the inputs have at the start, by unit."""
    shown = {
        single: part
        for port, value in cosim.system.present().items()
        for single, part in zip(
            cosim.plan.variables(port, "signal"), (value.real, value.imag), strict=True
        )
    }
    inputs: dict[str, dict[str, float]] = {ROTOR: dict(cosim.system.masses)}
    for target, sources in cosim.plan.inputs("signal").items():
        value = sum(shown[source] for source in sources)
        inputs.setdefault(target.unit, {})[target.variable] = value
    return inputs
