"""What a second, finer run says of the first."""

from __future__ import annotations

import math
from dataclasses import dataclass

from .parting import Parting


@dataclass(frozen=True)
class Verification:
    """What a second, finer run says of the first.

    Attributes:
        finer: how the second run was stepped, in words.
        error: by signal, largest error at a communication point, in the signal's unit.
        relative: the same over the signal's range; x and y, or the parts of a vector in the rotor,
            share the larger of their ranges.  A rotor that stands still but for rounding is
            measured by 1e-12 of what the scene's forces can move it.
        parting: None where the runs stay together, and `error` is what the first one errs.
        seconds: the second run took.
    """

    finer: str
    error: dict[str, float]
    relative: dict[str, float]
    parting: Parting | None = None
    seconds: float = 0.0

    def note(self) -> str:
        """What a reader must know; empty where the errors say all."""
        if self.parting is None:
            return ""
        return (
            "verify: neighbouring motions diverge "
            f"{math.exp(self.parting.rate):.2g}-fold per revolution "
            f"(rate {self.parting.rate:.2g}): "
            f"from revolution {self.parting.revolution:.3g} on values at a time are not known, "
            "only their statistics"
        )
