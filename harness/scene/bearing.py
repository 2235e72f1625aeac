"""The bearings of a rotor with full 2x2 matrices, in a scene: at every speed, or over the speed."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from ...models.supports import SpeedTable
from ..errors import SceneError, UserError
from ..input_files import named_from
from .nested import Nested
from .quantities import SI, Positive, Real, Table, Whole, refusal, refuse_unless_one

if TYPE_CHECKING:
    from ..measurements import Measurements

Square = tuple[tuple[Real, Real], tuple[Real, Real]]
Row = tuple[Real, Real, Real, Real, Real, Real, Real, Real, Real]
_TERMS = ("xx", "xy", "yx", "yy")
COLUMNS = ("speed", *(f"k{each}" for each in _TERMS), *(f"c{each}" for each in _TERMS))
UNITS = ("rad/s", *("N/m",) * 4, *("N s/m",) * 4)
GRAVITY = 9.80665  # m/s^2: of the load that a rotor's weight is


class Journal(Table):
    """A short journal bearing with a laminar film, whose load is along -y."""

    diameter: Annotated[Positive, SI("m")]
    """Of the journal."""
    length: Annotated[Positive, SI("m")]
    """At most half of the diameter."""
    clearance: Annotated[Positive, SI("m")]
    """Between journal and bearing, of the radii."""
    viscosity: Annotated[Positive, SI("Pa s")]
    """Of the oil at its temperature."""
    load: Annotated[Positive | None, SI("N")] = None
    """Static load; default: the share of the rotor's weight."""
    speeds: tuple[Annotated[Positive, SI("rad/s")], Annotated[Positive, SI("rad/s")]]
    """Lowest and highest speed; a run outside is refused."""

    @model_validator(mode="after")
    def _ascends(self) -> Journal:
        if self.speeds[0] >= self.speeds[1]:
            raise refusal("speeds", "must ascend: the lowest, then the highest")
        return self

    def table(self, share: float) -> SpeedTable:
        """Over the speed; `share` [N] is the default of the load.

        Raises:
            ValueError: the bearing is too long, or has no load.
        """
        from ...models.journal import film_table  # few scenes have one

        size = self.diameter, self.length, self.clearance, self.viscosity
        return film_table(*size, share if self.load is None else self.load, *self.speeds)


class Bearing(Table):
    """A support with cross terms: force on the shaft -(K d + C d'), d = (x, y)."""

    support: Annotated[Whole, Field(ge=1, le=2)] = 1
    """Number of the support; a planar rotor has one."""
    stiffness: Annotated[Square | None, SI("N/m")] = None
    """[[kxx, kxy], [kyx, kyy]]; kxy > 0 > kyx drives forward whirl; or else `table` or
    `journal`."""
    damping: Annotated[Square, SI("N s/m")] = ((0.0, 0.0), (0.0, 0.0))
    """[[cxx, cxy], [cyx, cyy]]."""
    table: tuple[Row, ...] | None = None
    """CSV file of both over the speed: columns speed, kxx ... kyy, cxx ... cyy, units in the heads;
    or its rows in SI units. Linear between rows; a run outside is refused."""
    journal: Nested[Journal] | None = None
    """A short journal bearing, which makes such a table."""

    @model_validator(mode="after")
    def _says_it_once(self) -> Bearing:
        given = refuse_unless_one(self, ("stiffness", "table", "journal"))
        if self.stiffness is None and "damping" in self.model_fields_set:
            raise refusal("damping", f"belongs to stiffness: {given} has its own")
        if self.table is not None:
            speeds = [row[0] for row in self.table]
            if len(speeds) < 2 or speeds[0] < 0.0 or (np.diff(speeds) <= 0.0).any():
                words = "must have two rows or more, whose speeds ascend from 0 or more"
                raise refusal("table", words)
        if self.journal is not None:
            try:
                self.journal.table(1.0)
            except ValueError as error:
                raise refusal("journal", str(error)) from None
        return self

    def over_speed(self, share: float) -> SpeedTable | None:
        """Its table; None where it is the same at every speed. `share`: of the weight [N]."""
        if self.journal is not None:
            return self.journal.table(share)
        if self.table is None:
            return None
        rows = np.array(self.table)
        k, c = (rows[:, first : first + 4].reshape(-1, 2, 2) for first in (1, 5))
        return SpeedTable(rows[:, 0], k, c)

    def matrices(self, share: float) -> tuple[Square, Square]:
        """Stiffness and damping, of a table those of its middle row."""
        found = self.over_speed(share)
        if found is None:
            assert self.stiffness is not None
            return self.stiffness, self.damping
        middle = len(found.speeds) // 2
        k, c = (each[middle].tolist() for each in (found.stiffness, found.damping))
        return k, c

    def diagonals(self, share: float) -> tuple[tuple[float, float], tuple[float, float]]:
        """Stiffness [N/m] and damping [N s/m] along x and y without the cross terms."""
        ((k_x, _), (_, k_y)), ((c_x, _), (_, c_y)) = self.matrices(share)
        return (k_x, k_y), (c_x, c_y)


def with_tables(document: dict[str, Any], folder: Path) -> dict[str, Any]:
    """A scene's document in which the rows replace the CSV files that bearings name.

    Raises:
        SceneError: a file cannot be read, or is no table of a bearing.
    """
    rotor = document.get("rotor")
    bearings = rotor.get("bearings") if isinstance(rotor, dict) else None
    if not isinstance(rotor, dict) or not isinstance(bearings, list):
        return document
    found = []
    for k, one in enumerate(bearings, start=1):
        name = one.get("table") if isinstance(one, dict) else None
        if isinstance(name, str):
            try:
                one = {**one, "table": rows_of(named_from(folder, name))}
            except UserError as error:
                raise SceneError(f"rotor.bearings[{k}].table: {error}") from None
        found.append(one)
    return {**document, "rotor": {**rotor, "bearings": found}}


def rows_of(path: Path) -> list[list[float]]:
    """Rows of a bearing's table in SI units, as `COLUMNS`.

    Raises:
        UserError: the file cannot be read, a column is missing, or a cell holds no finite number.
    """
    from ..measurements import Known, read_measurements  # few scenes have one

    known = [Known(name, (unit,)) for name, unit in zip(COLUMNS, UNITS, strict=True)]
    found = read_measurements(path, known)
    columns = [found.column(one.name) for one in known]
    missing = [one.name for one, column in zip(known, columns, strict=True) if column is None]
    if missing:
        raise UserError(f"{path}: has no {', '.join(missing)}; needs {heads()}")
    rows = np.column_stack([found.all_numbers(column) for column in columns if column])
    _refuse_speeds(found, rows[:, 0])
    return [list(map(float, row)) for row in rows]


def _refuse_speeds(found: Measurements, speeds: NDArray[np.float64]) -> None:
    """Raise UserError, with the line, for speeds [rad/s] of which there is no table."""
    places = [row.place for row in found.rows]
    if len(speeds) < 2:
        raise UserError(f"{found.path}: one row: must have two or more, to be read between them")
    if speeds[0] < 0.0:
        raise UserError(f"{places[0]}: speed = {speeds[0]:.6g} rad/s: must be 0 or more")
    if (back := np.flatnonzero(np.diff(speeds) <= 0.0)).size:
        k = int(back[0])
        raise UserError(
            f"{places[k + 1]}: speed = {speeds[k + 1]:.6g} rad/s, after {speeds[k]:.6g} rad/s: "
            "speeds must ascend; sort the rows, and leave out what is there twice"
        )


def heads(units: Sequence[str] = UNITS) -> str:
    """Heads of the columns as a CSV file has them."""
    return ",".join(f"{name} [{unit}]" for name, unit in zip(COLUMNS, units, strict=True))
