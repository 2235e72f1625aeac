"""The [rotor] table of a scene: planar, two_support, flexible."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Field, ValidationInfo, field_validator

from ...models.rotor import LinearRotor
from .quantities import (
    NotNegative,
    NotNegativePair,
    Positive,
    PositivePair,
    Real,
    Table,
    Unit,
    Whole,
    same_length,
)


class Unbalance(Table):
    """Static moment at an axial position, at an angle in the rotor."""

    position: Annotated[Real, Unit("m")]
    """Place along the axis, from support 1."""
    amount: Annotated[NotNegative, Unit("kg m")]
    """Static moment, mass times eccentricity."""
    angle: Annotated[Real, Unit("rad")] = 0.0
    """Direction in the rotor."""


Unbalances = tuple[Unbalance, ...]


def _triples(unbalances: Unbalances) -> list[tuple[float, float, float]]:
    return [(u.position, u.amount, u.angle) for u in unbalances]


class PlanarRotor(Table):
    """Disc in one plane: Filimonikhina 2017 (4), Dubovik 2006 (5)."""

    kind: Literal["planar"]
    mass: Annotated[Positive, Unit("kg")]
    """Without weights and liquid."""
    stiffness: Annotated[PositivePair, Unit("N/m")]
    """Of the supports, fixed axes."""
    damping: Annotated[NotNegativePair, Unit("N s/m")] = (0.0, 0.0)
    """Of the supports, fixed axes."""
    internal_damping: Annotated[NotNegative, Unit("N s/m")] = 0.0
    """Of the shaft, turns with it."""
    unbalance: Annotated[NotNegative, Unit("kg m")] = 0.0
    """Static moment, mass times eccentricity."""
    unbalance_angle: Annotated[Real, Unit("rad")] = 0.0
    """Direction in the rotor."""

    @property
    def plane_count(self) -> int:
        """Planes that a balancer's `at` can name."""
        return 1

    def build(self) -> LinearRotor:
        """The rotor's matrices."""
        return LinearRotor.planar(
            mass=self.mass,
            stiffness=self.stiffness,
            damping=self.damping,
            internal_damping=self.internal_damping,
            unbalance=self.unbalance,
            unbalance_angle=self.unbalance_angle,
        )


class TwoSupportRotor(Table):
    """Rigid body on two supports; positions are measured from support 1."""

    kind: Literal["two_support"]
    mass: Annotated[Positive, Unit("kg")]
    """Without weights and liquid."""
    inertia: Annotated[Positive, Unit("kg m^2")]
    """About a transverse axis through the centre of mass."""
    polar_inertia: Annotated[NotNegative, Unit("kg m^2")] = 0.0
    """About the axis; at most twice `inertia`."""
    span: Annotated[Positive, Unit("m")]
    """Distance of the supports."""
    com: Annotated[Real | None, Unit("m")] = None
    """Centre of mass, from support 1; default: `span/2`."""
    stiffness: Annotated[tuple[PositivePair, PositivePair], Unit("N/m")]
    """One entry a support."""
    damping: Annotated[tuple[NotNegativePair, NotNegativePair], Unit("N s/m")] = (
        (0.0, 0.0),
        (0.0, 0.0),
    )
    """One entry a support."""
    planes: Annotated[tuple[Real, ...], Unit("m")] = ()
    """Where balancers can sit, from support 1."""
    unbalances: Unbalances = ()
    """Static moments along the axis."""

    @field_validator("polar_inertia")
    @classmethod
    def _is_a_body(cls, value: float, info: ValidationInfo) -> float:
        inertia = info.data.get("inertia")
        if inertia is not None and value > 2.0 * inertia:
            raise ValueError(f"no body has more than 2 inertia = {2.0 * inertia:g} kg m^2")
        return value

    @property
    def plane_count(self) -> int:
        """Planes that a balancer's `at` can name."""
        return len(self.planes)

    def build(self) -> LinearRotor:
        """The rotor's matrices."""
        return LinearRotor.two_support(
            mass=self.mass,
            inertia=self.inertia,
            polar_inertia=self.polar_inertia,
            span=self.span,
            com=self.span / 2.0 if self.com is None else self.com,
            stiffness=self.stiffness,
            damping=self.damping,
            planes=self.planes,
            unbalances=_triples(self.unbalances),
        )


class FlexibleRotor(Table):
    """Discs on a massless shaft with two supports, which are stations of the shaft."""

    kind: Literal["flexible"]
    stations: Annotated[tuple[Real, ...], Field(min_length=2), Unit("m")]
    """Positions along the shaft, rising."""
    masses: Annotated[tuple[NotNegative, ...], Unit("kg")]
    """One a station."""
    supports: tuple[Whole, Whole]
    """Numbers of the two stations that are supported, from 1."""
    support_stiffness: Annotated[tuple[PositivePair, PositivePair], Unit("N/m")]
    """One entry a support."""
    support_damping: Annotated[tuple[NotNegativePair, NotNegativePair], Unit("N s/m")] = (
        (0.0, 0.0),
        (0.0, 0.0),
    )
    """One entry a support."""
    bending_stiffness: Annotated[Positive | None, Unit("N m^2")] = None
    """E I of the shaft; this or `compliance`."""
    compliance: Annotated[
        tuple[tuple[Real, ...], ...] | None, Field(validate_default=True), Unit("m/N")
    ] = None
    """Square matrix over the stations without supports; this or `bending_stiffness`."""
    internal_damping: Annotated[NotNegative, Unit("N s/m")] = 0.0
    """Of the shaft, turns with it."""
    unbalances: Unbalances = ()
    """Static moments along the shaft."""

    @field_validator("stations")
    @classmethod
    def _ascend(cls, value: tuple[float, ...]) -> tuple[float, ...]:
        if any(b <= a for a, b in pairwise(value)):
            raise ValueError("must rise from one station to the next")
        return value

    @field_validator("masses")
    @classmethod
    def _one_a_station(cls, value: tuple[float, ...], info: ValidationInfo) -> tuple[float, ...]:
        if "stations" in info.data:
            same_length(value, len(info.data["stations"]), "station")
        return value

    @field_validator("supports")
    @classmethod
    def _two_stations(cls, value: tuple[int, int], info: ValidationInfo) -> tuple[int, int]:
        count = len(info.data.get("stations", ()))
        if value[0] == value[1] or (count and not all(1 <= s <= count for s in value)):
            raise ValueError(f"must be two different stations, 1 to {count}")
        return value

    @field_validator("compliance")
    @classmethod
    def _one_description(
        cls, value: tuple[tuple[float, ...], ...] | None, info: ValidationInfo
    ) -> tuple[tuple[float, ...], ...] | None:
        stations = info.data.get("stations")
        if "bending_stiffness" in info.data and (
            (value is None) == (info.data["bending_stiffness"] is None)
        ):
            raise ValueError("give either bending_stiffness (N m^2) or compliance (m/N)")
        if value is not None and stations is not None:
            size = len(stations) - 2
            if len(value) != size or any(len(row) != size for row in value):
                raise ValueError(f"must be {size} rows of {size}, the stations without supports")
        return value

    @property
    def plane_count(self) -> int:
        """Planes that a balancer's `at` can name: the stations."""
        return len(self.stations)

    def build(self) -> LinearRotor:
        """The rotor's matrices."""
        return LinearRotor.flexible(
            stations=self.stations,
            masses=self.masses,
            supports=self.supports,
            support_stiffness=self.support_stiffness,
            support_damping=self.support_damping,
            bending_stiffness=self.bending_stiffness,
            compliance=self.compliance,
            internal_damping=self.internal_damping,
            unbalances=_triples(self.unbalances),
        )


Rotor = Annotated[
    PlanarRotor | TwoSupportRotor | FlexibleRotor,
    Field(discriminator="kind"),
]
