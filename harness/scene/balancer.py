"""The [[balancer]] tables of a scene: balls, rollers, pendulums; of liquids in `liquid`."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from ...models.assembly import Mounted
from ...models.papers.capacity import capacity, moment_range
from ...models.race import MOST_LOBES
from ...models.rotor import LinearRotor
from ...models.spacing import fits, half_angle, largest_radius, touching
from ...models.weights import KAPPA, Weights
from ...models.weights import Lobes as RaceLobes
from .feeds import Feeds, Start, fed
from .liquid import Liquid as Liquid
from .liquid import Ring as Ring
from .mounting import Balancer as Balancer
from .nested import Nested
from .quantities import (
    SI,
    Angle,
    Each,
    NotNegative,
    Positive,
    Real,
    Table,
    Whole,
    each_of,
    refusal,
    refuse_other_length,
)

_OWN = {"mass": "mass", "drag": "drag", "weight_radius": "radius"}  # key, and name in the unit
MOST_WEIGHTS = 10_000  # a slip of the keyboard, not a balancer


class Lobes(Table):
    """One order of a race that is not round, its own cosine of the angle in the rotor."""

    lobes: Annotated[Whole, Field(ge=1, le=MOST_LOBES), Feeds()]
    """Around the race: 2 is an oval, 3 and more waviness, 1 a race off centre to first order."""
    amplitude: Annotated[NotNegative, SI("m"), Feeds()]
    """Half of the peak-to-valley of this order."""
    angle: Annotated[Angle, SI("rad"), Feeds()] = 0.0
    """Of a lobe, where the race is farthest out, in the rotor."""

    def build(self) -> RaceLobes:
        """The lobes, for the models."""
        return RaceLobes(self.lobes, self.amplitude, self.angle)


class WeightBalancer(Balancer):
    """Weights on one circular track, Filimonikhina 2017 (4)."""

    model: ClassVar[str] = "BallBalancer"
    driven: ClassVar[bool] = True
    exchanges_force: ClassVar[bool] = True

    count: Annotated[Whole, Field(ge=1, le=MOST_WEIGHTS)]
    """Number of weights."""
    mass: Annotated[Positive, Each(), SI("kg"), Feeds()]
    """Of each; or a list, one a weight."""
    track_radius: Annotated[Positive, SI("m"), Feeds()]
    """Of the path of the weights' centres."""
    drag: Annotated[NotNegative, Each(), SI("N s/m"), Feeds()] = 0.0
    """Of each, on its speed along the track; [where to get it](../how-to/drag.md); or a list."""
    weight_radius: Annotated[Annotated[Positive, Each()] | None, SI("m"), Feeds()] = None
    """Weights of this size collide and pack, and must fit; or a list; default: points that pass."""
    restitution: Annotated[NotNegative, Field(le=1.0), SI(""), Feeds()] = 0.0
    """Of two weights that collide on the free rotor; needs `weight_radius`."""
    rolling_resistance: Annotated[NotNegative, SI(""), Feeds()] = 0.0
    """Resistance over load: Coulomb's, with true sticking."""
    track_offset_xi: Annotated[Real, SI("m"), Feeds()] = 0.0
    """Of the track's centre from the plane's, in the rotor."""
    track_offset_eta: Annotated[Real, SI("m"), Feeds()] = 0.0
    """Of the track's centre from the plane's, in the rotor."""
    race: Annotated[tuple[Nested[Lobes], ...], Feeds("race[{n}].")] = ()
    """Lobes of a track that is not round, `[{lobes = 2, amplitude = "20 um", angle = "30 deg"}]`;
    [what they leave](../how-to/race.md); default: a circle."""
    angles: Annotated[tuple[Angle, ...], SI("rad"), Feeds("weight[{n}].angle0")] = ()
    """In the rotor, one a weight; default: evenly spread."""
    speeds: Annotated[tuple[Real, ...], SI("rad/s"), Feeds("weight[{n}].speed0")] = ()
    """In the rotor, one a weight; default: 0."""

    @model_validator(mode="after")
    def _fits_together(self) -> WeightBalancer:
        spread = tuple(math.tau * k / self.count for k in range(self.count))
        for key, value in (("angles", spread), ("speeds", (0.0,) * self.count)):
            if key not in self.model_fields_set:
                self.__dict__[key] = value  # it is frozen
            refuse_other_length(key, getattr(self, key), self.count, "weight")
        for key in _OWN:
            if given := each_of(getattr(self, key)):
                refuse_other_length(key, given, self.count, "weight")
        bent = math.fsum(one.build().bend for one in self.race)
        if bent >= self.track_radius:
            raise refusal(
                "race",
                f"bends inwards: the sum of (lobes^2 - 1) amplitude is {bent:.6g} m, must be less "
                f"than track_radius = {self.track_radius!r} m",
            )
        if self.race and self.rolling_resistance:
            raise refusal("rolling_resistance", "must be 0 on a race with lobes, or leave it out")
        if self.weight_radius is not None:
            self._refuse_overlap()
        elif self.restitution > 0.0:
            raise refusal(
                "restitution", "point weights do not collide: give weight_radius, or leave this out"
            )
        return self

    @property
    def offset(self) -> complex:
        """Of the track's centre from the plane's, in the rotor, xi + i eta [m]."""
        return complex(self.track_offset_xi, self.track_offset_eta)

    @property
    def _radii(self) -> list[float]:
        """Of each weight, where they have a size [m]."""
        return list(each_of(self.weight_radius)) or [self.weight_radius or 0.0] * self.count

    def _neighbours(self) -> Iterator[tuple[int, int, float]]:
        """Weights next to each other, in the order of the start, and how far apart their centres
        must be [rad]."""
        order, radii = self._order, self._radii
        for k, i in enumerate(order if self.count > 1 else ()):
            j = order[(k + 1) % self.count]
            yield i, j, touching(radii[i], radii[j], self.track_radius)

    def overlapping(self, angles: Sequence[float]) -> tuple[int, int, float, float] | None:
        """Neighbours that overlap at these angles, in the order of the start: which, how far apart
        they are, and must be [rad]; None: nowhere.

        Args:
            angles: (N,) [rad].
        """
        for i, j, needed in self._neighbours():
            apart = (angles[j] - angles[i]) % math.tau
            if apart < needed * (1.0 - 1e-9):
                return i, j, apart, needed
        return None

    def _refuse_overlap(self) -> None:
        """Refuse weights that do not fit, or overlap at their start angles, which tell their
        order."""
        radii, track = self._radii, self.track_radius
        if max(radii) >= track:
            raise refusal("weight_radius", f"must be less than track_radius = {track!r} m")
        if len(set(radii)) == 1 and not fits(self.count, radii[0], track):
            raise refusal(
                "weight_radius",
                f"{self.count} weights do not fit on a track of radius {track!r} m: "
                f"must be at most {largest_radius(self.count, track):.6g} m",
            )
        if found := self.overlapping(self.angles):
            i, j, apart, needed = found
            raise refusal(
                "angles",
                f"weights {i + 1} and {j + 1} overlap: {apart:.6g} rad apart, must be at least "
                f"{needed:.6g} rad for their weight_radius",
            )
        if self.unequal and math.tau - sum(n for _, _, n in self._neighbours()) < 1e-9:
            raise refusal("weight_radius", "unequal weights fill the track: make it larger")

    @property
    def kappa(self) -> float:
        """7/5 ball, 3/2 roller, 1 pendulum."""
        return KAPPA[self.kind]

    @property
    def half_angle(self) -> float:
        """Half the angle between weights that touch, of the mean radius [rad]; 0 for points."""
        return half_angle(self.weight_radius or 0.0, self.track_radius)

    @property
    def capacity(self) -> float:
        """Largest unbalance that the weights balance, Goncharov 2017 (5) [kg m]."""
        if self.unequal:
            return self.moment_range[1]
        return capacity(self.mass, self.track_radius, self.weight_radius or 0.0, self.count)

    @property
    def unequal(self) -> bool:
        """Whether values are given for each weight."""
        return any(each_of(getattr(self, key)) for key in _OWN)

    @property
    def moment_range(self) -> tuple[float, float]:
        """Least and largest unbalance that the weights balance [kg m]."""
        each = [self.device.each[k] for k in self._order]
        sines = [one.radius / one.track_radius for one in each]
        return moment_range([one.moment for one in each], sines)

    @property
    def _order(self) -> list[int]:
        """Weights as they stand on the track at the start."""
        return sorted(range(self.count), key=lambda k: self.angles[k] % math.tau)

    @property
    def can_meet(self) -> bool:
        """Whether two of the weights can collide."""
        return bool(self.weight_radius) and self.count > 1

    @property
    def can_stick(self) -> bool:
        """Whether a weight can come to rest and break away."""
        return bool(self.rolling_resistance)

    @property
    def records(self) -> tuple[str, ...]:
        """Static moment, and where the weights are."""
        angles = (f"weight[{k}].angle" for k in range(1, self.count + 1))
        return ("moment_xi", "moment_eta", *angles)

    def sizes(self) -> dict[str, Any]:
        """What the unit is built for."""
        lobes = {"lobes": len(self.race)} if self.race else {}
        return {"weights": self.count} | ({"unequal": 1} if self.unequal else {}) | lobes

    def start(self, loaded_rotor: LinearRotor) -> Start:
        """Parameters and start values of the unit.

        Weights that can meet get the mobility of their plane [1/kg]: the rotor gives way to a
        collision.
        """
        values: Start = {**fed(self), "kappa": self.kappa}
        for key, what in _OWN.items():
            if own := each_of(mean := getattr(self, key)):
                for k, value in enumerate(own, start=1):
                    values[f"weight[{k}].{what}_ratio"] = value / mean if mean else 1.0
        if self.can_meet:
            row = loaded_rotor.planes[self.at - 1]
            values["track_mobility"] = float(row @ np.linalg.solve(loaded_rotor.mass, row))
        return values

    @property
    def device(self) -> Weights:
        """The weights, for the models."""
        radius = self.weight_radius or 0.0
        masses, drags, radii = (each_of(getattr(self, key)) for key in _OWN)
        return Weights(
            self.count,
            self.mass,
            self.track_radius,
            self.drag,
            self.kappa,
            radius,
            masses,
            drags,
            radii,
            tuple(one.build() for one in self.race),
        )

    def build(self) -> Mounted:
        """The weights on their plane."""
        return Mounted(
            self.label,
            self.device,
            self.at - 1,
            self.angles,
            self.speeds,
            self.offset,
            self.half_angle,
            self.restitution,
            self.rolling_resistance,
        )


class Balls(WeightBalancer):
    """Balls that roll on one circular track, Filimonikhina 2017 (4)."""

    kind: Literal["balls"] = "balls"


class Rollers(WeightBalancer):
    """Rollers on one circular track, Filimonikhina 2017 (4)."""

    kind: Literal["rollers"] = "rollers"


class Pendulums(WeightBalancer):
    """Pendulums on one axis, Filimonikhina 2017 (4)."""

    kind: Literal["pendulums"] = "pendulums"


AnyBalancer = Nested[Balls | Rollers | Pendulums | Liquid | Ring]
