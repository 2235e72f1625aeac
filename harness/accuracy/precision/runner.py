"""What every method is behind: made ready, run and closed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from ....models.arrays import Array


@dataclass(frozen=True, eq=False)
class TimedRun:
    """A finished run: seconds without loading, its points, and its work (steps, evaluations)."""

    seconds: float
    time: Array
    signals: dict[str, Array]
    work: int
    note: str = ""


class Runner(Protocol):
    """A method made ready for one scene."""

    def run(self) -> TimedRun:
        """Run once, timed.

        Raises:
            SimulationError, ArithmeticError: it cannot.
        """
        ...

    def close(self) -> None:
        """Give back what it holds."""
        ...
