"""The bearings of a rotor with full 2x2 matrices, in a scene."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from .quantities import SI, Real, Table, Whole

Square = tuple[tuple[Real, Real], tuple[Real, Real]]


class Bearing(Table):
    """A support with cross terms: force on the shaft -(K d + C d'), d = (x, y)."""

    support: Annotated[Whole, Field(ge=1, le=2)] = 1
    """Number of the support; a planar rotor has one."""
    stiffness: Annotated[Square, SI("N/m")]
    """[[kxx, kxy], [kyx, kyy]]; kxy > 0 > kyx drives forward whirl."""
    damping: Annotated[Square, SI("N s/m")] = ((0.0, 0.0), (0.0, 0.0))
    """[[cxx, cxy], [cyx, cyy]]."""

    @property
    def diagonals(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Stiffness [N/m] and damping [N s/m] along x and y without the cross terms."""
        (k_x, _), (_, k_y) = self.stiffness
        (c_x, _), (_, c_y) = self.damping
        return (k_x, k_y), (c_x, c_y)
