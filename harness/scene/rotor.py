"""The [rotor] table of a scene: its kinds, of which planar and two_support stand here."""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from ...models.rotor import LinearRotor
from .feeds import Feeds, Start, fed
from .given import Acting
from .nested import Nested
from .quantities import (
    SI,
    Angle,
    NotNegative,
    NotNegativePair,
    Positive,
    PositivePair,
    Real,
    refusal,
)
from .rotor_flexible import Flexible
from .rotor_keys import (
    DampingRatio,
    Friction,
    OrBearings,
    SupportDamping,
    SupportStiffness,
    Unbalances,
)
from .rotor_matrices import Matrices
from .rotor_table import Corrections, RotorTable
from .stop import Cubic, CubicOfPlanar, CubicOfSupports, Stops


class Planar(RotorTable):
    """Disc in one plane: Filimonikhina 2017 (4), Dubovik 2006 (5)."""

    kind: Literal["planar"] = "planar"
    mass: Annotated[Positive, SI("kg"), Feeds()]
    """Without weights and liquid."""
    stiffness: Annotated[
        PositivePair | None,
        SI("N/m"),
        Feeds("stiffness_{axis}"),
        Field(validate_default=True),
        OrBearings,
    ] = None
    """Of the supports, fixed axes; this or `bearings`."""
    damping: Annotated[NotNegativePair, SI("N s/m"), Feeds("damping_{axis}")] = (0.0, 0.0)
    """Of the supports, fixed axes."""
    damping_ratio: DampingRatio = None
    """Instead of damping; 1 is critical for the mass that the support carries at rest."""
    friction: Friction = ()
    """Dry friction in the supports: sliders, also with a free stroke."""
    cubic_stiffness: CubicOfPlanar = None
    """Force by the cube of the displacement, beside `stiffness`; below 0 the spring softens."""
    cubic: Cubic = "radial"
    """Along the displacement, k3 |d|^2 d, or "axes": k3 x^3 and k3 y^3, each along its own."""
    stops: Stops = ()
    """Elastic stops beyond a gap."""
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
        if self.takes_matrices:
            return [("unbalance[1].amount", "unbalance[1].angle")]
        return [("unbalance", "unbalance_angle")]

    def acting(self) -> Acting:
        """Its only unbalance."""
        return [(self.unbalance, self.unbalance_angle, np.eye(1, len(self.points))[0])]

    def with_unbalance(self, _number: int, amount: float, angle: float) -> Planar:
        """The same with another unbalance."""
        return self.model_copy(update={"unbalance": amount, "unbalance_angle": angle})

    def with_corrections(self, planes: Sequence[int]) -> Corrections:
        """The rotor's one unbalance, to which corrections are added."""
        present = cmath.rect(self.unbalance, self.unbalance_angle)
        return Corrections({}, [present], self.unbalance_names)

    def sizes(self, planes: Sequence[int]) -> dict[str, Any]:
        """What the unit is built for: what its support has is all there is to choose."""
        return super().sizes(planes) if self.takes_matrices else self._of_supports

    def build(self) -> LinearRotor:
        """The rotor's matrices."""
        return self._with_supports(LinearRotor.planar(**self._arguments()))


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
    stiffness: SupportStiffness = None
    """One entry a support; this or `bearings`."""
    damping: SupportDamping = ((0.0, 0.0), (0.0, 0.0))
    """One entry a support."""
    damping_ratio: DampingRatio = None
    """Instead of damping; 1 is critical for the mass that the support carries at rest."""
    friction: Friction = ()
    """Dry friction in the supports: sliders, also with a free stroke."""
    cubic_stiffness: CubicOfSupports = None
    """Force by the cube of the displacement; one entry a support; below 0 it softens."""
    cubic: Cubic = "radial"
    """Along the displacement, k3 |d|^2 d, or "axes": k3 x^3 and k3 y^3, each along its own."""
    stops: Stops = ()
    """Elastic stops beyond a gap."""
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
        if self.takes_matrices:
            return self._matrix_start(planes)
        return {**fed(self), "com": self.centre, **self._plane_start(planes)}

    def build(self) -> LinearRotor:
        """The rotor's matrices."""
        return self._with_supports(LinearRotor.two_support(**self._arguments()))


Rotor = Nested[Planar | TwoSupport | Flexible | Matrices]
