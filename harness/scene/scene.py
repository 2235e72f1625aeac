"""Scene files: a rotor, its balancers, how it is driven, coupled, run and checked.

A scene is read, every problem of the file is reported at once, and what remains is frozen; change
it with `Scene.replace`, which validates again.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import BaseModel, Field, ValidationError

from ..errors import SceneError
from .balancer import AnyBalancer
from .balancing import Balancing
from .bearing import with_tables
from .bodies import bodies_inside
from .check import AnyCheck
from .file import bundled_scenes, find, read, refuse_deep
from .machine import Machine
from .messages import locate, problems
from .model_rules import model_problems
from .nested import Nested
from .pushed import push_problems
from .quantities import Flag, Table
from .replace import in_full, plain, replaced
from .rotor import Rotor
from .rules import TABLES, across, plane_count
from .run import Coupling, Operation, Run
from .trace import with_corners
from .unit import (
    Connection,
    Unit,
    connection_problems,
    name_problems,
    split_port,
    with_start_values,
)

if TYPE_CHECKING:
    from typing_extensions import Self

__all__ = ["Scene", "bundled_scenes", "load_scene"]


class Scene(Machine):
    """A validated scene.

    Make one with `load_scene`, `Scene.from_document`, or `Scene(rotor={...}, operation={...})`.
    """

    rotor: Rotor
    """A table, by kind."""
    balancer: tuple[AnyBalancer, ...] = ()
    """A list of tables, by kind."""
    operation: Nested[Operation]
    """How the rotor is driven, and gravity."""
    coupling: Nested[Coupling] = Coupling()
    """How the units exchange signals."""
    run: Nested[Run] = Field(default_factory=Run)
    """How long, from where, and what is recorded."""
    unit: tuple[Nested[Unit], ...] = ()
    """A list of tables: FMUs of any origin beside rotor and balancers."""
    connection: tuple[Nested[Connection], ...] = ()
    """A list of tables: outputs that feed inputs, of such units, `rotor` or balancers."""
    checks: tuple[AnyCheck, ...] = Field(default=(), alias="check")
    """A list of tables, by kind: what is compared with theory and measurement."""
    on_request: Flag = False
    """Long: checked only when it is named, not by the self-check."""
    balancing: Nested[Balancing] | None = None
    """How the rotor is balanced on the virtual machine; default: not."""

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            rotor: Rotor | Mapping[str, Any],
            balancer: Sequence[AnyBalancer | Mapping[str, Any]] = (),
            speed: float | str = ...,
            operation: Operation | Mapping[str, Any] = ...,
            coupling: Coupling | Mapping[str, Any] = ...,
            run: Run | Mapping[str, Any] = ...,
            balancing: Balancing | Mapping[str, Any] = ...,
            unit: Sequence[Unit | Mapping[str, Any]] = (),
            connection: Sequence[Connection | Mapping[str, Any]] = (),
            check: Sequence[AnyCheck | Mapping[str, Any]] = (),
            title: str = "",
            source: str = "",
            on_request: bool = False,
        ) -> None: ...

    else:

        def __init__(self, /, **tables: Any) -> None:
            """A scene by its tables: objects such as `Planar`, or mappings as in a file.

            Args:
                speed: short for operation.speed, rad/s or text such as "1200 rpm".

            Raises:
                SceneError: one line for every problem there is.
            """
            refuse_deep(tables, "scene")
            tables = plain(tables)
            if "speed" in tables:
                speed = tables.pop("speed")
                tables["operation"] = {"speed": speed, **tables.get("operation", {})}
            self._fill(tables, None, "scene")

    @classmethod
    def load(cls, source: str | Path) -> Self:
        """Read a scene file, or a bundled scene by its name.

        Raises:
            SceneError: the file is missing, not TOML, or wrong; one line for every problem.

        >>> ab.Scene.load("drum") == ab.load("drum")
        True
        """
        path = find(source)
        return cls._of(read(path), path, str(source))

    def _fill(self, document: dict[str, Any], path: Path | None, label: str) -> None:
        folder = path.parent if path else Path()
        try:
            document = with_tables(with_corners(document, folder), folder)
        except SceneError as error:
            raise SceneError(f"{label}: {error}") from None
        document = bodies_inside(document)
        try:
            BaseModel.__init__(self, **document)
        except ValidationError as error:
            planes = plane_count(document.get("rotor"))
            lines = [*problems(error, document, type(self)), *across(document, planes)]
        else:
            lines = across(document, self.rotor.plane_count) or self._refused_by_models()
            lines += self._wrongly_connected()
        if lines:
            raise SceneError("\n".join(f"{label}: {line}" for line in lines))
        self._document, self._path, self._label = document, path, label

    def __repr__(self) -> str:
        balancers = ", ".join(f"{b.kind} {b.label!r}" for b in self.balancer) or "no balancer"
        return f"<Scene {self.heading!r}: {self.rotor.kind} rotor, {balancers}>"

    @property
    def asks_for_coupling(self) -> bool:
        """Whether anything is said of how the units are coupled; which units does not count."""
        return bool(set(self._document.get("coupling", {})) - {"units"})

    @property
    def has_events(self) -> bool:
        """Whether weights can collide or stick, or supports have dry friction or stops."""
        return bool(self.rotor.friction or self.rotor.stops) or any(
            b.can_meet or b.can_stick for b in self.balancer
        )

    def replace(self, changes: Mapping[str, Any]) -> Self:
        """A validated copy with values replaced, for example {"rotor.unbalance": 0.1}.

        Paths begin with rotor, operation, coupling, run, or a balancer's name; `speed` is short for
        operation.speed; elements of lists count from 1 ("balls.angles[2]"), of a pair
        also [x] and [y] ("rotor.stiffness[x]", of two supports "rotor.stiffness[1][x]").  None
        takes a key out, back to its default.  Speed and run_up, steps_per_rev and tolerance take
        each other's place; a tolerance, or a scheme that takes one pass, takes that of corrections.
        Two of them given at once are refused.

        Raises:
            SceneError: a path is unknown (says what is possible), or a value is wrong.

        >>> drum = ab.load("drum").replace({"speed": "900 rpm", "front.count": 4})
        >>> drum.balancer[0].count
        4
        """
        return self._of(self._changed(changes), self._path, self._label)

    def _changed(self, changes: Mapping[str, Any]) -> dict[str, Any]:
        """The document with values replaced, not yet validated; raises for unknown paths."""
        if not isinstance(changes, Mapping):
            raise SceneError(
                f"{self._label}: changes = {changes!r}: must be a dict of paths and values, such "
                'as {"rotor.mass": 3.0, "speed": "1200 rpm"}'
            )
        refuse_deep(dict(changes), self._label)
        document = copy.deepcopy(self._document)
        if self.unit:
            document["unit"], changes = with_start_values(document["unit"], plain(dict(changes)))
        labels = {balancer.label: i for i, balancer in enumerate(self.balancer)}
        tables: dict[str, type[Table]] = {name: type(getattr(self, name)) for name in TABLES}
        if self.balancing is not None:
            tables["balancing"] = Balancing
        tables |= {balancer.label: type(balancer) for balancer in self.balancer}
        try:
            return replaced(document, changes, tables, labels, self.body_names)
        except SceneError as error:
            raise SceneError(f"{self._label}: {error}") from None

    @property
    def body_names(self) -> tuple[str, ...]:
        """Names of the bodies, which paths may begin with.

        >>> ab.load("washing_machine_tub").body_names
        ('tub',)
        """
        return tuple(body.name for body in self.rotor.bodies)

    def unit_of(self, path: str) -> str:
        """SI unit of the value at a path as in `replace`; empty where it has none.

        Raises:
            SceneError: the path is unknown (says what is possible).

        >>> ab.load("two_balls").unit_of("weights.drag")
        'N s/m'
        """
        self._changed({path: 0.0})
        first, *rest = in_full(path, self.body_names).split(".")
        labels = [balancer.label for balancer in self.balancer]
        location: list[str | int] = (
            ["balancer", labels.index(first)] if first in labels else [first]
        )
        for part in rest:
            key, *numbers = re.findall(r"[\w-]+", part) or [part]
            location += [key, *(int(n) - 1 for n in numbers if n.isdecimal())]
        return locate(tuple(location), self._document, type(self)).unit

    def without_balancers(self) -> Self:
        """The bare rotor, with nothing to check.

        >>> ab.load("drum").without_balancers().balancer
        ()
        """
        return self.without(*(balancer.label for balancer in self.balancer))

    def with_check(self, table: Mapping[str, Any]) -> Self:
        """The scene with one more [[check]].

        Raises:
            SceneError: the table is wrong.

        >>> len(ab.load("drum").with_check({"kind": "capacity"}).checks)
        2
        """
        document = copy.deepcopy(self._document)
        document["check"] = [*document.get("check", []), dict(table)]
        return self._of(document, self._path, self._label)

    def without(self, *names: str) -> Self:
        """The scene less the balancers of these names, with nothing to check.

        >>> [each.label for each in ab.load("fan").without("shank").balancer]
        ['fairing']
        """
        document = {k: v for k, v in self._document.items() if k != "check"}
        kept = zip(self.balancer, document.get("balancer", ()), strict=True)
        document["balancer"] = [table for balancer, table in kept if balancer.label not in names]
        if self.connection:
            document["connection"] = [
                table
                for table in document["connection"]
                if not {split_port(table[key])[0] for key in ("from", "to")} & set(names)
            ]
        return self._of(document, self._path, self._label)

    def _wrongly_connected(self) -> list[str]:
        """Problems of units and connections."""
        others = ["rotor", *(balancer.label for balancer in self.balancer)]
        lines = name_problems(self.unit, [*TABLES, "balancing", "motor", *others])
        if self.connection and not self.guests:
            lines.append("connection: connects [[unit]] tables, and there are none")
        if not self.rotor.fmu:
            lines += push_problems(self.rotor, self.connection)
        return lines + connection_problems(
            self.connection, [*others, *(unit.name for unit in self.unit)]
        )

    def _refused_by_models(self) -> list[str]:
        """What the models themselves refuse, once the tables are right."""
        try:
            rotor = self._linear_rotor
        except ValueError as error:
            return [f"rotor: {error}"]
        return [*model_problems(self, rotor)]


def load_scene(source: str | Path) -> Scene:
    """The description in a scene file, or of a bundled scene; see `Scene.load`."""
    return Scene.load(source)
