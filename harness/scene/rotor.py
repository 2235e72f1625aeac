"""The [rotor] table of a scene: planar, two_support, flexible."""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, field_validator, model_validator

from ...models.rotor import LinearRotor
from .feeds import Feeds, Start, fed
from .quantities import (
    SI,
    Angle,
    NotNegative,
    NotNegativePair,
    Positive,
    PositivePair,
    Real,
    Whole,
    refusal,
    refuse_other_length,
)
from .rotor_table import (
    Corrections,
    DampingRatio,
    Friction,
    RotorTable,
    SupportDamping,
    SupportStiffness,
    Unbalances,
)


class Planar(RotorTable):
    """Disc in one plane: Filimonikhina 2017 (4), Dubovik 2006 (5)."""

    kind: Literal["planar"] = "planar"
    mass: Annotated[Positive, SI("kg"), Feeds()]
    """Without weights and liquid."""
    stiffness: Annotated[PositivePair, SI("N/m"), Feeds("stiffness_{axis}")]
    """Of the supports, fixed axes."""
    damping: Annotated[NotNegativePair, SI("N s/m"), Feeds("damping_{axis}")] = (0.0, 0.0)
    """Of the supports, fixed axes."""
    damping_ratio: DampingRatio = None
    """Instead of damping; 1 is critical for the mass that the support carries at rest."""
    friction: Friction = ()
    """Dry friction in the supports: sliders."""
    internal_damping: Annotated[NotNegative, SI("N s/m"), Feeds()] = 0.0
    """Of the shaft, turns with it."""
    unbalance: Annotated[NotNegative, SI("kg m"), Feeds()] = 0.0
    """Static moment, mass times eccentricity."""
    unbalance_angle: Annotated[Angle, Feeds()] = 0.0
    """Direction in the rotor."""

    stations: ClassVar[tuple[float, ...]] = (0.0,)
    supports: ClassVar[tuple[int, ...]] = (1,)
    planes: ClassVar[tuple[float, ...]] = (0.0,)
    centre: ClassVar[float] = 0.0

    @model_validator(mode="after")
    def _damped(self) -> Planar:
        self._damp_by_ratio()
        return self

    @property
    def unbalance_names(self) -> list[tuple[str, str]]:
        """Of its only unbalance."""
        return [("unbalance", "unbalance_angle")]

    def with_unbalance(self, _number: int, amount: float, angle: float) -> Planar:
        """The same with another unbalance."""
        return self.model_copy(update={"unbalance": amount, "unbalance_angle": angle})

    def with_corrections(self, planes: Sequence[int]) -> Corrections:
        """The rotor's one unbalance, to which corrections are added."""
        present = cmath.rect(self.unbalance, self.unbalance_angle)
        return Corrections({}, [present], self.unbalance_names)

    def sizes(self, planes: Sequence[int]) -> dict[str, Any]:
        """What the unit is built for: the sliders are all there is to choose."""
        return self._sliders

    def build(self) -> LinearRotor:
        """The rotor's matrices."""
        return self._with_friction(LinearRotor.planar(**self._arguments()))


class TwoSupport(RotorTable):
    """Rigid body on two supports; positions are measured from support 1."""

    kind: Literal["two_support"] = "two_support"
    mass: Annotated[Positive, SI("kg"), Feeds()]
    """Without weights and liquid."""
    inertia: Annotated[Positive, SI("kg m^2"), Feeds()]
    """About a transverse axis through the centre of mass."""
    polar_inertia: Annotated[NotNegative, SI("kg m^2"), Feeds()] = 0.0
    """About the axis; at most twice `inertia`."""
    span: Annotated[Positive, SI("m"), Feeds()]
    """Distance of the supports."""
    com: Annotated[Real | None, SI("m")] = None
    """Centre of mass, from support 1; default: `span/2`."""
    stiffness: SupportStiffness
    """One entry a support."""
    damping: SupportDamping = ((0.0, 0.0), (0.0, 0.0))
    """One entry a support."""
    damping_ratio: DampingRatio = None
    """Instead of damping; 1 is critical for the mass that the support carries at rest."""
    friction: Friction = ()
    """Dry friction in the supports: sliders."""
    planes: Annotated[tuple[Real, ...], SI("m")] = ()
    """Where balancers can sit, from support 1."""
    unbalances: Annotated[Unbalances, Feeds("unbalance[{n}].")] = ()
    """Static moments along the axis."""

    supports: ClassVar[tuple[int, ...]] = (1, 2)

    @model_validator(mode="after")
    def _is_a_body(self) -> TwoSupport:
        if self.polar_inertia > 2.0 * self.inertia:
            raise refusal(
                "polar_inertia", f"no body has more than 2 inertia = {2.0 * self.inertia:g} kg m^2"
            )
        self._damp_by_ratio()
        return self

    @property
    def stations(self) -> tuple[float, ...]:
        """The supports."""
        return (0.0, self.span)

    @property
    def centre(self) -> float:
        """Place of the centre of mass [m]."""
        return self.span / 2.0 if self.com is None else self.com

    def start(self, planes: Sequence[int]) -> Start:
        """Parameters of the unit."""
        return {**fed(self), "com": self.centre, **self._plane_start(planes)}

    def build(self) -> LinearRotor:
        """The rotor's matrices."""
        return self._with_friction(LinearRotor.two_support(**self._arguments()))


class Flexible(RotorTable):
    """Discs on a massless shaft with two supports, which are stations of the shaft."""

    kind: Literal["flexible"] = "flexible"
    stations: Annotated[tuple[Real, ...], Field(min_length=2), SI("m"), Feeds("station[{n}].z")]
    """Positions along the shaft, rising."""
    masses: Annotated[tuple[NotNegative, ...], SI("kg"), Feeds("station[{n}].mass")]
    """One a station."""
    supports: tuple[Whole, Whole]
    """Numbers of the two stations that are supported, from 1."""
    support_stiffness: SupportStiffness
    """One entry a support."""
    support_damping: SupportDamping = ((0.0, 0.0), (0.0, 0.0))
    """One entry a support."""
    damping_ratio: DampingRatio = None
    """Instead of damping; 1 is critical for the mass that the support carries at rest."""
    friction: Friction = ()
    """Dry friction in the supports: sliders."""
    bending_stiffness: Annotated[Positive | None, SI("N m^2"), Feeds()] = None
    """E I of the shaft; this or `compliance`."""
    compliance: Annotated[tuple[tuple[Real, ...], ...] | None, SI("m/N")] = None
    """Square matrix over the stations without supports; this or `bending_stiffness`."""
    internal_damping: Annotated[NotNegative, SI("N s/m"), Feeds()] = 0.0
    """Of the shaft, turns with it."""
    unbalances: Annotated[Unbalances, Feeds("unbalance[{n}].")] = ()
    """Static moments along the shaft: at its stations, with `bending_stiffness` also between."""

    @field_validator("stations")
    @classmethod
    def _ascend(cls, value: tuple[float, ...]) -> tuple[float, ...]:
        if any(b <= a for a, b in pairwise(value)):
            raise ValueError("must rise from one station to the next")
        return value

    @model_validator(mode="after")
    def _fits_together(self) -> Flexible:
        count = len(self.stations)
        refuse_other_length("masses", self.masses, count, "station")
        if self.supports[0] == self.supports[1] or not all(1 <= s <= count for s in self.supports):
            raise refusal("supports", f"must be two different stations, 1 to {count}")
        if (self.compliance is None) == (self.bending_stiffness is None):
            raise refusal("compliance", "give either bending_stiffness (N m^2) or compliance (m/N)")
        size = count - 2
        if self.compliance is not None and [len(r) for r in self.compliance] != [size] * size:
            raise refusal(
                "compliance", f"must be {size} rows of {size}, the stations without supports"
            )
        self._damp_by_ratio()
        return self

    @property
    def mass(self) -> float:
        """Of all discs [kg]."""
        return sum(self.masses)

    @property
    def centre(self) -> float:
        """Place of the centre of mass [m]."""
        return sum(m * z for m, z in zip(self.masses, self.stations, strict=True)) / self.mass

    @property
    def planes(self) -> tuple[float, ...]:
        """The stations: every one can carry something."""
        return self.stations

    def unit_planes(self, used: Sequence[int]) -> tuple[int, ...]:
        """Only the stations that carry something: a unit with all of them would cost more."""
        return tuple(sorted(set(used))) or (1,)

    def sizes(self, planes: Sequence[int]) -> dict[str, Any]:
        """What the unit is built for, the way its shaft is described included."""
        shaft = "uniform" if self.compliance is None else "compliance"
        return {**super().sizes(planes), "shaft": shaft}

    def start(self, planes: Sequence[int]) -> Start:
        """Parameters of the unit; a compliance that is not quite symmetric is made so."""
        values = {**fed(self), **self._plane_start(planes)}
        for s, place in enumerate(self.support_positions, start=1):
            values[f"support[{s}].position"] = place
        delta = self.compliance or ()
        for j, row in enumerate(delta):
            for k in range(j, len(delta)):
                values[f"compliance[{j + 1},{k + 1}]"] = (row[k] + delta[k][j]) / 2.0
        return values

    def build(self) -> LinearRotor:
        """The rotor's matrices."""
        return self._with_friction(LinearRotor.flexible(**self._arguments()))


Rotor = Annotated[Planar | TwoSupport | Flexible, Field(discriminator="kind")]
