"""What schemes share that choose their steps themselves and let the iterated scheme take them."""

from __future__ import annotations

from collections.abc import Sequence

from ..system import System
from .iterated import Iterated


class OwnSteps:
    """Answers of `Scheme` that follow from this alone.

    Args:
        iterated: the scheme that takes a step.
    """

    name = "iterated"
    chooses_steps = True
    startup_halvings = 0
    miss_per_error = 0.0  # errors are held below the tolerance, or runs are compared

    def __init__(self, iterated: Iterated) -> None:
        self.iterated = iterated

    def cross_jump(self, system: System, time: float, step: float) -> None:
        """One step of given length, where nothing of the past can be used."""
        self.iterated.cross_jump(system, time, step)

    def after_start(self, system: System, time: float, step: float) -> None:
        """Nothing: the first steps are as short as they have to be."""

    def allow_error(self, share: float) -> None:
        """Nothing, unless it keeps a tolerance."""

    def amplification(self, eigenvalues: Sequence[complex], order: int) -> float:
        """0: the loop is solved, so that steps repeat no error, whatever its gain."""
        return 0.0
