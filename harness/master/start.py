"""What the units' inputs are at a consistent start, for tools that do not find it themselves."""

from __future__ import annotations

from .cosimulation import CoSimulation
from .plan import ROTOR, Plan, Port


def shown_at_start(plan: Plan, cosim: CoSimulation, turn: complex = 1.0) -> dict[Port, float]:
    """Forces and accelerations of a consistent start, times `turn`, at a plan's single outputs."""
    return {
        single: part
        for port, value in cosim.system.present().items()
        for single, part in zip(
            plan.variables(port, "signal"), ((value * turn).real, (value * turn).imag), strict=True
        )
    }


def start_inputs(cosim: CoSimulation) -> dict[str, dict[str, float]]:
    """Masses, forces and accelerations that the inputs have at the start, by unit."""
    shown = shown_at_start(cosim.plan, cosim)
    held: dict[str, dict[str, float]] = {ROTOR: dict(cosim.system.masses)}
    for target, sources in cosim.plan.inputs("signal").items():
        value = sum(shown[source] for source in sources)
        held.setdefault(target.unit, {})[target.variable] = value
    return held
