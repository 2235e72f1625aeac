"""What every kind of rotor in a scene stands on: its supports, and the bodies that carry it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from ...models.bodies import GROUND, ROTOR
from ...models.rubber import Zener, foot_numbers, zener
from .bearing import GRAVITY
from .bodies import BodyTable, refuse_half_of_rubber
from .nested import Nested
from .quantities import SI, Positive, PositivePair, Table, Text, refusal
from .rotor_keys import Bearings, Slider, Unbalances
from .stop import Cubic, Stops
from .unit import FmuPath


def _elements(spring: Sequence[float], factor: Sequence[float], frequency: float) -> list[Zener]:
    """Elements of rubber along x and y."""
    return [zener(k, eta, frequency) for k, eta in zip(spring, factor, strict=True)]


class Supported(Table):
    """Supports of a rotor; positions are axial [m].

    Attributes:
        stations: places that move on their own.
        supports: numbers of the stations that stand on supports, from 1.
        planes: places that a balancer's `at` and a correction can name.
    """

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
    def _stands(self) -> Supported:
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
    def _is_supported(self) -> Supported:
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
    def _slides_one_way(self) -> Supported:
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
