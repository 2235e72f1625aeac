"""Tables of a scene in ball arithmetic: decimal numbers as they are written, and intervals."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from flint import arb

from ...models.linear.balanced import CannotBalance, balanced_angles
from ...models.proof.arrays import Unproved
from ...models.proof.balanced import Seen, WeightBalls, seen
from ...models.proof.equations import matrices
from ...models.proof.rotors import RingBalls, rotor_balls
from ...models.proof.slopes import Exact, Number, Sloped
from ...models.weights import KAPPA
from ..errors import UserError
from ..scene import Scene
from ..scene.replace import in_full

_UNITS = arb(2) ** -48  # relative: what the conversion of units rounds in a dozen operations
_WEIGHS = r"rotor\.(mass|masses|com|span|stations)\b"  # what shares the weight among supports
_DIGITS = 15  # of a double: a number written with more is known to its neighbours only


@dataclass(frozen=True)
class Change:
    """An interval that a parameter takes.

    Attributes:
        path: as for `Scene.replace`.
        low, high: of the value, or of what is added to it.
        kind: "value"; "relative" to the value, or "added" to it.
        number: which one of different numbers that the path names.
    """

    path: str
    low: float
    high: float
    kind: str = "value"
    number: int = 0

    def __call__(self, value: Number, place: int, count: int) -> Number:
        """The interval of a value, as parameter e_place of `count`."""
        low, high, middle = (arb(repr(x)) for x in (self.low, self.high, self.middle.low))
        span: Any = low
        if self.low != self.high:
            slopes = np.array([arb(0)] * count, object)
            slopes[place] = (high - middle).max(middle - low)
            span = Sloped(low.union(high), slopes)
        return {"value": span, "relative": value * (1 + span), "added": value + span}[self.kind]

    def halves(self) -> tuple[Change, Change]:
        """The lower and the upper half."""
        middle = 0.5 * (self.low + self.high)
        return replace(self, high=middle), replace(self, low=middle)

    @property
    def middle(self) -> Change:
        """The middle alone."""
        middle = 0.5 * (self.low + self.high)
        return replace(self, low=middle, high=middle)


def _exact(value: float) -> arb:
    """The decimal number that a float is written as."""
    text = repr(float(value))
    digits = len(re.sub(r"[-.]|e.*", "", text).strip("0"))
    ball = arb(text)
    return ball if digits <= _DIGITS else ball * (1 + arb(0, 2.0**-52))


def _balls(value: Any, given: Any) -> Any:
    """Numbers of a validated table as balls; `given` is what the document says of them.

    A number that stands for several axes is one object.
    """
    if isinstance(value, dict):
        inner = given if isinstance(given, dict) else {}
        return {key: _balls(each, inner.get(key)) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        if isinstance(given, (list, tuple)):
            return [_balls(v, g) for v, g in zip(value, given, strict=True)]
        if given is not None and value:
            return [_balls(value[0], given)] * len(value)
        return [_balls(v, None) for v in value]
    if not isinstance(value, float):
        return value
    ball = _exact(value)
    return ball * (1 + arb(0, 1) * _UNITS) if isinstance(given, str) else ball


class Tables:
    """The rotor and the balancers of a scene, every number a ball."""

    def __init__(self, scene: Scene) -> None:
        document = scene.document
        self.scene = scene
        self.rotor = _balls(scene.rotor.model_dump(), document["rotor"])
        loads = scene.rotor.static_loads() if scene.rotor.bearings else []
        for held, bearing in zip(self.rotor["bearings"], scene.rotor.bearings, strict=True):
            held |= {"table": bearing.over_speed(loads[bearing.support - 1]), "journal": None}
        self._share_places(document["rotor"])
        given = document.get("balancer", [])
        self.balancers = {
            table.label: _balls(table.model_dump(), each)
            for table, each in zip(scene.balancer, given, strict=True)
        }

    def _share_places(self, given: dict[str, Any]) -> None:
        """Let an unbalance stand where a plane does if the scene writes both places alike: it is
        proved to be there, although the conversion of units rounds."""
        planes = given.get("planes") or ()
        for held, written in zip(
            self.rotor.get("unbalances", ()), given.get("unbalances") or (), strict=False
        ):
            for place, plane in zip(self.rotor.get("planes", ()), planes, strict=False):
                if isinstance(written, dict) and written.get("position") == plane:
                    held["position"] = place

    def numbers(self, path: str) -> dict[int, Number]:
        """The different numbers that a path names.

        Raises:
            UserError: it names no number of the rotor or of a balancer, or one that shapes a table
                over the speed.
        """
        return self._find(path)[2]

    def value(self, path: str) -> Any:
        """A path's value in SI units: a number, or lists of numbers.

        Raises:
            UserError: as of `numbers`.
        """
        holder, key, _ = self._find(path)
        return _floats(holder[key])

    def _find(self, path: str) -> tuple[Any, Any, dict[int, Number]]:
        """What holds a path's value, its key or index there, and the value's different numbers."""
        path = in_full(path, self.scene.body_names)
        self._refuse_shaping(path)
        known: dict[int, Number] = {}
        holder = key = None
        with suppress(KeyError, IndexError, TypeError):
            holder, key = self._place(path)
            _mapped(holder[key], known)
        if not known:
            raise UserError(
                f"{path}: an interval needs a number that the scene gives the rotor or a balancer, "
                f"such as rotor.stiffness or {next(iter(self.balancers), 'balls')}.mass"
            )
        return holder, key, known

    def _refuse_shaping(self, path: str) -> None:
        """Raise UserError for a number on which the rows of a bearing's table depend."""
        for k, bearing in enumerate(self.scene.rotor.bearings, start=1):
            for key in ("table", "journal"):
                if path.startswith((f"rotor.bearings[{k}].{key}", f"bearings[{k}].{key}")):
                    raise UserError(
                        f"{path}: a bearing over the speed takes no interval; vary its values one "
                        "by one, or give stiffness and damping at one speed"
                    )
            if bearing.journal and bearing.journal.load is None and re.match(_WEIGHS, path):
                raise UserError(
                    f"{path}: the load of the journal bearing follows from it: give "
                    f"rotor.bearings[{k}].journal.load (N)"
                )

    def _place(self, path: str) -> tuple[Any, Any]:
        """What holds the value of a path in full, and its key or index."""
        first, *rest = path.split(".")
        keys: list[Any] = []
        for part in rest:
            keys += [re.sub(r"\[.*", "", part), *(int(n) - 1 for n in re.findall(r"\d+", part))]
        holder: Any = {"rotor": self.rotor, **self.balancers}.get(first)
        for key in keys[:-1]:
            holder = holder[key]
        return holder, keys[-1]

    def change(self, changes: Sequence[Change]) -> None:
        """Put intervals into the place of numbers.

        Raises:
            UserError: a path names no number of the rotor or of a balancer.
        """
        for place, change in enumerate(changes):
            holder, key, known = self._find(change.path)
            one = list(known)[change.number]
            known[one] = change(known[one], place, len(changes))
            holder[key] = _mapped(holder[key], known)

    def damp(self) -> None:
        """Damping that `damping_ratio` stands for."""
        if self.rotor.get("damping_ratio") is not None:
            table = self.scene.rotor.model_copy(update=self.rotor)
            rows = self.rotor["damping_ratio"] * table.critical_damping()
            self.rotor[table.damping_key] = rows[0] if len(rows) == 1 else rows

    def matrices(self, speed: float) -> tuple[Exact, list[Seen]]:
        """Of small motions about the balanced motion, and its balancers.

        Args:
            speed: where tables over the speed have the line that is taken [rad/s].

        Raises:
            Unproved: a balanced motion is not proved to exist.
        """
        self.damp()
        weights, added, rings, angles = [], [], [], _angles(self.scene)
        for table in self.balancers.values():
            plane = table["at"] - 1
            if table["kind"] == "liquid":
                added.append((plane, liquid_mass(table)))
            elif table["kind"] == "ring":
                rings.append((plane, _ring(table)))
            else:
                count = table["count"]
                added.append((plane, table["mass"] * count))
                stand = tuple(next(angles) for _ in range(count))
                each, radius, drag = (table[key] for key in ("mass", "track_radius", "drag"))
                kappa = _exact(KAPPA[table["kind"]])
                weights.append(WeightBalls(plane, count, each, radius, drag, kappa, stand))
        rotor = rotor_balls(self.rotor, added, rings, speed)
        found = seen(rotor, weights)
        return matrices(rotor, found), found


def _mapped(value: Any, known: dict[int, Number]) -> Any:
    """A value with its numbers as in `known`, which gets those that it lacks."""
    if isinstance(value, list):
        return [_mapped(each, known) for each in value]
    if not isinstance(value, arb | Sloped):
        raise TypeError
    return known.setdefault(id(value), value)


def _floats(value: Any) -> Any:
    """The middles of balls, in lists as these are."""
    return [_floats(each) for each in value] if isinstance(value, list) else float(value.mid())


def _angles(scene: Scene) -> Iterator[float]:
    try:
        return iter(balanced_angles(scene.assembly()).tolist())
    except (CannotBalance, ArithmeticError) as error:
        raise Unproved(str(error)) from error


def liquid_mass(table: dict[str, Any]) -> Number:
    """Of a full chamber [kg]."""
    radius = table["chamber_radius"]
    return arb.pi() * radius * radius * table["density"] * table["height"]


def _ring(table: dict[str, Any]) -> RingBalls:
    wall, depth = table["wall_radius"] * table["wall_radius"], table["density"] * table["height"]
    if table["inner_radius"] is not None:
        inner = table["inner_radius"] * table["inner_radius"]
    elif table["fill"] is not None:
        inner = wall - table["fill"] * (wall - table["inner_wall_radius"] ** 2)
    else:
        inner = wall - table["liquid_mass"] / (arb.pi() * depth)
    return RingBalls(arb.pi() * depth * (wall - inner), inner / wall, table["wave_damping"])
