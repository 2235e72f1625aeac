"""A flexible shaft with discs, as the rotor of a scene."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, field_validator, model_validator

from ...models.rotor import LinearRotor
from .bodies import refuse_half_of_rubber
from .feeds import Feeds, Start, fed
from .given import Acting
from .nested import Nested
from .quantities import (
    SI,
    Angle,
    NotNegative,
    Positive,
    Real,
    Table,
    Whole,
    refusal,
    refuse_other_length,
)
from .rotor_keys import (
    DampingRatio,
    Friction,
    SupportDamping,
    SupportStiffness,
    Unbalances,
)
from .rotor_table import RotorTable
from .stop import Cubic, CubicOfSupports, Stops


class Skew(Table):
    """A disc that sits askew on the shaft."""

    station: Whole
    """Number of the station."""
    tilt: Annotated[NotNegative, SI("rad")]
    """Angle between the disc's axis and the shaft."""
    angle: Angle = 0.0
    """Its direction in the rotor."""


class Flexible(RotorTable):
    """Discs on a massless shaft with two supports, which are stations of the shaft."""

    kind: Literal["flexible"] = "flexible"
    stations: Annotated[tuple[Real, ...], Field(min_length=2), SI("m"), Feeds("station[{n}].z")]
    """Positions along the shaft, rising."""
    masses: Annotated[tuple[NotNegative, ...], SI("kg"), Feeds("station[{n}].mass")]
    """One a station."""
    supports: tuple[Whole, Whole]
    """Numbers of the two stations that are supported, from 1."""
    support_stiffness: SupportStiffness = None
    """One entry a support; this or `bearings`."""
    support_damping: SupportDamping = ((0.0, 0.0), (0.0, 0.0))
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
    transverse_inertias: Annotated[tuple[NotNegative, ...], SI("kg m^2")] = ()
    """Of the discs about a diameter, one a station, 0: a point; with `polar_inertias`."""
    polar_inertias: Annotated[tuple[NotNegative, ...], SI("kg m^2")] = ()
    """Of the discs about the axis, one a station; a thin disc has twice the transverse one."""
    shear_stiffness: Annotated[Positive | None, SI("N")] = None
    """kappa G A of the shaft; default: it does not shear."""
    skews: tuple[Nested[Skew], ...] = ()
    """Discs that sit askew on the shaft: a couple that turns with it."""
    bending_stiffness: Annotated[Positive | None, SI("N m^2"), Feeds()] = None
    """E I of the shaft; this or `compliance`."""
    compliance: Annotated[tuple[tuple[Real, ...], ...] | None, SI("m/N")] = None
    """Square matrix over the stations without supports; this or `bending_stiffness`."""
    internal_damping: Annotated[NotNegative, SI("N s/m"), Feeds()] = 0.0
    """Of the shaft, turns with it."""
    shaft_loss_factor: Annotated[Positive | None, SI("")] = None
    """Of a shaft of rubber, such as a soft coupling; turns with it, at a constant speed. Its
    stiffness is the dynamic one at `shaft_loss_frequency`."""
    shaft_loss_frequency: Annotated[Positive | None, SI("rad/s")] = None
    """Frequency in the turning shaft at which it was measured, such as "50 Hz"."""
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
        refuse_half_of_rubber(
            self.shaft_loss_factor, self.shaft_loss_frequency, "shaft_loss_factor"
        )
        if self.shaft_loss_factor and self.internal_damping:
            raise refusal("shaft_loss_factor", "give either internal_damping or a loss factor")
        if self.shaft_loss_factor and count == 2:
            raise refusal("shaft_loss_factor", "a shaft with discs at its supports cannot bend")
        self._tilts_as_a_body(count)
        size = count - 2
        if self.compliance is not None and [len(r) for r in self.compliance] != [size] * size:
            raise refusal(
                "compliance", f"must be {size} rows of {size}, the stations without supports"
            )
        self._damp_by_ratio()
        return self

    def _tilts_as_a_body(self, count: int) -> None:
        given = {key: getattr(self, key) for key in ("transverse_inertias", "polar_inertias")}
        for key, values in given.items():
            if any(given.values()):
                refuse_other_length(key, values, count, "station")
        tilts = any(self.transverse_inertias) or self.shear_stiffness is not None
        if tilts and self.compliance is not None:
            raise refusal("compliance", "has no slopes: discs that tilt, or a shaft that shears, "
                          "need bending_stiffness (N m^2)")  # fmt: skip
        for k, (across, along) in enumerate(zip(*given.values(), strict=True), start=1):
            if along > 2.0 * across:
                words = f"no body has more than twice the transverse one, {2.0 * across:g} kg m^2"
                raise refusal(f"polar_inertias[{k}]", words)
        tilting = {k for k, one in enumerate(self.transverse_inertias, start=1) if one}
        for k, skew in enumerate(self.skews, start=1):
            if skew.station not in tilting:
                raise refusal(f"skews[{k}].station", "must be a station whose disc has inertias")

    @property
    def takes_matrices(self) -> bool:
        """Whether discs tilt, the shaft shears or bearings have cross terms."""
        tilts = any(self.transverse_inertias) or self.shear_stiffness is not None
        return tilts or self.shaft_loss_factor is not None or super().takes_matrices

    @property
    def _of_shaft(self) -> tuple[float, ...]:
        """Places of the shaft's displacements: stations, and points of the axes of discs that
        tilt."""
        if not self.transverse_inertias:
            return self.stations
        from ...models.tilting import arms  # few rotors have such discs

        pairs = zip(self.stations, arms(self.masses, self.transverse_inertias), strict=True)
        return self.stations + tuple(z + arm for z, arm in pairs if arm)

    @property
    def points(self) -> tuple[float, ...]:
        """The stations, and a point of the axis of every disc that tilts."""
        shaft = self._of_shaft
        inside = shaft if self.shaft_loss_factor else ()
        return shaft + super().points[len(self.stations) :] + inside

    @property
    def beyond(self) -> tuple[str, ...]:
        """What the points of the discs' axes are called."""
        tilting = [k for k, one in enumerate(self.transverse_inertias, start=1) if one]
        axes = [f"axis of station {k}" for k in tilting]
        shaft = [*(f"station {k}" for k in range(1, len(self.stations) + 1)), *axes]
        inside = [f"rubber of {each}" for each in shaft] if self.shaft_loss_factor else []
        return (*axes, *super().beyond, *inside)

    def acting(self) -> Acting:
        """The unbalances, then the couples of discs that are askew, as forces at their arms."""
        found = [*super(Flexible, self.model_copy(update={"skews": ()})).acting()]
        empty = self.model_copy(update={"unbalances": ()})
        for skew in self.skews:
            one = skew.model_copy(update={"tilt": 1.0, "angle": 0.0})
            row = empty.model_copy(update={"skews": (one,)}).build().unbalance.real
            size = float(np.abs(row).max()) or 1.0
            found.append((skew.tilt * size, skew.angle, row / size))
        return found

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
        if self.takes_matrices:
            return super().sizes(planes)
        shaft = "uniform" if self.compliance is None else "compliance"
        return {**super().sizes(planes), "shaft": shaft}

    def start(self, planes: Sequence[int]) -> Start:
        """Parameters of the unit; a compliance that is not quite symmetric is made so."""
        if self.takes_matrices:
            return self._matrix_start(planes)
        values = {**fed(self), **self._plane_start(planes)}
        for s, place in enumerate(self.support_positions, start=1):
            values[f"support[{s}].position"] = place
        delta = self.compliance or ()
        for j, row in enumerate(delta):
            for k in range(j, len(delta)):
                values[f"compliance[{j + 1},{k + 1}]"] = (row[k] + delta[k][j]) / 2.0
        return values

    def _arguments(self) -> dict[str, Any]:
        skews = [(skew.station, skew.tilt, skew.angle) for skew in self.skews]
        return super()._arguments() | {"skews": skews}

    def build(self) -> LinearRotor:
        """The rotor's matrices."""
        rotor = self._with_supports(LinearRotor.flexible(**self._arguments()))
        if self.shaft_loss_factor and self.shaft_loss_frequency:
            from ...models.rubber import with_turning_rubber, zener  # few shafts are of it

            one = zener(1.0, self.shaft_loss_factor, self.shaft_loss_frequency)
            rotor = with_turning_rubber(rotor, len(self._of_shaft), one)
        return rotor
