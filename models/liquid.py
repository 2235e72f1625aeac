"""The liquid auto-balancer of Dubovik 2006: chamber, float, and liquid that fills the gap.

The float stays on the axis of rotation, so the liquid's centre of mass moves r times as far as
the chamber's, r = r1^2 / (r1^2 - r2^2), and reacts with F = -r m2 a: a pure added mass.
"""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Liquid:
    """Geometry [m] and density [kg/m^3] of the liquid balancer, Dubovik 2006 (4).

    Raises:
        ValueError: the float does not fit the chamber.
    """

    chamber_radius: float
    float_radius: float
    height: float
    density: float

    def __post_init__(self) -> None:
        if self.float_radius >= self.chamber_radius:
            raise ValueError(
                f"float_radius = {self.float_radius!r} m: must be smaller than "
                f"chamber_radius = {self.chamber_radius!r} m"
            )

    @property
    def gap(self) -> float:
        """Clearance between float and chamber at rest r1 - r2 [m]; bending must stay below it."""
        return self.chamber_radius - self.float_radius

    @property
    def liquid_mass(self) -> float:
        """m2 = rho pi (r1^2 - r2^2) h [kg]."""
        # the factored difference of squares keeps its digits in a thin gap
        area = math.pi * self.gap * (self.chamber_radius + self.float_radius)
        return self.density * area * self.height

    @property
    def added_mass(self) -> float:
        """r m2 = rho pi r1^2 h [kg]: the mass of liquid that would fill the whole chamber."""
        return self.density * math.pi * self.chamber_radius**2 * self.height

    def clearance(self, displacement: complex) -> float:
        """What is left of the gap when the chamber's centre is displaced [m]."""
        return self.gap - abs(displacement)
