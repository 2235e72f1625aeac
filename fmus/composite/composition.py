"""A composition: units with their start values, where they are, and how they are coupled."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from ..catalogue import sized_unit
from ..native.build.tokens import bits, start_entries, token
from ..unit import SizedUnit, Unit
from ..variables import Layout, Variable, started
from .variables import CompositeSizes, variables

SET_BY_COUPLING = ("track_mobility", "shortest_stopped_step")  # parameters that no scene has


@dataclass(frozen=True)
class Part:
    """A unit of a composition.

    Attributes:
        name: of the instance; its variables begin with it.
        model: RotorOnSupports | LiquidBalancer | RingBalancer | BallBalancer | Motor.
        sizes: options of the unit.
        start: parameters and start values.
        plane: of the rotor's unit that a balancer sits on, from 1.
        exchanges_force: whether its force and the plane's acceleration are exchanged.
        follows: whether it gets the place of its plane.
    """

    name: str
    model: str
    sizes: Mapping[str, Any] = field(default_factory=dict)
    start: Mapping[str, float | bool] = field(default_factory=dict)
    plane: int = 0
    exchanges_force: bool = False
    follows: bool = False

    @cached_property
    def unit(self) -> SizedUnit:
        """The unit; raises ValueError or TypeError for sizes that it does not have."""
        return sized_unit(self.model, **self.sizes)

    @property
    def states(self) -> list[str]:
        """Outputs that are its continuous states, in the order of the library."""
        if self.model == "Motor":
            return ["angle", "speed"]
        size = self.unit.options
        of_model = {
            "RotorOnSupports": ("stations", 4, 1),
            "BallBalancer": ("weights", 2, 0),
            "RingBalancer": ("", 0, 4),
        }
        repeat, times, more = of_model.get(self.model, ("", 0, 0))
        observed = [v.name for v in self.unit.layout.variables if v.observed]
        return observed[: times * size.get(repeat, 0) + more]

    @property
    def indicators(self) -> list[str]:
        """What its event indicators of model exchange tell, in the order of the library."""
        found = []
        for k in range(1, self.unit.options.get("sliders", 0) + 1):
            found += [f"slider {k} sticks or slips along {axis}" for axis in "xy"]
        stops = range(1, self.unit.options.get("stops", 0) + 1)
        found += [f"stop {k} is touched or lets go" for k in stops]
        weights = range(1, self.unit.options.get("weights", 0) + 1)
        if self.start.get("weight_radius") and len(weights) > 1:
            found += [f"weight {k} meets or leaves the one ahead" for k in weights]
        for k in weights if self.start.get("rolling_resistance") else ():
            found += [f"weight {k} stops or starts", f"weight {k} changes the wall it leans on"]
        return [f"{self.name}: {text}" for text in found]

    @property
    def has_springs(self) -> bool:
        """Whether it has sliders behind springs, whose force is no state of model exchange, or
        springs that soften, which end."""
        ends = r"slider\[\d+\]\.stiffness_[xy]|cubic\[\d+\]\.limit"
        return any(v for k, v in self.start.items() if re.fullmatch(ends, k))


@dataclass(frozen=True)
class Composition:
    """Everything that a composite FMU is made from; raises ValueError where it does not fit.

    Attributes:
        parts: the rotor first; a motor of limited power last.
        start: of the coupling's own parameters and inputs: `coupling.tolerance`, `speed` ...
        stop, step: of the run that a tool proposes [s].
        corners: of a speed profile behind `rise_time`.
        changes: of the rotor's unbalance.
        title, source: of the machine and its numbers, for descriptions.
        plain: whether descriptions leave out slopes and the coupling's figures.
        flat: whether they name variables by letters, digits and underscores alone.
    """

    parts: tuple[Part, ...]
    start: Mapping[str, float] = field(default_factory=dict)
    stop: float = Unit.stop
    step: float = Unit.step
    corners: int = 0
    changes: int = 0
    title: str = ""
    source: str = ""
    plain: bool = False
    flat: bool = False

    def __post_init__(self) -> None:
        rotors = [part.model == "RotorOnSupports" for part in self.parts]
        if not rotors or rotors != [True] + [False] * (len(rotors) - 1):
            raise ValueError("parts: the rotor must be the first of them, and the only one")
        planes = self.parts[0].unit.sizes.options["planes"]
        motors = [part.model == "Motor" for part in self.parts]
        if any(motors) and any(part.model == "RingBalancer" for part in self.parts):
            raise ValueError(
                "parts: a motor does not drive a ring of liquid, whose spin-up is not modelled"
            )
        if any(motors[:-1]):
            raise ValueError("parts: a motor must be the last of them, and the only one")
        for part in self.parts:
            if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_-]*", part.name):
                raise ValueError(
                    f"{part.name!r}: a part is named by letters, digits, _ and -, a letter first"
                )
            mounted = part is not self.parts[0] and part.model != "Motor"
            if mounted and not 1 <= part.plane <= planes:
                raise ValueError(f"{part.name}: plane = {part.plane}: must be 1 to {planes}")
            if not mounted and (part.plane or part.exchanges_force):
                raise ValueError(f"{part.name}: rotor and motor have plane 0 and exchange no force")

    @property
    def sizes(self) -> CompositeSizes:
        """Of the composite's own variables."""
        planes = self.parts[0].unit.sizes.options["planes"]
        if self.parts[-1].model == "Motor":
            return CompositeSizes(kind="motor", planes=planes)
        return CompositeSizes(planes=planes, corners=self.corners, unbalances=self.changes)

    @cached_property
    def layout(self) -> Layout:
        """Value references and start values."""
        return self.described("Composite").layout

    def described(self, name: str) -> SizedUnit:
        """Name, variables and start values, as descriptions and documentation take them."""
        start = dict(self.start)
        for part in self.parts:
            start |= {f"{part.name}.{k}": v for k, v in part.start.items()}
        own = variables(tuple((p.name, p.unit) for p in self.parts), self.sizes)
        declared = started(own, {k: float(v) for k, v in start.items()})
        models = ", ".join(f"{part.name} ({part.model})" for part in self.parts)
        unit = Unit(
            name,
            "; ".join(filter(None, (self.title, self.source, f"{models}, coupled"))),
            CompositeSizes,
            lambda _: declared,
            stop=self.stop,
            step=self.step,
        )
        hidden = frozenset(v.name for v in declared if self._hides(v))
        layout = Layout(name, declared)
        if any(part.has_springs for part in self.parts):
            return SizedUnit(unit, self.sizes, layout, hidden, self.flat)
        states = tuple(f"{p.name}.{v}" for p in self.parts for v in p.states)
        indicators = tuple(text for part in self.parts for text in part.indicators)
        return SizedUnit(unit, self.sizes, layout, hidden, self.flat, states, indicators)

    def _hides(self, variable: Variable) -> bool:
        """Whether descriptions leave a variable out: what the coupling sets itself, figures."""
        if variable.name.split(".")[-1] in SET_BY_COUPLING:
            return True
        slope = variable.name.startswith("der(")
        figure = variable.name.startswith("coupling.") and variable.causality == "output"
        return self.plain and (slope or figure)

    def token(self, stamp: str) -> str:
        """Text from which the library makes the composite: coupling/composition.c has the form.

        Args:
            stamp: of the C sources.
        """
        if stamp not in self._tokens:
            self._tokens[stamp] = self._token(stamp)
        return self._tokens[stamp]

    @cached_property
    def _tokens(self) -> dict[str, str]:
        """Texts by their stamps."""
        return {}

    def _token(self, stamp: str) -> str:
        entries = [f"corners={self.corners}"] * bool(self.corners)
        entries += [f"changes={self.changes}"] * bool(self.changes)
        for part in self.parts:
            connected = "s" * part.exchanges_force + "v" * part.follows or "-"
            entries.append(f"part={part.name},{part.plane},{connected},{token(part.unit, stamp)}")
            own = part.unit.layout
            entries += start_entries(own, part.start, own.parameters.stop)
        own = self.layout
        first = own.index["coupling.tolerance"]
        given = [f"{own.index[k] - first}:{bits(v)}" for k, v in self.start.items()]
        return ";".join(["Composite", *entries, f"own={','.join(given)}"])
