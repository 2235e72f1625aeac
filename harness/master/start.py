"""What the units' inputs are at a consistent start, for tools that do not find it themselves."""

from __future__ import annotations

from .cosimulation import CoSimulation
from .plan import ROTOR


def start_inputs(cosim: CoSimulation) -> dict[str, dict[str, float]]:
    """Masses, forces and accelerations that the inputs have at the start, by unit."""
    shown = {
        single: part
        for port, value in cosim.system.present().items()
        for single, part in zip(
            cosim.plan.variables(port, "signal"), (value.real, value.imag), strict=True
        )
    }
    held: dict[str, dict[str, float]] = {ROTOR: dict(cosim.system.masses)}
    for target, sources in cosim.plan.inputs("signal").items():
        value = sum(shown[source] for source in sources)
        held.setdefault(target.unit, {})[target.variable] = value
    return held
