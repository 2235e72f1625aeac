"""What every method is behind: made ready, run and closed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..master.cosimulation import CoSimulation
from ..master.plan import Plan, Port

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Run:
    """A finished run: seconds without loading, its points, and its work (steps, evaluations)."""

    seconds: float
    time: Array
    signals: dict[str, Array]
    work: int
    note: str = ""


def shown_at_start(plan: Plan, cosim: CoSimulation, turn: complex = 1.0) -> dict[Port, float]:
    """Forces and accelerations of a consistent start, times `turn`, at a plan's single outputs."""
    return {
        single: part
        for port, value in cosim.system.present().items()
        for single, part in zip(
            plan.variables(port, "signal"), ((value * turn).real, (value * turn).imag), strict=True
        )
    }


class Runner(Protocol):
    """A method made ready for one scene."""

    def run(self) -> Run:
        """Run once, timed.

        Raises:
            SimulationError, ArithmeticError: it cannot.
        """
        ...

    def close(self) -> None:
        """Give back what it holds."""
        ...
