"""The [[balancer]] tables of liquids: a full chamber with a float, a ring that is part filled."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Literal

from pydantic import model_validator

from ...models.assembly import Mounted
from ...models.ring import Ring as RingModel
from ...models.rotor import LinearRotor
from .feeds import Feeds, Start, fed
from .mounting import Balancer
from .quantities import SI, NotNegative, Positive, refusal, refuse_unless_one

WATER = 1e-6  # m^2/s, kinematic viscosity at 20 degC


class Liquid(Balancer):
    """A full chamber with a float on the axis, Dubovik 2006; with a free surface it is a `ring`."""

    model: ClassVar[str] = "LiquidBalancer"
    follows: ClassVar[tuple[str, ...]] = ("x", "y")
    records: ClassVar[tuple[str, ...]] = ("clearance",)
    can_meet: ClassVar[bool] = False
    can_stick: ClassVar[bool] = False

    kind: Literal["liquid"] = "liquid"
    chamber_radius: Annotated[Positive, SI("m"), Feeds()]
    """Inner radius of the chamber."""
    float_radius: Annotated[Positive, SI("m"), Feeds()]
    """Less than the chamber's."""
    height: Annotated[Positive, SI("m"), Feeds()]
    """Of the gap, along the axis."""
    density: Annotated[Positive, SI("kg/m^3"), Feeds()]
    """Of the liquid."""

    @property
    def exchanges_force(self) -> bool:
        """Only where its inertia is sent rather than carried."""
        return self.inertia_as_force

    @model_validator(mode="after")
    def _fits_the_chamber(self) -> Liquid:
        if self.float_radius >= self.chamber_radius:
            raise refusal(
                "float_radius", f"must be less than chamber_radius = {self.chamber_radius!r} m"
            )
        return self

    def build(self) -> Mounted:
        """The liquid on its plane."""
        from ...models.liquid import Liquid as LiquidModel  # few scenes have one

        device = LiquidModel(self.chamber_radius, self.float_radius, self.height, self.density)
        return Mounted(self.label, device, self.at - 1)


class Ring(Balancer):
    """A ring part filled with liquid, whose free surface carries waves."""

    model: ClassVar[str] = "RingBalancer"
    driven: ClassVar[bool] = True
    exchanges_force: ClassVar[bool] = True
    records: ClassVar[tuple[str, ...]] = ("thinness", "moment_xi", "moment_eta")
    can_meet: ClassVar[bool] = False
    can_stick: ClassVar[bool] = False

    kind: Literal["ring"] = "ring"
    wall_radius: Annotated[Positive, SI("m"), Feeds()]
    """Of the outer wall, inside."""
    inner_radius: Annotated[Positive | None, SI("m")] = None
    """Of the free surface as the ring turns; this, `fill` or `liquid_mass`."""
    fill: Annotated[Positive | None, SI("")] = None
    """Share of the ring's volume that is liquid; needs `inner_wall_radius`."""
    liquid_mass: Annotated[Positive | None, SI("kg")] = None
    """Of the liquid."""
    inner_wall_radius: Annotated[NotNegative, SI("m")] = 0.0
    """Of the inner wall; 0: the ring is a drum."""
    height: Annotated[Positive, SI("m"), Feeds()]
    """Along the axis."""
    density: Annotated[Positive, SI("kg/m^3"), Feeds()]
    """Of the liquid."""
    viscosity: Annotated[NotNegative | None, SI("m^2/s")] = None
    """Kinematic, damps the waves; default: of water, 1e-6 m^2/s, or 0 where `wave_damping` is
    given."""
    wave_damping: Annotated[NotNegative, SI("1/s"), Feeds()] = 0.0
    """Of the waves at every speed, as measured."""

    @model_validator(mode="after")
    def _has_a_surface(self) -> Ring:
        given = refuse_unless_one(self, ("inner_radius", "fill", "liquid_mass"))
        if self.inner_wall_radius >= self.wall_radius:
            raise refusal(
                "inner_wall_radius", f"must be less than wall_radius = {self.wall_radius!r} m"
            )
        if self.fill is not None and not self.inner_wall_radius:
            raise refusal("fill", "needs inner_wall_radius, the ring's inner wall")
        if self.fill is not None and self.fill >= 1.0:
            raise refusal("fill", "must be less than 1: a full ring carries no waves; use liquid")
        square = self._inner_square
        if not square > self.inner_wall_radius**2 * (1.0 - 1e-12) or not square > 0.0:
            most = self._mass_of(self.inner_wall_radius**2)
            raise refusal(given, f"more liquid than the ring holds inside its walls, {most:.6g} kg")
        if square >= self.wall_radius**2:
            raise refusal(given, f"must be less than wall_radius = {self.wall_radius!r} m")
        return self

    @property
    def _inner_square(self) -> float:
        """b^2 [m^2]."""
        wall = self.wall_radius**2
        if self.inner_radius is not None:
            return self.inner_radius**2
        if self.fill is not None:
            return wall - self.fill * (wall - self.inner_wall_radius**2)
        assert self.liquid_mass is not None
        return wall - self.liquid_mass / (self.density * math.pi * self.height)

    def _mass_of(self, inner_square: float) -> float:
        return self.density * math.pi * self.height * (self.wall_radius**2 - inner_square)

    @property
    def kinematic(self) -> float:
        """Viscosity that counts [m^2/s]."""
        if self.viscosity is not None:
            return self.viscosity
        return 0.0 if self.wave_damping else WATER

    @property
    def device(self) -> RingModel:
        """The ring, for the models."""
        inner = self.inner_radius or math.sqrt(self._inner_square)
        return RingModel(
            self.wall_radius, inner, self.height, self.density, self.wave_damping, self.kinematic
        )

    def start(self, loaded_rotor: LinearRotor) -> Start:
        """Parameters and start values of the unit."""
        ring = self.device
        return {**fed(self), "inner_radius": ring.inner_radius, "viscosity": ring.viscosity}

    def build(self) -> Mounted:
        """The ring on its plane."""
        return Mounted(self.label, self.device, self.at - 1)
