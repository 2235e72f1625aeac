"""Scene files without a rotor: FMUs of any origin and their connections alone."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, Field, ValidationError, model_validator

from ..errors import SceneError
from .document import Described
from .file import find, read, refuse_deep
from .messages import did_you_mean, problems
from .nested import Nested
from .quantities import SI, Positive, Table, Text, Whole, fields_of, refusal
from .replace import plain
from .run import DEFAULT_TOLERANCE, LOOSEST_TOLERANCE, whole_choice
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

UNCORRECTED = ("jacobi", "gauss-seidel")  # schemes that take one pass
TABLES = ("coupling", "run")
# giving one of these takes the place of the others
_ALTERNATIVES = {"step": ("tolerance",), "tolerance": ("step", "corrections")}


class UnitCoupling(Table):
    """How the units exchange signals."""

    scheme: Literal["auto", "jacobi", "gauss-seidel", "iterated"] = "auto"
    """How signals are guessed and corrected; `auto` iterates where the units can restore states."""
    tolerance: Annotated[Positive | None, Field(le=LOOSEST_TOLERANCE), SI("")] = None
    """Error that recorded signals may have, of their largest values; this or `step`; default:
    1e-4, unless corrections are given."""
    step: Annotated[Positive | None, SI("s")] = None
    """Communication step."""
    order: Annotated[Literal[0, 1, 3], BeforeValidator(whole_choice)] = 3
    """Of the signals over a step at most: 0 held, 1 linear, 3 cubic Hermite."""
    corrections: Annotated[Whole | None, Field(ge=0, le=100)] = None
    """Corrector passes with a given step; default: until the loop has converged."""

    @model_validator(mode="before")
    @classmethod
    def _default_tolerance(cls, values: Any) -> Any:
        given = isinstance(values, dict) and (values.get(k) is not None for k in _ALTERNATIVES)
        return values if not given or any(given) else {**values, "tolerance": DEFAULT_TOLERANCE}

    @model_validator(mode="after")
    def _fits_together(self) -> UnitCoupling:
        if self.step is not None and self.tolerance is not None:
            raise refusal("step", f"give either step or tolerance = {self.tolerance:g}, not both")
        if self.corrections is not None and self.step is None:
            raise refusal("corrections", "needs step (s): with a tolerance passes are not limited")
        if self.corrections is not None and self.scheme in UNCORRECTED:
            raise refusal("corrections", f'scheme = "{self.scheme}" takes one pass: leave it out')
        return self


class UnitRun(Table):
    """How long, and what is recorded."""

    duration: Annotated[Positive, SI("s")]
    """Length of the run."""
    record: tuple[Text, ...] | None = None
    """Signals, as `unit.variable`; default: all outputs."""


class System(Described):
    """A validated system of units: FMUs, their connections, and how they are run."""

    unit: tuple[Nested[Unit], ...]
    """A list of tables: the FMUs."""
    connection: tuple[Nested[Connection], ...] = ()
    """A list of tables: which output feeds which input."""
    coupling: Nested[UnitCoupling] = UnitCoupling()
    """How the units exchange signals."""
    run: Nested[UnitRun]
    """How long, and what is recorded."""

    if not TYPE_CHECKING:

        def __init__(self, /, **tables: Any) -> None:
            """A system by its tables: objects such as `Unit`, or mappings as in a file.

            Raises:
                SceneError: one line for every problem there is.
            """
            refuse_deep(tables, "system")
            self._fill(plain(tables), None, "system")

    @classmethod
    def load(cls, source: str | Path) -> Self:
        """Read a scene file that consists of units and connections.

        Raises:
            SceneError: the file is missing, not TOML, or wrong; one line for every problem.

        >>> lines = 'run.duration = 2.0', 'unit = [{name = "mass", fmu = "Mass.fmu"}]'
        >>> open("alone.toml", "w").write("\\n".join(lines)) > 0
        True
        >>> ab.System.load("alone.toml")
        <System 'alone': mass; 0 connections>
        """
        path = find(source)
        return cls._of(read(path), path, str(source))

    def _fill(self, document: dict[str, Any], path: Path | None, label: str) -> None:
        try:
            BaseModel.__init__(self, **document)
        except ValidationError as error:
            lines = problems(error, document, type(self))
        else:
            lines = self._crossed()
        if lines:
            raise SceneError("\n".join(f"{label}: {line}" for line in lines))
        self._document, self._path, self._label = document, path, label

    def _crossed(self) -> list[str]:
        """Problems between the tables."""
        names = [unit.name for unit in self.unit]
        lines = name_problems(self.unit, TABLES)
        lines += [] if names else ["unit: must have one table at least: write [[unit]]"]
        lines += connection_problems(self.connection, names)
        for name in self.run.record or ():
            unit = split_port(name)[0]
            if unit not in names:
                near = did_you_mean(unit, names)
                lines.append(f"run.record: {name!r}: no unit {unit!r}{near}")
        return lines

    def __repr__(self) -> str:
        units = ", ".join(unit.name for unit in self.unit)
        return f"<System {self.heading!r}: {units}; {len(self.connection)} connections>"

    def unit_of(self, path: str) -> str:
        """Empty: start values are in the units of measurement of the FMUs.

        >>> system = ab.System(unit=[{"name": "mass", "fmu": "Mass.fmu"}], run={"duration": 2.0})
        >>> system.unit_of("mass.k")
        ''
        """
        return ""

    def replace(self, changes: Mapping[str, Any]) -> Self:
        """A validated copy with values replaced, such as {"mass.k": 5.0, "run.duration": 2.0}.

        Paths are `unit.variable` for start values, `unit.fmu`, and keys of coupling and run.  None
        takes a key out, back to its default.

        Raises:
            SceneError: a path is unknown (says what is possible), or a value is wrong.

        >>> system = ab.System(unit=[{"name": "mass", "fmu": "Mass.fmu"}], run={"duration": 2.0})
        >>> system.replace({"mass.k": 5.0, "run.duration": 1.0}).unit[0].start
        {'k': 5.0}
        """
        refuse_deep(dict(changes), self._label)
        document = copy.deepcopy(self._document)
        document["unit"], others = with_start_values(document["unit"], plain(dict(changes)))
        for path, value in others.items():
            first, _, key = path.partition(".")
            if first not in TABLES:
                known = [*TABLES, *(unit.name for unit in self.unit)]
                raise SceneError(
                    f"{self._label}: {path!r}: unknown{did_you_mean(first, known)}; begins with "
                    f"one of: {', '.join(known)}"
                )
            known = list(fields_of(type(getattr(self, first))))
            if key not in known:
                near = did_you_mean(key, known)
                has = f"{first} has: {', '.join(known)}"
                raise SceneError(f"{self._label}: {path!r}: unknown{near}; {has}")
            table = document.setdefault(first, {})
            table.pop(key, None)
            if value is not None:
                table[key] = value
                for other in _ALTERNATIVES.get(key, ()) if first == "coupling" else ():
                    if f"{first}.{other}" not in others:
                        table.pop(other, None)
        return self._of(document, self._path, self._label)
