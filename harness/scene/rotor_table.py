"""What every kind of rotor in a scene answers: what it weighs, where its supports, stations and
planes are, what its unit is built and started with, and where corrections go.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, Field, ValidationInfo, model_validator
from pydantic_core import PydanticKnownError

from ...models.arrays import Numbers
from ...models.bodies import GROUND, ROTOR, with_bodies
from ...models.rotor import LinearRotor
from ...models.rotor import Slider as LinearSlider
from ...models.rubber import Zener, foot_numbers, with_rubber, zener
from .bearing import GRAVITY, Bearing
from .bodies import BodyTable, refuse_half_of_rubber
from .feeds import Feeds, Start, fed
from .given import Acting, matrix_start
from .nested import Nested
from .quantities import (
    SI,
    Angle,
    NotNegative,
    NotNegativePair,
    Positive,
    PositivePair,
    Real,
    Table,
    Text,
    Whole,
    refusal,
)
from .stop import (
    Cubic,
    Holding,
    Stops,
    build_cubic,
    find_support,
    restraint_start,
    rows_across,
)
from .unit import FmuPath

if TYPE_CHECKING:
    from typing_extensions import Self


class Unbalance(Table):
    """Static moment at an axial position, at an angle in the rotor."""

    position: Annotated[Real, SI("m"), Feeds()]
    """Place along the axis, from support 1."""
    amount: Annotated[NotNegative, SI("kg m"), Feeds()]
    """Static moment, mass times eccentricity."""
    angle: Annotated[Angle, Feeds()] = 0.0
    """Direction in the rotor."""


Unbalances = tuple[Nested[Unbalance], ...]


class Slider(Table):
    """Dry friction in a support, in parallel with its spring, each axis for itself."""

    support: Annotated[Whole | Text, Feeds()] = 1
    """Number of the support, a planar rotor has one; or the name of a body's foot, such as
    "tub.foot[1]"."""
    limit: Annotated[NotNegativePair, SI("N"), Feeds("limit_{axis}")]
    """Force at which it slips; a number for both axes, or [x, y]."""
    stiffness: Annotated[PositivePair | None, SI("N/m"), Feeds("stiffness_{axis}")] = None
    """Of a spring in series with it; default: none, it is rigid."""
    free_stroke: Annotated[NotNegativePair | None, SI("m"), Feeds("free_stroke_{axis}")] = None
    """Way without force between both contacts of the damper, centred about rest; requires a
    stiffness, that of the contacts."""

    @model_validator(mode="after")
    def _has_contacts(self) -> Slider:
        if self.free_stroke and any(self.free_stroke) and self.stiffness is None:
            raise refusal("free_stroke", "requires stiffness (N/m), that of the damper's contacts")
        return self


_NO_ARGUMENTS = (  # of a constructor of `LinearRotor`
    *("kind", "fmu", "friction", "damping_ratio", "bodies", "on", "zone_limits"),
    *("support_loss_factor", "loss_frequency", "cubic_stiffness", "cubic", "stops"),
    *("shaft_loss_factor", "shaft_loss_frequency"),
)
Bearings = tuple[Nested[Bearing], ...]
Friction = Annotated[tuple[Nested[Slider], ...], Feeds("slider[{n}].")]


def _or_bearings(value: Any, info: ValidationInfo) -> Any:
    """A stiffness, which may be left out where bearings take its place."""
    if value is None and not info.data.get("bearings"):
        raise PydanticKnownError("missing")
    return value


OrBearings = AfterValidator(_or_bearings)
SupportStiffness = Annotated[
    tuple[PositivePair, PositivePair] | None,
    SI("N/m"),
    Feeds("support[{n}].stiffness_{axis}"),
    Field(validate_default=True),
    OrBearings,
]
DampingRatio = Annotated[NotNegativePair | None, SI("")]
SupportDamping = Annotated[
    tuple[NotNegativePair, NotNegativePair], SI("N s/m"), Feeds("support[{n}].damping_{axis}")
]


def _elements(spring: Sequence[float], factor: Sequence[float], frequency: float) -> list[Zener]:
    """Elements of rubber along x and y."""
    return [zener(k, eta, frequency) for k, eta in zip(spring, factor, strict=True)]


def _unit(one: Unbalance) -> Unbalance:
    """The same place with 1 kg m along x."""
    return one.model_copy(update={"amount": 1.0, "angle": 0.0})


class Corrections(NamedTuple):
    """Room for correction weights on a rotor.

    Attributes:
        changes: of the scene, for `Scene.replace`.
        present: (p,) unbalance that the rotor already has in these places, complex [kg m].
        parameters: (p,) parameters of the unit that hold amount and angle.
    """

    changes: dict[str, Any]
    present: list[complex]
    parameters: list[tuple[str, str]]


class RotorTable(Table):
    """What every kind of rotor answers; positions are axial [m].

    Attributes:
        model: the unit that steps it.
        stations: places that move on their own.
        supports: numbers of the stations that stand on supports, from 1.
        planes: places that a balancer's `at` and a correction can name.
    """

    model: ClassVar[str] = "RotorOnSupports"
    kind: str
    fmu: FmuPath = None
    """FMU that steps the rotor instead of ours, from the folder of the scene file; it has
    [our ports](units.md); default: ours."""
    bearings: Bearings = ()
    """In place of stiffness and damping: supports with cross terms, one for each support."""
    bodies: tuple[Nested[BodyTable], ...] = ()
    """Bodies that carry the rotor or hang on it, also as [[body]] tables of the scene."""
    on: Text = GROUND
    """What its supports stand on: "ground", or the name of a body."""
    support_loss_factor: Annotated[PositivePair | None, SI("")] = None
    """Of rubber supports, [x, y]; their stiffness is the dynamic one at `loss_frequency`."""
    loss_frequency: Annotated[Positive | None, SI("rad/s")] = None
    """Frequency at which stiffness and loss factor were measured, such as "50 Hz"."""
    zone_limits: Annotated[tuple[Positive, Positive, Positive] | None, SI("m/s")] = None
    """Vibration of feet, rms, at which zones A, B and C end: those of a standard or contract."""
    if TYPE_CHECKING:  # a key of one kind, a property of another
        friction: tuple[Slider, ...]
        damping_ratio: tuple[float, float] | None
        cubic_stiffness: tuple[float, float] | tuple[tuple[float, float], ...] | None
        cubic: Cubic
        stops: Stops

        @property
        def mass(self) -> float: ...
        @property
        def centre(self) -> float: ...
        @property
        def stations(self) -> tuple[float, ...]: ...
        @property
        def supports(self) -> tuple[int, ...]: ...
        @property
        def planes(self) -> tuple[float, ...]: ...
        @property
        def unbalances(self) -> Unbalances: ...

    @property
    def takes_matrices(self) -> bool:
        """Whether its unit has no kind of its own: it is built by matrices."""
        return bool(self.bearings or self.bodies or self.support_loss_factor)

    @property
    def points(self) -> tuple[float, ...]:
        """Places of all that moves on its own: stations, points beyond them, bodies, rubber."""
        rubber = tuple(place for _, place, _ in self._rubber)
        return self.stations + self.support_positions * len(self.bodies) + rubber

    @property
    def beyond(self) -> tuple[str, ...]:
        """Names of the points that are no stations."""
        inside = tuple(f"rubber of {name}" for name, _, _ in self._rubber)
        if len(self.supports) == 1:
            return tuple(body.name for body in self.bodies) + inside
        carried = (f"{body.name} at support {s}" for body in self.bodies for s in (1, 2))
        return (*carried, *inside)

    @property
    def _rubber(self) -> list[tuple[str, float, tuple[int, list[Zener]]]]:
        """Name, place [m], and number from 0 with elements along x, y of supports of rubber."""
        found: list[tuple[str, float, tuple[int, list[Zener]]]] = []
        places = self.support_positions
        if self.support_loss_factor and self.loss_frequency:
            springs = np.reshape(getattr(self, self.stiffness_key), (-1, 2)).tolist()
            for k, spring in enumerate(springs):
                pair = _elements(spring, self.support_loss_factor, self.loss_frequency)
                found.append((f"support {k + 1}", places[k], (k, pair)))
        shapes = [(len(body.feet), body.free != "xy") for body in self.bodies]
        for body, numbers in zip(self.bodies, foot_numbers(len(places), shapes), strict=True):
            for k, (foot, number) in enumerate(zip(body.feet, numbers, strict=True), start=1):
                if foot.loss_factor and foot.loss_frequency:
                    pair = _elements(foot.stiffness, foot.loss_factor, foot.loss_frequency)
                    found.append((f"{body.name}.foot[{k}]", foot.position, (number, pair)))
        return found

    @property
    def carrier(self) -> BodyTable | None:
        """The body on which the rotor stands; None where that is the ground."""
        return next((body for body in self.bodies if body.name == self.on), None)

    @property
    def is_free(self) -> bool:
        """Whether nothing holds the body that carries it."""
        under = {body.name: body for body in self.bodies}
        at, seen = self.on, 0
        while at in under and under[at].feet and seen <= len(under):
            at, seen = under[at].on, seen + 1
        return at != GROUND

    @model_validator(mode="after")
    def _stands(self) -> RotorTable:
        names = [body.name for body in self.bodies]
        refuse_half_of_rubber(self.support_loss_factor, self.loss_frequency, "support_loss_factor")
        if self.support_loss_factor and self.bearings:
            raise refusal("support_loss_factor", "not with bearings: give stiffness, not bearings")
        for k, body in enumerate(self.bodies, start=1):
            if body.name in (GROUND, ROTOR) or names.count(body.name) > 1:
                raise refusal(f"bodies[{k}].name", "must be another name than any other has")
            if not body.feet and body.name != self.on:
                words = "must not be empty: only the body that carries the rotor can be free"
                raise refusal(f"bodies[{k}].feet", words)
            if len(self.supports) > 1 and not body.transverse_inertia:
                words = "must be above 0: the body tilts with the supports of the rotor"
                raise refusal(f"bodies[{k}].transverse_inertia", words)
        if self.zone_limits and sorted(set(self.zone_limits)) != list(self.zone_limits):
            raise refusal("zone_limits", "must ascend: the ends of zones A, B and C")
        if self.on != GROUND and self.on not in names:
            raise refusal("on", f"must be one of {', '.join(map(repr, (GROUND, *names)))}")
        return self

    @property
    def stiffness_key(self) -> str:
        return self.damping_key.replace("damping", "stiffness")

    @model_validator(mode="after")
    def _is_supported(self) -> RotorTable:
        key = self.stiffness_key
        count = len(self.supports)
        if not self.bearings:
            return self
        for other in (key, self.damping_key, "damping_ratio"):
            if other in self.model_fields_set:
                raise refusal("bearings", f"give either bearings or {other}, not both")
        if sorted(b.support for b in self.bearings) != list(range(1, count + 1)):
            raise refusal(
                "bearings",
                f"must be {count}, one for each; a spring has no cross terms",
            )
        self._bear_the_weight()
        loads = self.static_loads()
        ordered = sorted(self.bearings, key=lambda bearing: bearing.support)
        pairs = zip(*(b.diagonals(loads[b.support - 1]) for b in ordered), strict=True)
        for name, each in zip((key, self.damping_key), pairs, strict=True):
            self.__dict__[name] = each[0] if count == 1 and key == "stiffness" else each
        return self

    def _bear_the_weight(self) -> None:
        """Raise for a journal bearing that has no load, and for a table that has no room."""
        under = {body.name: body.free for body in self.bodies}
        for k, bearing in enumerate(self.bearings, start=1):
            varies = bearing.stiffness is None
            if varies and under.get(self.on, "xy") != "xy":
                words = f"does not support a body that is free along {under[self.on]} alone"
                raise refusal(f"bearings[{k}]", words)
            load = bearing.journal.load if bearing.journal else 1.0
            if load is None and not self.static_loads()[bearing.support - 1] > 0.0:
                words = "must be given: the rotor's weight does not load this bearing downwards"
                raise refusal(f"bearings[{k}].journal.load", words)

    def static_loads(self) -> list[float]:
        """Share of the rotor's weight on each support [N]."""
        shares = self.levers([self.centre])[:, 0]
        return [float(share) * self.mass * GRAVITY for share in shares]

    @model_validator(mode="after")
    def _slides_one_way(self) -> RotorTable:
        for k, slider in enumerate(self.friction, start=1):
            count = len(self.supports)
            if isinstance(slider.support, int) and not 1 <= slider.support <= count:
                words = (
                    "must be 1: a planar rotor has one support" if count == 1 else "must be 1 or 2"
                )
                raise refusal(f"friction[{k}].support", words)
        return self

    def _damp_by_ratio(self) -> None:
        """Damping 2 ratio sqrt(k m) of every support, which `damping_ratio` stands for."""
        if self.damping_ratio is None or not self.mass:
            return
        key = self.damping_key
        if key in self.model_fields_set:
            raise refusal("damping_ratio", f"give either {key} (N s/m) or damping_ratio, not both")
        rows = (np.array(self.damping_ratio) * self.critical_damping()).tolist()
        damping = tuple(map(tuple, rows))
        self.__dict__[key] = damping[0] if len(damping) == 1 else damping  # it is frozen

    @property
    def damping_key(self) -> str:
        return "damping" if "damping" in type(self).model_fields else "support_damping"

    def critical_damping(self) -> NDArray[np.float64]:
        """2 sqrt(k m) of every support (s, 2), with the mass m that it carries at rest [N s/m]."""
        springs = np.abs(getattr(self, self.stiffness_key))
        masses = np.abs(self.levers([self.centre])) * self.mass
        return np.asarray(2.0 * np.sqrt(np.reshape(springs, (-1, 2)) * masses))

    def largest_damping_ratio(self) -> float:
        """Damping of a support over the critical one with the mass that it carries at rest."""
        damping = np.reshape(getattr(self, self.damping_key), (-1, 2))
        critical = self.critical_damping()
        return float(np.max(damping / np.where(critical > 0.0, critical, math.inf)))

    def levers(self, places: Sequence[float]) -> NDArray[np.float64]:
        """(s, k): share that each support carries of what acts at each place; a single one, all."""
        if len(self.supports) == 1:
            return np.ones((1, len(places)))
        start, end = self.support_positions
        part = (np.array(places) - start) / (end - start)
        return np.array([1.0 - part, part])

    @property
    def plane_count(self) -> int:
        """Planes that a balancer's `at` can name."""
        return len(self.planes)

    @property
    def support_positions(self) -> tuple[float, ...]:
        """Places of the supports [m]."""
        return tuple(self.stations[number - 1] for number in self.supports)

    def unit_planes(self, used: Sequence[int]) -> tuple[int, ...]:
        """Numbers of the planes that the rotor's unit has; at least one.

        Args:
            used: planes that carry a balancer.
        """
        return tuple(range(1, self.plane_count + 1)) or (1,)

    def plane_at(self, station: int) -> tuple[Self, int]:
        """The same with a plane at a station, from 1, and the number of that plane."""
        place = self.stations[station - 1]
        if place in self.planes:
            return self, self.planes.index(place) + 1
        return self.model_copy(update={"planes": (*self.planes, place)}), self.plane_count + 1

    def sizes(self, planes: Sequence[int]) -> dict[str, Any]:
        """What the unit is built for, with at least one unbalance; `planes` from `unit_planes`."""
        return {
            "kind": "matrices" if self.takes_matrices else self.kind,
            "stations": len(self.points),
            "planes": len(planes),
            "unbalances": len(self.acting()) or 1,
            **self._of_supports,
            **self._tables,
            **(self._forces if self.takes_matrices else {}),
        }

    def start(self, planes: Sequence[int]) -> Start:
        """Parameters of the unit."""
        return self._matrix_start(planes) if self.takes_matrices else fed(self)

    def acting(self) -> Acting:
        """Every unbalance with the row by which it acts."""
        alone = [self.model_copy(update={"unbalances": (_unit(one),)}) for one in self.unbalances]
        return [
            (one.amount, one.angle, rotor.build().unbalance.real)
            for one, rotor in zip(self.unbalances, alone, strict=True)
        ]

    def _matrix_start(self, planes: Sequence[int]) -> Start:
        """Parameters of a unit by matrices."""
        given = matrix_start(self.build(), planes, self.acting())
        return given | self._slider_start()

    def _slider_start(self) -> Start:
        """Parameters of a unit by matrices: sliders across rows of the points."""
        found = {k: v for k, v in fed(self).items() if k.startswith("slider[")}
        points = len(self.points)
        for (n, axis), slider in self._numbered_sliders():
            row = slider.shares(points) if slider.limit else np.zeros(points)
            found[f"slider[{n}].support"] = float(slider.support or 1)
            found |= {f"slider_row_{axis}[{n},{j}]": float(v) for j, v in enumerate(row, start=1)}
        return found

    def _numbered_sliders(self) -> list[tuple[tuple[int, str], LinearSlider]]:
        """Sliders with the number of their entry, from 1, and their axis."""
        numbers = [(n, axis) for n in range(1, len(self.friction) + 1) for axis in "xy"]
        return list(zip(numbers, self.build().sliders, strict=True)) if self.friction else []

    def build(self) -> LinearRotor:
        """The rotor's matrices."""
        raise NotImplementedError

    def with_corrections(self, planes: Sequence[int]) -> Corrections:
        """Room for corrections in these planes: unbalances of nothing beside the rotor's own."""
        table = [unbalance.model_dump() for unbalance in self.unbalances]
        table += [{"position": self.planes[p - 1], "amount": 0.0, "angle": 0.0} for p in planes]
        numbers = range(len(self.unbalances) + 1, len(table) + 1)
        names = [(f"unbalance[{k}].amount", f"unbalance[{k}].angle") for k in numbers]
        return Corrections({"rotor.unbalances": table}, [0j] * len(planes), names)

    @property
    def unbalance_names(self) -> list[tuple[str, str]]:
        """Parameters of the unit that hold amount and angle of each unbalance."""
        numbers = range(1, len(self.unbalances) + 1)
        return [(f"unbalance[{k}].amount", f"unbalance[{k}].angle") for k in numbers]

    def with_unbalance(self, number: int, amount: float, angle: float) -> Self:
        """The same with another amount [kg m] and angle [rad] of an unbalance, from 1."""
        own = list(self.unbalances)
        own[number - 1] = own[number - 1].model_copy(update={"amount": amount, "angle": angle})
        return self.model_copy(update={"unbalances": tuple(own)})

    def _arguments(self) -> dict[str, Any]:
        """What a constructor of `LinearRotor` takes: the table's keys, unbalances as triples."""
        values = {key: value for key, value in self if key not in _NO_ARGUMENTS}
        if "unbalances" in values:
            triples = [(u.position, u.amount, u.angle) for u in self.unbalances]
            values["unbalances"] = triples
        loads = self.static_loads()
        values["bearings"] = [
            (b.support, *(b.matrices(load) if table is None else (table,)))
            for b in self.bearings
            for load in [loads[b.support - 1]]
            for table in [b.over_speed(load)]
        ]
        return values

    @property
    def _of_supports(self) -> dict[str, int]:
        """The build options of what supports have beside springs and dampers."""
        cubics = len(self.build().cubics) if self.cubic_stiffness else 0
        found = {"sliders": len(self.friction), "cubics": cubics, "stops": len(self.stops)}
        return {key: count for key, count in found.items() if count}

    @property
    def is_linear(self) -> bool:
        """Whether its supports are: no friction, cubic springs or stops."""
        return not (self.friction or self.is_restrained)

    @property
    def slides_at_rest(self) -> bool:
        """Whether dry friction holds it at rest: one without a free stroke."""
        return any(
            limit and not stroke
            for slider in self.friction
            for limit, stroke in zip(slider.limit, slider.free_stroke or (0.0, 0.0), strict=True)
        )

    @property
    def has_free_strokes(self) -> bool:
        """Whether a damper has a free stroke."""
        return any(any(slider.free_stroke or ()) for slider in self.friction)

    @property
    def is_restrained(self) -> bool:
        """Whether cubic springs or stops hold it."""
        return bool(self.cubic_stiffness or self.stops)

    def restraint_start(self) -> Start:
        """Parameters of the unit of cubic springs and stops."""
        return restraint_start(self.build()) if self.is_restrained else {}

    def stroke_centres(self, rest: Numbers) -> Start:
        """Parameters of the unit: where the free strokes of sliders are centred, at rest (2, n)."""
        return {
            f"slider[{n}].centre_{axis}": float(
                slider.shares(rest.shape[1]) @ rest["xy".index(axis)]
            )
            for (n, axis), slider in self._numbered_sliders()
            if slider.free_stroke
        }

    @model_validator(mode="after")
    def _is_held(self) -> RotorTable:
        """Refuse sliders, cubic springs and stops where there is no such support."""
        if (self.is_restrained or self.friction) and self.kind != "matrices":  # it builds itself
            self.build()
        return self

    @property
    def _tables(self) -> dict[str, int]:
        """The build options of bearings that change with the speed, where there are any."""
        if all(bearing.stiffness is not None for bearing in self.bearings):
            return {}
        speeds, tables = self.build().tables
        return {"tables": len(tables), "speeds": len(speeds)}

    @property
    def _forces(self) -> dict[str, int]:
        """The build options of supports and feet whose forces are outputs."""
        feet = sum(len(body.feet) for body in self.bodies)
        return {"supports": len(self.supports)} | ({"feet": feet} if feet else {})

    def _with_supports(self, rotor: LinearRotor) -> LinearRotor:
        """The same rotor with its bodies, and with all that its supports have."""
        if self.bodies:
            bodies = [body.build() for body in self.bodies]
            rotor = with_bodies(rotor, self.support_positions, self.planes, bodies, self.on)
        if rubber := self._rubber:
            rotor = with_rubber(rotor, dict(element for _, _, element in rubber))
        sliders = []
        places = self._holding(rotor) if self.friction else {}
        for k, s in enumerate(self.friction, start=1):
            support, number = find_support(places, s.support, f"friction[{k}].support")
            for axis, row in enumerate(rows_across(support)):
                pairs = (s.limit, s.stiffness, s.free_stroke)
                limit, spring, stroke = (pair[axis] if pair else 0.0 for pair in pairs)
                try:
                    one = LinearSlider.across(row, axis, limit, spring, stroke, number)
                except ValueError as error:
                    raise refusal(f"friction[{k}].stiffness", str(error)) from None
                sliders.append(one)
        rotor = replace(rotor, sliders=tuple(sliders))
        try:
            rotor.refuse_rigid_twice()
        except ValueError as error:
            raise refusal("friction", str(error)) from None
        return self._restrained(rotor)

    def _holding(self, rotor: LinearRotor) -> Holding:
        """Supports and feet across which a slider or stop can stand, with their numbers."""
        count = len(self.supports)
        named = (one for one in rotor.supports[count:] if one.name)
        feet = {one.name: (one, number) for number, one in enumerate(named, start=count + 1)}
        return {k + 1: (rotor.supports[k], k + 1) for k in range(count)} | feet

    def _restrained(self, rotor: LinearRotor) -> LinearRotor:
        """The same rotor with cubic springs and stops across its supports."""
        if not self.is_restrained:
            return rotor
        count, cubics, places = len(self.supports), [], self._holding(rotor)
        for k, pair in enumerate(np.reshape(self.cubic_stiffness or (), (-1, 2)).tolist()):
            key = "cubic_stiffness" + (f"[{k + 1}]" if count > 1 else "")
            cubics += build_cubic(*places[k + 1], pair, self.cubic, key)
        stops = [
            stop.build(*find_support(places, stop.support, f"stops[{k}].support"))
            for k, stop in enumerate(self.stops, start=1)
        ]
        return replace(rotor, cubics=tuple(cubics), stops=tuple(stops))

    def _plane_start(self, planes: Sequence[int]) -> Start:
        """Positions of the unit's planes, and its unbalances: at least one of each."""
        places = self.planes or (0.0,)
        nothing = () if self.unbalances else (Unbalance(position=self.stations[0], amount=0.0),)
        values: Start = {f"plane[{i + 1}].position": places[p - 1] for i, p in enumerate(planes)}
        for unbalance in nothing:
            values |= fed(unbalance, "unbalance[1].")
        return values
