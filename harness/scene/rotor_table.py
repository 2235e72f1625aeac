"""What every kind of rotor in a scene answers: what its unit is built and started with, which
matrices it has, and where corrections go.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
from pydantic import model_validator

from ...models.arrays import Numbers
from ...models.bodies import with_bodies
from ...models.rotor import LinearRotor
from ...models.rotor import Slider as LinearSlider
from ...models.rubber import with_rubber
from .feeds import Start, fed
from .given import Acting, matrix_start
from .quantities import refusal
from .rotor_keys import Unbalance
from .rotor_supports import Supported
from .stop import Holding, build_cubic, find_support, restraint_start, rows_across

if TYPE_CHECKING:
    from typing_extensions import Self

_NO_ARGUMENTS = (  # of a constructor of `LinearRotor`
    *("kind", "fmu", "friction", "damping_ratio", "bodies", "on", "zone_limits"),
    *("support_loss_factor", "loss_frequency", "cubic_stiffness", "cubic", "stops"),
    *("shaft_loss_factor", "shaft_loss_frequency"),
)


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


class RotorTable(Supported):
    """What every kind of rotor answers.

    Attributes:
        model: the unit that steps it.
    """

    model: ClassVar[str] = "RotorOnSupports"

    @property
    def takes_matrices(self) -> bool:
        """Whether its unit has no kind of its own: it is built by matrices."""
        return bool(self.bearings or self.bodies or self.support_loss_factor)

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
